//! How long each pass takes.

use crate::frame::PassTime;
use std::time::Instant;

/// Adds up the time of each pass.
#[derive(Default)]
pub struct Clock {
    /// In the order in which they first came.
    pub passes: Vec<PassTime>,
}

impl Clock {
    /// Does some work of a pass.
    pub fn time<T>(&mut self, name: &str, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = work();
        let time = start.elapsed();
        match self.passes.iter_mut().find(|pass| pass.name == name) {
            Some(pass) => pass.time += time,
            None => self.passes.push(PassTime { name: name.to_owned(), time }),
        }
        result
    }
}
