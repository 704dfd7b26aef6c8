//! How far the work is: a bar on a terminal; with `-v` a line per pass instead, which also reads well in a log.

use cutis_render::Progress;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// What the passes report to.
pub struct Bar {
    bar: ProgressBar,
}

impl Bar {
    /// A bar on stderr, invisible when that is no terminal or when lines are wanted.
    pub fn new(verbose: u8) -> Self {
        Self::named("", verbose)
    }

    /// A bar with a name before the pass, for one of several pieces of work.
    pub fn named(name: &str, verbose: u8) -> Self {
        let target = if verbose == 0 { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let style =
            ProgressStyle::with_template("{prefix}{msg:24} {bar:40} {percent:>3} % {elapsed}, {eta} left")
                .expect("the template is well formed");
        Self {
            bar: ProgressBar::with_draw_target(Some(0), target)
                .with_style(style)
                .with_prefix(name.to_owned()),
        }
    }

    /// Takes the bar off the screen.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for Bar {
    fn begin(&self, pass: &str, steps: u64) {
        tracing::info!("{pass}");
        self.bar.reset();
        self.bar.set_length(steps);
        self.bar.set_message(pass.to_owned());
    }

    fn advance(&self, steps: u64) {
        self.bar.inc(steps);
    }

    fn note(&self, words: &str) {
        self.bar.set_message(words.to_owned());
    }
}
