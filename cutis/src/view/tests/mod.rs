//! The window, driven without one.

pub mod drive;
mod random;
mod techniques;
mod time;
mod views;
