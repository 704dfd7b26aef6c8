//! A rough dielectric: light walks from facet to facet until it leaves, so that none is lost.
//!
//! Facets have heights spread evenly over (-1, 1), independent of their slopes (Smith). A ray at height h that climbs leaves
//! with probability C(h)^Lambda, with C the share of heights below h; else it meets a facet, is reflected or refracted
//! there, and goes on. Below the surface everything is upside down. The usual model of one bounce, D F G/(4 cos cos), is
//! the first term of this.
//! Source: Heitz, Hanika, d'Eon & Dachsbacher 2016, doi:10.1145/2897824.2925943 (not opened).

use super::slopes::Slopes;
use crate::transport::random::Random;
use cutis_optics::simulate::fresnel_reflectance;
use glam::DVec3;

/// Where rays start: above nearly all facets, as the height of a facet has no upper bound but 1.
const TOP: f64 = 1.0;
/// Facets after which a walk is ended; a thousandth of this has not been needed.
const FACETS_MAX: usize = 10_000;
/// Cosine to the normal above which a direction counts as vertical, and below which as level.
const VERTICAL: f64 = 0.9999;
const LEVEL: f64 = 1e-4;

/// A rough surface, seen from the side the light comes from.
#[derive(Debug, Clone, Copy)]
pub struct Microsurface {
    slopes: Slopes,
    /// Index below over that above.
    eta: f64,
}

/// A ray on its way between facets.
#[derive(Clone, Copy)]
struct Walker {
    dir_travel: DVec3,
    height: f64,
    /// In the medium above the surface.
    above: bool,
}

impl Microsurface {
    pub fn new(roughness: f64, eta: f64) -> Self {
        Self { slopes: Slopes::new(roughness), eta }
    }

    /// Where light goes that comes from `from`, above the surface.
    pub fn sample(&self, from: DVec3, random: &mut Random) -> DVec3 {
        let mut walker = Walker::coming_from(from);
        for _ in 0..FACETS_MAX {
            if !self.fly(&mut walker, random) {
                break;
            }
            self.bounce(&mut walker, random);
        }
        walker.dir_travel
    }

    /// An estimate of the density with which light from `from`, above, goes to `to`, 1/sr: at every facet of a walk, the
    /// light that goes there at once.
    pub fn eval_per_sr(&self, from: DVec3, to: DVec3, random: &mut Random) -> f64 {
        let mut walker = Walker::coming_from(from);
        let mut sum = 0.0;
        for _ in 0..FACETS_MAX {
            if !self.fly(&mut walker, random) {
                break;
            }
            let there = self.facet_density_per_sr(-walker.dir_travel, walker.above, to);
            if there > 0.0 {
                sum += there * self.leaves_towards(to, walker.height);
            }
            self.bounce(&mut walker, random);
        }
        sum
    }

    /// Density of the first bounce, 1/sr, with nothing in its way.
    pub fn single_density_per_sr(&self, from: DVec3, to: DVec3) -> f64 {
        self.facet_density_per_sr(from, true, to)
    }

    /// A direction below the surface into which one visible facet refracts light from `from`; none if it is all reflected.
    pub fn refract_once(&self, from: DVec3, random: &mut Random) -> Option<DVec3> {
        let facet = self.slopes.sample_visible(from, random);
        let cos = from.dot(facet).clamp(0.0, 1.0);
        let (reflectance, cos_beyond) = fresnel_reflectance(1.0, self.eta, cos);
        let to = refracted(from, facet, self.eta, cos, cos_beyond);
        (reflectance < 1.0 && to.z < 0.0).then_some(to)
    }

    /// Density of [`Microsurface::refract_once`], 1/sr; what is all reflected is missing from it.
    pub fn refraction_density_per_sr(&self, from: DVec3, to: DVec3) -> f64 {
        self.refraction(from, to, self.eta).map_or(0.0, |(_, density)| density)
    }

    /// Moves on to the next facet; false if there is none.
    fn fly(&self, walker: &mut Walker, random: &mut Random) -> bool {
        let side = if walker.above { 1.0 } else { -1.0 };
        match self.next_height(walker.dir_travel * side, walker.height * side, random.unit()) {
            Some(height) => walker.height = height * side,
            None => return false,
        }
        true
    }

    /// Height of the facet that a ray meets; none if it leaves.
    fn next_height(&self, dir: DVec3, height: f64, unit: f64) -> Option<f64> {
        let below = share_below(height);
        if dir.z > VERTICAL {
            return None;
        }
        if dir.z < -VERTICAL {
            return Some(height_of(unit * below));
        }
        if dir.z.abs() < LEVEL {
            return Some(height);
        }
        let lambda = self.slopes.lambda(dir);
        if dir.z > 0.0 && unit > 1.0 - below.powf(lambda) {
            return None;
        }
        Some(height_of(below / (1.0 - unit).powf(lambda.recip())))
    }

    /// Probability that light leaves the surface at this height towards `to`, which may lie below it.
    fn leaves_towards(&self, to: DVec3, height: f64) -> f64 {
        let side = 1f64.copysign(to.z);
        if to.z.abs() < LEVEL { 0.0 } else { share_below(height * side).powf(self.slopes.lambda(to * side)) }
    }

    /// Reflection or refraction at a facet, whole, by chance.
    fn bounce(&self, walker: &mut Walker, random: &mut Random) {
        let side = if walker.above { 1.0 } else { -1.0 };
        let from = -walker.dir_travel;
        let facet = self.slopes.sample_visible(from * side, random) * side;
        let eta = self.eta_from(walker.above);
        let cos = from.dot(facet).clamp(0.0, 1.0);
        let (reflectance, cos_beyond) = fresnel_reflectance(1.0, eta, cos);
        walker.dir_travel = if random.unit() < reflectance {
            (facet * (2.0 * cos) - from).normalize()
        } else {
            walker.above = !walker.above;
            refracted(from, facet, eta, cos, cos_beyond)
        };
    }

    /// Index beyond a facet over that before it.
    fn eta_from(&self, above: bool) -> f64 {
        if above { self.eta } else { self.eta.recip() }
    }

    /// Density with which one facet throws light from `from` towards `to`, 1/sr.
    fn facet_density_per_sr(&self, from: DVec3, above: bool, to: DVec3) -> f64 {
        let side = if above { 1.0 } else { -1.0 };
        let (from, to, eta) = (from * side, to * side, self.eta_from(above));
        if to.z > 0.0 {
            // Half vectors are as many as the directions, four times their cosine apart.
            let facet = (from + to).normalize_or_zero();
            let cos = from.dot(facet);
            if cos <= 0.0 {
                return 0.0;
            }
            let reflectance = fresnel_reflectance(1.0, eta, cos.min(1.0)).0;
            return reflectance * self.slopes.visible_density_per_sr(from, facet) / (4.0 * cos);
        }
        self.refraction(from, to, eta)
            .map_or(0.0, |(cos, density)| density * (1.0 - fresnel_reflectance(1.0, eta, cos).0))
    }

    /// Cosine of `from` at the facet that refracts it towards `to`, and the density of such directions, 1/sr, with all light
    /// refracted. Snell's law: the facet is along from + eta to (Walter et al. 2007, eq. 16, 17).
    fn refraction(&self, from: DVec3, to: DVec3, eta: f64) -> Option<(f64, f64)> {
        let facet = -(from + to * eta).normalize_or_zero();
        let facet = facet * 1f64.copysign(facet.z);
        let (cos, cos_to) = (from.dot(facet), -to.dot(facet));
        if cos <= 0.0 || cos_to <= 0.0 {
            return None;
        }
        let spread = (cos - eta * cos_to).powi(2);
        Some((cos.min(1.0), eta * eta * self.slopes.visible_density_per_sr(from, facet) * cos_to / spread))
    }
}

/// Direction beyond a facet of light that comes from `from`.
fn refracted(from: DVec3, facet: DVec3, eta: f64, cos: f64, cos_beyond: f64) -> DVec3 {
    (facet * (cos / eta - cos_beyond) - from / eta).normalize()
}

impl Walker {
    fn coming_from(from: DVec3) -> Self {
        Self { dir_travel: -from, height: TOP, above: true }
    }
}

/// Share of the facets that lie below a height.
fn share_below(height: f64) -> f64 {
    (0.5 * (height + 1.0)).clamp(0.0, 1.0)
}

/// The height below which that share lies.
fn height_of(share: f64) -> f64 {
    (2.0 * share - 1.0).clamp(-1.0, 1.0)
}
