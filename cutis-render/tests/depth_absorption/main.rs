//! Absorption over distances through bodies, against closed forms.

#[path = "../common/mod.rs"]
mod common;
mod light;
mod limits;
mod scenes;
mod ways;
