//! The published methods, one file each: how light gets through a body, as far as they know.

pub mod depth_absorption;
pub mod image_space;
pub mod texture_blur;
pub mod texture_space;
pub mod truth;
pub mod wrap;

use crate::passes::resolve::Place;
use glam::{Vec3, Vec4};

/// Light that leaves at a place after it has been inside the body, before the film of the surface filters it, W/m².
#[derive(Debug, Clone, Copy, Default)]
pub struct Exitance {
    /// What entered close by.
    pub local: Vec3,
    /// What entered on another side and came through.
    pub transmitted: Vec3,
}

/// What a technique knows of the light inside a body. The final pass is the same for all techniques but for this.
pub trait Inside: Sync {
    /// Light that leaves at a place.
    fn exitance(&self, place: &Place) -> Exitance;

    /// Radiance that the surface reflects from all lights, W/(m² sr), where the technique has a way of its own for that.
    fn shine(&self, place: &Place) -> Option<Vec3> {
        let _ = place;
        None
    }

    /// Distances through bodies towards the first four lights, mm, where the technique does not take them from the light's map.
    fn distances_mm(&self, place: &Place) -> Option<Vec4> {
        let _ = place;
        None
    }
}
