//! The window, driven without one.

mod drive;
mod random;
mod views;
