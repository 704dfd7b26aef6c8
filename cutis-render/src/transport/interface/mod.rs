//! The surface of a body as light meets it: a dielectric interface, smooth or rough.
//!
//! Directions are local: +z is the normal, which points out of the body, and both directions point away from the surface.
//! What is carried is radiance over the squared index, which no interface changes: a direction is drawn with the density
//! with which light is thrown there, weights stay 1, and all the light is somewhere. It is the same for light and for what
//! the eye asks for (reciprocity).

mod microsurface;
mod slopes;

use super::random::Random;
use cutis_optics::simulate::fresnel_reflectance;
use glam::DVec3;
use microsurface::Microsurface;
use std::f64::consts::PI;

/// Indices this close let light pass straight.
const MATCHED: f64 = 1e-9;
/// Part of the even spread in the density that decides between two ways of finding a light: what bounces between facets
/// goes everywhere.
const EVEN_SPREAD: f64 = 0.1;

/// A dielectric interface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interface {
    /// Refractive index inside over that outside.
    pub eta: f64,
    /// Root-mean-square slope of the facets m (Beckmann); 0 is smooth.
    pub roughness: f64,
}

impl Interface {
    /// Whether a direction comes from one other direction only, so that no light can be asked for.
    pub fn is_sharp(&self) -> bool {
        self.roughness <= 0.0 || (self.eta - 1.0).abs() < MATCHED
    }

    /// Where light goes that comes from `from` (or where that comes from which goes there).
    pub fn sample(&self, from: DVec3, random: &mut Random) -> DVec3 {
        if (self.eta - 1.0).abs() < MATCHED {
            return -from;
        }
        if self.roughness > 0.0 {
            let (surface, side) = self.with_above(from);
            return surface.sample(from * side, random) * side;
        }
        let up = DVec3::new(0.0, 0.0, 1f64.copysign(from.z));
        let (reflectance, cos_beyond) = fresnel_reflectance(1.0, self.eta_towards(from), from.z.abs());
        if random.unit() < reflectance {
            DVec3::new(-from.x, -from.y, from.z)
        } else {
            let aside = -(from - up * from.dot(up)) / self.eta_towards(from);
            (aside - up * cos_beyond).normalize()
        }
    }

    /// An estimate of the density with which light from `from` goes to `to`, 1/sr: unbiased, and different each time. 0 where
    /// the interface is sharp.
    pub fn eval_per_sr(&self, from: DVec3, to: DVec3, random: &mut Random) -> f64 {
        if self.is_sharp() {
            return 0.0;
        }
        let (surface, side) = self.with_above(from);
        surface.eval_per_sr(from * side, to * side, random)
    }

    /// About the density of [`Interface::sample`], 1/sr: good enough to weigh two estimates of the same light.
    pub fn rough_density_per_sr(&self, from: DVec3, to: DVec3) -> f64 {
        let (surface, side) = self.with_above(from);
        surface.single_density_per_sr(from * side, to * side) + EVEN_SPREAD * to.z.abs() / PI
    }

    /// A direction inside into which a single facet refracts light from `from`, outside; none if it reflects all of it.
    pub fn refract_once(&self, from: DVec3, random: &mut Random) -> Option<DVec3> {
        Microsurface::new(self.roughness, self.eta).refract_once(from, random)
    }

    /// Density of [`Interface::refract_once`], 1/sr.
    pub fn refraction_density_per_sr(&self, from: DVec3, to: DVec3) -> f64 {
        Microsurface::new(self.roughness, self.eta).refraction_density_per_sr(from, to)
    }

    /// Index beyond over that on the side of `from`.
    fn eta_towards(&self, from: DVec3) -> f64 {
        if from.z >= 0.0 { self.eta } else { self.eta.recip() }
    }

    /// The surface seen with `from` above it, and the sign that turns directions so. Beckmann's surface is the same from
    /// both sides.
    fn with_above(&self, from: DVec3) -> (Microsurface, f64) {
        let side = 1f64.copysign(from.z);
        (Microsurface::new(self.roughness, self.eta_towards(from)), side)
    }
}

#[cfg(test)]
mod tests;
