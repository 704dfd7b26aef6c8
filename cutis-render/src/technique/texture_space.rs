//! Texture-space diffusion with translucent shadows: the algorithm of d'Eon, Luebke & Enderton 2007, section 5.4.
//!
//! Light is spread over the texture before anybody looks ([`crate::passes::diffusion`]), and what comes through thin parts
//! is found there, too ([`crate::passes::transmission`]); what leaves at a place is read.

use super::{Exitance, Inside};
use crate::passes::resolve::Place;
use crate::passes::transmission::Transmission;
use glam::Vec3;

/// Light that has been spread by the kernel's Gaussians.
pub struct Spread<'a> {
    transmission: &'a [Transmission],
}

impl<'a> Spread<'a> {
    /// With what has come through each object, where that is known.
    pub fn new(transmission: &'a [Transmission]) -> Self {
        Self { transmission }
    }
}

impl Inside for Spread<'_> {
    fn exitance(&self, place: &Place) -> Exitance {
        let Place { maps, chart, .. } = *place;
        let uv = place.point.atlas_uv;
        let through = self.transmission.get(place.object_number);
        Exitance {
            local: maps.diffused.weighted_sum(&maps.kernel.weights, uv, chart),
            transmitted: through.map_or(Vec3::ZERO, |through| through.at(maps, uv, chart)),
        }
    }
}
