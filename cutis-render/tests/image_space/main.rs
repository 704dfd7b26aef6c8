//! Image-space sampling against closed forms: planes, shadow edges, balls, and the ends of its numbers.

mod balls;
#[path = "../common/mod.rs"]
mod common;
mod limits;
mod media;
mod planes;
mod scenes;
