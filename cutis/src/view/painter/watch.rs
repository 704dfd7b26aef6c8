//! Lets long work end when something else is wanted, and shows how far it is.

use super::{Desk, News, Painted};
use cutis_render::{Frame, Progress};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Time between two pictures of one that gets better.
const BETWEEN_PICTURES: Duration = Duration::from_millis(700);

/// Watches one picture.
pub struct Watch<'a> {
    desk: &'a Desk,
    /// Whether it may end unfinished.
    may_stop: bool,
    /// Makes news of a frame and the words that tell how good it is.
    finish: &'a (dyn Fn(Frame, String) -> Painted + Sync),
    state: Mutex<State>,
}

struct State {
    last_picture: Instant,
    steps: u64,
    done: u64,
}

impl<'a> Watch<'a> {
    /// Of a picture that `finish` makes news of. Drafts are drawn to their end: while something moves there would be nothing to
    /// see otherwise.
    pub fn new(
        desk: &'a Desk,
        may_stop: bool,
        finish: &'a (dyn Fn(Frame, String) -> Painted + Sync),
    ) -> Self {
        Self {
            desk,
            may_stop,
            finish,
            state: Mutex::new(State { last_picture: Instant::now(), steps: 0, done: 0 }),
        }
    }

    fn with_state<T>(&self, work: impl FnOnce(&mut State) -> T) -> T {
        work(&mut self.state.lock().unwrap_or_else(std::sync::PoisonError::into_inner))
    }
}

impl Progress for Watch<'_> {
    fn begin(&self, _pass: &str, steps: u64) {
        self.with_state(|state| (state.steps, state.done) = (steps, 0));
    }

    fn advance(&self, steps: u64) {
        self.with_state(|state| state.done += steps);
    }

    fn goes_on(&self) -> bool {
        !self.may_stop || !self.desk.wishes.has_news()
    }

    fn preview(&self, picture: &dyn Fn() -> Frame) {
        let due = self.with_state(|state| {
            let due = state.last_picture.elapsed() > BETWEEN_PICTURES;
            if due {
                state.last_picture = Instant::now();
            }
            due.then_some([state.done, state.steps])
        });
        if let Some([done, steps]) = due {
            let painted = (self.finish)(picture(), format!("{done} of {steps} samples"));
            self.desk.tell(News::Painted(Box::new(painted)));
        }
    }
}
