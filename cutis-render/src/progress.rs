//! How far the work is, for whoever watches.

use crate::Frame;

/// Told by the passes how far they are. Called from many threads.
pub trait Progress: Sync {
    /// A pass of `steps` equal steps begins.
    fn begin(&self, pass: &str, steps: u64);
    /// Some steps of the current pass are done.
    fn advance(&self, steps: u64);
    /// How good the current pass is by now, in words.
    fn note(&self, _words: &str) {}
    /// Whether the work is still wanted; asked between passes and between pixels, rows or samples. If it is not, the work
    /// ends in [`crate::RenderError::Stopped`]. Called from many threads.
    fn goes_on(&self) -> bool {
        true
    }
    /// The picture as it is by now can be had.
    fn preview(&self, _picture: &dyn Fn() -> Frame) {}
}

/// Tells nobody.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Progress for Silent {
    fn begin(&self, _pass: &str, _steps: u64) {}
    fn advance(&self, _steps: u64) {}
}
