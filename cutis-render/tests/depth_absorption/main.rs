//! Absorption over distances through bodies, against closed forms.

mod light;
mod limits;
mod scenes;
mod ways;
