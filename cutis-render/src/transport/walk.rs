//! The random walk inside a body: from where light entered to where it meets the surface again.
//!
//! Red, green and blue walk the same path. Its lengths are drawn for one of them, and each is weighed by the mean density
//! with which any of the three would have drawn it, so that none is ever overweighed by more than 3. In layers, steps are
//! drawn for the densest one, and what is too many collides with nothing (Woodcock). How deep a point lies is
//! asked only where it may matter: the depth changes by no more than the way gone.
//! Source for the weights: Wilkie et al. 2014, "Hero wavelength spectral sampling", doi:10.1111/cgf.12419 (not opened).

use super::random::Random;
use super::tissue::{Tissue, TissueLayer};
use cutis_optics::simulate::scattered_one_minus_cos;
use cutis_scene::solids::{Meeting, NOWHERE, Ray64, Solids};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Weight below which a path goes on by chance only …
const ROULETTE_BELOW: f64 = 0.2;
/// … and the weight it is given where it does.
const ROULETTE_WEIGHT: f64 = 0.4;
/// Events after which a path is given up: a body a thousand mean free paths wide that absorbs nothing has one in a billion.
const EVENTS_MAX: u64 = 10_000_000;
/// How much deeper than the layers the depth is looked for, of their thickness: beyond, points count as that deep.
const DEPTH_REACH: f64 = 3.0;
/// Distance from the layers from which on steps are drawn for the core alone, of their thickness.
const SAFE_PART: f64 = 0.25;

/// The light on a path, or the share of it that the path asks for.
#[derive(Debug, Clone, Copy)]
pub struct Carried {
    /// What is carried, times the density of the path's own channel.
    light: DVec3,
    /// Density with which each channel would have drawn the path, over that of the path's own.
    densities: DVec3,
    /// Channel that draws.
    channel: usize,
}

impl Carried {
    /// Starts a path.
    pub fn new(light: DVec3, random: &mut Random) -> Self {
        Self { light, densities: DVec3::ONE, channel: random.below(3) }
    }

    /// What is carried.
    pub fn light(&self) -> DVec3 {
        self.light * (3.0 / self.densities.element_sum())
    }

    /// Loses or gains.
    pub fn scale(&mut self, factor: DVec3) {
        self.light *= factor;
    }

    /// An event that this path's light survives by `light` and that was drawn with these densities.
    fn drawn(&mut self, light: DVec3, densities: DVec3) {
        let own = densities[self.channel];
        self.light *= light / own;
        self.densities *= densities / own;
    }

    /// Ends weak paths by chance; false where it did.
    pub fn survives(&mut self, random: &mut Random) -> bool {
        let most = self.light().max_element();
        if most >= ROULETTE_BELOW {
            return true;
        }
        let survival = most / ROULETTE_WEIGHT;
        if random.unit() >= survival {
            return false;
        }
        self.light /= survival;
        true
    }
}

/// A walk through one object.
pub struct Walk<'a> {
    /// The bodies.
    pub solids: &'a Solids<'a>,
    /// What fills this one.
    pub tissue: &'a Tissue,
    /// Its index in the scene.
    pub object: u32,
}

/// Light about to be scattered.
pub struct Scattering {
    /// Where, mm.
    pub point_mm: DVec3,
    /// Unit direction it travels.
    pub dir: DVec3,
    /// Mean cosine of the angle it will turn by.
    pub g: f64,
    /// What is carried, absorption of this collision included.
    pub light: DVec3,
    /// Bodies around the place.
    pub within: u32,
}

/// Where a walk met the surface.
pub struct Met {
    /// The place.
    pub meeting: Meeting,
    /// Way from the last scattering, mm; none if there was none on this walk.
    pub flown_mm: Option<f64>,
}

impl Scattering {
    /// Density with which light goes on towards `dir`, 1/sr.
    pub fn density_per_sr(&self, dir: DVec3) -> f64 {
        let (g, cos) = (self.g, self.dir.dot(dir));
        (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cos).powf(1.5))
    }
}

/// A point whose depth is known.
struct Sounding {
    point_mm: DVec3,
    depth_mm: f64,
}

impl Walk<'_> {
    /// Walks until the surface is met; the ray ends there. None if all light is absorbed, or the surface cannot be found.
    /// `scattering` is told of every place where light is about to be scattered.
    pub fn to_surface(
        &self,
        ray: &mut Ray64,
        carried: &mut Carried,
        within: &mut u32,
        random: &mut Random,
        mut scattering: impl FnMut(&Scattering, &mut Random),
    ) -> Option<Met> {
        let mut sounding = Sounding { point_mm: ray.origin_mm, depth_mm: 0.0 };
        let mut flown_mm = None;
        for _ in 0..EVENTS_MAX {
            let (majorant, zone_mm) = self.zone(ray.origin_mm, &mut sounding);
            let flight_mm = -random.unit().ln() / majorant[carried.channel];
            let meeting = self.solids.way_out(ray, flight_mm.min(zone_mm), within);
            let gone_mm = meeting.map_or(flight_mm.min(zone_mm), |m| m.distance_mm);
            let passed = transmittance(majorant, gone_mm);
            carried.drawn(passed, passed);
            ray.origin_mm += ray.dir * gone_mm;
            flown_mm = flown_mm.map(|flown: f64| flown + gone_mm);
            if let Some(meeting) = meeting {
                ray.from = meeting.id;
                return Some(Met { meeting, flown_mm });
            }
            ray.from = NOWHERE;
            if !gone_mm.is_finite() {
                return None;
            }
            if flight_mm > zone_mm {
                continue;
            }
            let layer = self.layer_at(ray.origin_mm, &mut sounding);
            let sigma_t = layer.sigma_t_per_mm();
            let channel = carried.channel;
            if sigma_t[channel] < majorant[channel] && random.unit() * majorant[channel] >= sigma_t[channel] {
                // Too dense a layer was assumed: nothing is there.
                carried.drawn(majorant - sigma_t, majorant - sigma_t);
                continue;
            }
            carried.drawn(layer.sigma_s_per_mm, sigma_t);
            if !carried.survives(random) {
                return None;
            }
            let place = Scattering {
                point_mm: ray.origin_mm,
                dir: ray.dir,
                g: layer.g,
                light: carried.light(),
                within: *within,
            };
            scattering(&place, random);
            ray.dir = scattered(ray.dir, layer.g, random);
            flown_mm = Some(0.0);
        }
        None
    }

    /// Extinction that steps from here are drawn for, 1/mm, and how far it holds, mm.
    fn zone(&self, point_mm: DVec3, sounding: &mut Sounding) -> (DVec3, f64) {
        if self.tissue.is_homogeneous() {
            return (self.tissue.majorant_per_mm(), f64::INFINITY);
        }
        let core_mm = self.tissue.core_depth_mm();
        let mut below_mm = sounding.least_depth_mm(point_mm) - core_mm;
        if below_mm <= SAFE_PART * core_mm {
            // At the surface itself the first flight's start has depth 0, which is known.
            if point_mm != sounding.point_mm {
                *sounding = self.sound(point_mm);
            }
            below_mm = sounding.depth_mm - core_mm;
        }
        // Close to the layers, steps that stop before them would get shorter and shorter.
        if below_mm > SAFE_PART * core_mm {
            (self.tissue.core().sigma_t_per_mm(), below_mm)
        } else {
            (self.tissue.majorant_per_mm(), f64::INFINITY)
        }
    }

    /// Share of the light that passes from one place to another, within the body: exact in a single medium, else an unbiased
    /// estimate (ratio tracking, Novák, Selle & Jarosz 2014).
    pub fn passed(&self, from_mm: DVec3, dir: DVec3, way_mm: f64, random: &mut Random) -> DVec3 {
        let majorant = self.tissue.majorant_per_mm();
        if self.tissue.is_homogeneous() {
            return transmittance(majorant, way_mm);
        }
        let (step_per_mm, mut gone_mm, mut passed) = (majorant.max_element(), 0.0, DVec3::ONE);
        let mut sounding = self.sound(from_mm);
        loop {
            gone_mm -= random.unit().ln() / step_per_mm;
            if gone_mm >= way_mm {
                return passed;
            }
            let layer = self.layer_at(from_mm + dir * gone_mm, &mut sounding);
            passed *= 1.0 - layer.sigma_t_per_mm() / step_per_mm;
        }
    }

    fn layer_at(&self, point_mm: DVec3, sounding: &mut Sounding) -> &TissueLayer {
        if self.tissue.is_homogeneous() || sounding.least_depth_mm(point_mm) > self.tissue.core_depth_mm() {
            return self.tissue.core();
        }
        *sounding = self.sound(point_mm);
        self.tissue.layer_at(sounding.depth_mm)
    }

    fn sound(&self, point_mm: DVec3) -> Sounding {
        let reach_mm = (1.0 + DEPTH_REACH) * self.tissue.core_depth_mm();
        let depth_mm = self.solids.depth_mm(point_mm, self.object, reach_mm).unwrap_or(reach_mm);
        Sounding { point_mm, depth_mm }
    }
}

impl Sounding {
    /// The depth of a point is no less than this.
    fn least_depth_mm(&self, point_mm: DVec3) -> f64 {
        self.depth_mm - (point_mm - self.point_mm).length()
    }
}

fn transmittance(sigma_per_mm: DVec3, way_mm: f64) -> DVec3 {
    // Nothing on an endless way through nothing: infinity times zero is not asked.
    if way_mm.is_finite() { (sigma_per_mm * -way_mm).exp() } else { DVec3::ONE }
}

/// A direction after scattering.
fn scattered(dir: DVec3, g: f64, random: &mut Random) -> DVec3 {
    if g == 0.0 {
        return random.direction();
    }
    let one_minus_cos = scattered_one_minus_cos(g, random.unit());
    let sin = (one_minus_cos * (2.0 - one_minus_cos)).max(0.0).sqrt();
    let (u, v) = dir.any_orthonormal_pair();
    let aside = DVec2::from_angle(TAU * random.unit()) * sin;
    (dir * (1.0 - one_minus_cos) + u * aside.x + v * aside.y).normalize()
}
