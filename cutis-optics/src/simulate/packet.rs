//! One packet's way through the layers.

use super::fresnel::fresnel_reflectance;
use super::henyey_greenstein::sample_one_minus_cos;
use super::layers::{Flight, LayeredSlab};
use super::random::Random;
use super::tally::Tally;

/// Weight below which a packet plays for its life.
const LIGHT: f64 = 1e-4;
/// Its chance.
const SURVIVAL: f64 = 0.1;

/// Light on its way: where it is, where it travels (z points down), and how much is left of it.
pub(super) struct Packet {
    position_mm: [f64; 3],
    dir_travel: [f64; 3],
    weight: f64,
    layer: usize,
}

/// What a flight ends with.
enum End {
    Collision,
    Left,
}

impl Packet {
    /// A packet just under the top surface, what that mirrors taken off.
    pub(super) fn enter(slab: &LayeredSlab) -> Self {
        let weight = 1.0 - slab.specular_reflectance();
        Self { position_mm: [0.0; 3], dir_travel: [0.0, 0.0, 1.0], weight, layer: 0 }
    }

    /// Follows the packet until nothing is left of it.
    pub(super) fn run(mut self, slab: &LayeredSlab, random: &mut Random, tally: &mut Tally) {
        while let End::Collision = self.fly(slab, random, tally) {
            self.collide(slab, random, tally);
            if self.weight < LIGHT && !self.survives(random, tally) {
                return;
            }
        }
    }

    /// Flies to the next collision, through as many interfaces as lie before it.
    #[inline(always)]
    fn fly(&mut self, slab: &LayeredSlab, random: &mut Random, tally: &mut Tally) -> End {
        let mut optical_depth = -random.unit().ln();
        loop {
            let &Flight { sigma_t_per_mm, mean_free_path_mm, bounds_mm, .. } = slab.flight(self.layer);
            let downwards = self.dir_travel[2] > 0.0;
            let edge_mm = bounds_mm[usize::from(downwards)];
            let to_edge_mm = match self.dir_travel[2] {
                // Level flight never meets an interface.
                0.0 => f64::INFINITY,
                dir_z => ((edge_mm - self.position_mm[2]) / dir_z).max(0.0),
            };
            if optical_depth < to_edge_mm * sigma_t_per_mm
                || (to_edge_mm.is_infinite() && sigma_t_per_mm > 0.0)
            {
                self.advance(optical_depth * mean_free_path_mm);
                return End::Collision;
            }
            if to_edge_mm.is_infinite() {
                // Clear and endless: it is gone for good.
                tally.leave(downwards, f64::INFINITY, self.dir_travel[2].abs(), self.weight);
                return End::Left;
            }
            optical_depth -= to_edge_mm * sigma_t_per_mm;
            self.advance(to_edge_mm);
            self.position_mm[2] = edge_mm;
            if self.cross(slab, downwards, random, tally) {
                return End::Left;
            }
        }
    }

    #[inline(always)]
    fn advance(&mut self, distance_mm: f64) {
        for (place, dir) in self.position_mm.iter_mut().zip(self.dir_travel) {
            *place += dir * distance_mm;
        }
    }

    /// Meets an interface: turns back, or goes on into the next layer, or leaves (and says so).
    #[inline(always)]
    fn cross(&mut self, slab: &LayeredSlab, downwards: bool, random: &mut Random, tally: &mut Tally) -> bool {
        let from = slab.layers()[self.layer].refractive_index;
        let to = slab.index_beyond(self.layer, downwards);
        let (reflectance, cos_to) = fresnel_reflectance(from, to, self.dir_travel[2].abs());
        if reflectance > 0.0 && random.unit() < reflectance {
            self.dir_travel[2] = -self.dir_travel[2];
            return false;
        }
        let leaves = if downwards { self.layer + 1 == slab.layers().len() } else { self.layer == 0 };
        if leaves {
            let [x, y, _] = self.position_mm;
            tally.leave(downwards, x.hypot(y), cos_to, self.weight);
            return true;
        }
        let ratio = from / to;
        self.dir_travel = [
            self.dir_travel[0] * ratio,
            self.dir_travel[1] * ratio,
            if downwards { cos_to } else { -cos_to },
        ];
        self.layer = if downwards { self.layer + 1 } else { self.layer - 1 };
        false
    }

    /// Loses the absorbed part and turns.
    #[inline(always)]
    fn collide(&mut self, slab: &LayeredSlab, random: &mut Random, tally: &mut Tally) {
        let &Flight { absorbed, g, .. } = slab.flight(self.layer);
        let absorbed = self.weight * absorbed;
        if absorbed > 0.0 {
            self.weight -= absorbed;
            tally.absorb(self.layer, self.position_mm[2], absorbed);
        }
        if self.weight > 0.0 {
            let one_minus_cos = sample_one_minus_cos(g, random.unit());
            self.dir_travel = turned(self.dir_travel, one_minus_cos, random.on_circle());
        }
    }

    #[inline(never)]
    fn survives(&mut self, random: &mut Random, tally: &mut Tally) -> bool {
        if self.weight > 0.0 && random.unit() < SURVIVAL {
            let raised = self.weight / SURVIVAL;
            tally.roulette(self.weight - raised);
            self.weight = raised;
            return true;
        }
        tally.roulette(self.weight);
        false
    }
}

/// A direction turned by an angle (1 - its cosine is given) towards a point on the circle around it.
#[inline(always)]
fn turned(dir: [f64; 3], one_minus_cos: f64, [cos_azimuth, sin_azimuth]: [f64; 2]) -> [f64; 3] {
    let cos = 1.0 - one_minus_cos;
    let sin = (one_minus_cos * (2.0 - one_minus_cos)).max(0.0).sqrt();
    let [x, y, z] = dir;
    // Orthonormal frame without a branch at the poles (Duff et al. 2017, JCGT 6(1), listing 3).
    let sign = 1.0f64.copysign(z);
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    let (u, v) = (sin * cos_azimuth, sin * sin_azimuth);
    let turned = [
        u * (1.0 + sign * x * x * a) + v * b + cos * x,
        u * sign * b + v * (sign + y * y * a) + cos * y,
        -u * sign * x - v * y + cos * z,
    ];
    // Rounding would add up over thousands of turns: one step of Newton's towards length 1.
    let length2 = turned[0] * turned[0] + turned[1] * turned[1] + turned[2] * turned[2];
    turned.map(|c| c * (1.5 - 0.5 * length2))
}
