//! Packets side by side: where they are, where they travel, and how a collision or an interface turns them.

use super::fresnel::fresnel_lanes;
use super::henyey_greenstein::sample_one_minus_cos;
use super::lanes::{Lanes, lanes_of, splat};
use super::layers::Flight;
use super::random::{half_unit, on_circle};
use wide::u64x8;

/// Light on its way in all lanes (z points down), and how much is left of it.
pub(super) struct Packets {
    pub(super) position_mm: [Lanes; 3],
    pub(super) dir_travel: [Lanes; 3],
    pub(super) weight: Lanes,
    /// Number of the layer, the top one is 0.
    pub(super) layer: Lanes,
    pub(super) medium: Medium,
}

/// The constants of the layer that each packet is in; [`Flight`] says what they are.
pub(super) struct Medium {
    mean_free_path_mm: Lanes,
    pub(super) absorbed: Lanes,
    g: Lanes,
    bounds_mm: [Lanes; 2],
    index_over_beyond: [Lanes; 2],
}

/// How a flight ended.
pub(super) struct Landing {
    /// Masks: met the interface, which lies downwards.
    pub(super) collides: Lanes,
    pub(super) downwards: Lanes,
    /// The largest number if the light is gone for good.
    pub(super) distance_mm: Lanes,
}

/// What an interface did to the packets that met it.
pub(super) struct Crossing {
    /// Mask: light is thrown back.
    pub(super) reflects: Lanes,
    /// Cosine of the angle to the normal beyond the interface.
    pub(super) cos_beyond: Lanes,
    /// Directions beyond it, or thrown back.
    dir_travel: [Lanes; 3],
}

impl Packets {
    /// Lanes without a packet: weight 0 in the top layer.
    pub(super) fn none(top: &Flight) -> Self {
        let [zero, one] = [0.0, 1.0].map(splat);
        let medium = Medium::splat(top);
        Self { position_mm: [zero; 3], dir_travel: [zero, zero, one], weight: zero, layer: zero, medium }
    }

    /// Puts packets of this weight just under the surface, into the lanes of the mask.
    #[inline(always)]
    pub(super) fn enter(&mut self, lanes: Lanes, weight: Lanes, flights: &[Flight]) {
        let keep = !lanes;
        let [x, y, z] = self.position_mm;
        self.position_mm = [keep & x, keep & y, keep & z];
        let [x, y, z] = self.dir_travel;
        self.dir_travel = [keep & x, keep & y, lanes.bitselect(splat(1.0), z)];
        self.weight = lanes.bitselect(weight, self.weight);
        if flights.len() > 1 {
            self.layer = keep & self.layer;
            self.medium.enter(lanes, &flights[0]);
        }
    }

    /// Flies to the next collision or to the next interface, whichever comes first. The exponential distribution forgets
    /// what it has flown, so that beyond an interface a new path is drawn.
    #[inline(always)]
    pub(super) fn fly(&mut self, unit: Lanes) -> Landing {
        let [_, _, dir_z] = self.dir_travel;
        let downwards = dir_z.simd_gt(splat(0.0));
        let edge_mm = downwards.select(self.medium.bounds_mm[1], self.medium.bounds_mm[0]);
        // Level flight never meets an interface, not even the one it is on: something over nothing is infinite.
        let height_mm = (edge_mm - self.position_mm[2]).abs().fast_max(splat(f64::MIN_POSITIVE));
        let to_edge_mm = height_mm / dir_z.abs();
        let free_path_mm = -unit.ln() * self.medium.mean_free_path_mm;
        let collides = free_path_mm.simd_lt(to_edge_mm);
        // What is gone for good is gone far, not infinitely far: nothing times that is still nothing.
        let distance_mm = free_path_mm.fast_min(to_edge_mm).fast_min(splat(f64::MAX));
        for (place, dir) in self.position_mm.iter_mut().zip(self.dir_travel) {
            *place = dir.mul_add(distance_mm, *place);
        }
        Landing { collides, downwards, distance_mm }
    }

    /// Directions after a collision, from one draw of random bits.
    #[inline(always)]
    pub(super) fn scattered(&self, bits: u64x8) -> [Lanes; 3] {
        let one_minus_cos = sample_one_minus_cos(self.medium.g, half_unit(bits));
        turned(self.dir_travel, one_minus_cos, on_circle(bits))
    }

    /// What the interface would do to each packet.
    #[inline(always)]
    pub(super) fn crossing(&self, downwards: Lanes, bits: u64x8) -> Crossing {
        let [x, y, z] = self.dir_travel;
        let sign = splat(-0.0);
        let cos = z.abs();
        let ratio = downwards.select(self.medium.index_over_beyond[1], self.medium.index_over_beyond[0]);
        let (reflectance, cos_beyond) = fresnel_lanes(ratio, cos);
        let reflects = half_unit(bits).simd_lt(reflectance);
        let stretch = reflects.select(splat(1.0), ratio);
        let height = reflects.select(cos, cos_beyond) | (sign & (z ^ reflects));
        Crossing { reflects, cos_beyond, dir_travel: [x * stretch, y * stretch, height] }
    }

    /// New directions for the lanes of the mask, those of the crossing for the others.
    #[inline(always)]
    pub(super) fn turn(&mut self, lanes: Lanes, scattered: [Lanes; 3], crossing: &Crossing) {
        for (i, dir) in self.dir_travel.iter_mut().enumerate() {
            *dir = lanes.select(scattered[i], crossing.dir_travel[i]);
        }
    }

    /// Moves the packets of some lanes on to the layers whose numbers stand there already.
    #[inline(always)]
    pub(super) fn change_medium(&mut self, lanes: u32, flights: &[Flight]) {
        let layers = self.layer.to_array();
        for lane in lanes_of(lanes) {
            self.medium.set(lane, &flights[layers[lane] as usize]);
        }
    }
}

impl Medium {
    #[inline(always)]
    fn splat(flight: &Flight) -> Self {
        Self {
            mean_free_path_mm: splat(flight.mean_free_path_mm),
            absorbed: splat(flight.absorbed),
            g: splat(flight.g),
            bounds_mm: flight.bounds_mm.map(splat),
            index_over_beyond: flight.index_over_beyond.map(splat),
        }
    }

    #[inline(always)]
    fn numbers(&mut self) -> [&mut Lanes; 7] {
        let [top, bottom] = &mut self.bounds_mm;
        let [up, down] = &mut self.index_over_beyond;
        [&mut self.mean_free_path_mm, &mut self.absorbed, &mut self.g, top, bottom, up, down]
    }

    #[inline(always)]
    fn enter(&mut self, lanes: Lanes, flight: &Flight) {
        for (number, value) in self.numbers().into_iter().zip(flight.numbers()) {
            *number = lanes.bitselect(splat(value), *number);
        }
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, flight: &Flight) {
        for (number, value) in self.numbers().into_iter().zip(flight.numbers()) {
            number.as_mut_array()[lane] = value;
        }
    }
}

/// Directions turned by angles (1 - their cosines are given) towards points on the circle around them.
#[inline(always)]
fn turned(dir: [Lanes; 3], one_minus_cos: Lanes, [cos_azimuth, sin_azimuth]: [Lanes; 2]) -> [Lanes; 3] {
    let [zero, one] = [0.0, 1.0].map(splat);
    let cos = one - one_minus_cos;
    let sin = (one_minus_cos * (one + cos)).fast_max(zero).sqrt();
    let [x, y, z] = dir;
    // Orthonormal frame without a branch at the poles (Duff et al. 2017, JCGT 6(1), listing 3).
    let sign_bit = z & splat(-0.0);
    let sign = one | sign_bit;
    let a = splat(-1.0) / (sign + z);
    let b = x * y * a;
    let (u, v) = (sin * cos_azimuth, sin * sin_azimuth);
    let signed_u = u ^ sign_bit;
    let turned = [
        cos.mul_add(x, v.mul_add(b, signed_u.mul_add(x * x * a, u))),
        cos.mul_add(y, signed_u.mul_add(b, v * (y * y).mul_add(a, sign))),
        cos.mul_add(z, -(signed_u.mul_add(x, v * y))),
    ];
    // Rounding would add up over thousands of turns: one step of Newton's towards length 1.
    let [x, y, z] = turned;
    let length2 = x.mul_add(x, y.mul_add(y, z * z));
    let scale = length2.mul_neg_add(splat(0.5), splat(1.5));
    turned.map(|component| component * scale)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::tests::layer;
    use crate::simulate::{Layer, LayeredSlab};

    fn packets(layer: Layer) -> Packets {
        let slab = LayeredSlab::in_air(vec![layer]).expect("the layer is possible");
        Packets::none(&slab.flights()[0])
    }

    #[test]
    fn paths_are_logarithms_to_three_roundings() {
        let mut worst = 0.0f64;
        let mut check = |unit: f64| {
            let ln = splat(unit).ln().to_array()[0];
            worst = worst.max((ln / unit.ln() - 1.0).abs());
        };
        for i in 1..200_000 {
            let share = f64::from(i) / 200_000.0;
            check(share);
            // Near both ends of what is drawn, 2^-53 and 1 - 2^-53.
            check(1.0 - 2f64.powf(-53.0 * share).max(0.5 * f64::EPSILON));
            check(2f64.powf(-53.0 * share));
        }
        assert!(worst < 3.0 * f64::EPSILON, "{} roundings", worst / f64::EPSILON);
    }

    #[test]
    fn level_flight_meets_no_interface_and_clear_layers_no_collision() {
        let mut level = packets(layer(0.1, 5.0, 0.8, 1.4, 1.0));
        for (dir_z, height_mm) in [(0.0, 0.3), (-0.0, 0.0), (0.0, 1.0)] {
            level.position_mm = [0.0, 0.0, height_mm].map(splat);
            level.dir_travel = [1.0, 0.0, dir_z].map(splat);
            let landing = level.fly(splat(0.5));
            assert!(landing.collides.all());
            assert!((level.position_mm[0].to_array()[0] - 2f64.ln() / 5.1).abs() < 1e-15);
            assert_eq!(level.position_mm[2].to_array()[0], height_mm);
        }
        let mut clear = packets(layer(0.0, 0.0, 0.8, 1.4, 1.0));
        assert!(!clear.fly(splat(1e-16)).collides.any());
        assert_eq!(clear.position_mm[2].to_array()[0], 1.0);
        let mut endless = packets(layer(0.0, 0.0, 0.8, 1.4, f64::INFINITY));
        assert!(!endless.fly(splat(0.5)).collides.any());
        // Gone straight down: far, but not beside the beam.
        assert_eq!(endless.position_mm.map(|p| p.to_array()[0]), [0.0, 0.0, f64::MAX]);
    }

    #[test]
    fn turns_keep_length_and_have_the_angle_asked_for() {
        let azimuths = [[1.0, 0.0], [0.0, 1.0], [-0.6, 0.8], [0.6, -0.8]];
        for dir in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.6, 0.0, -0.8], [-0.48, 0.64, 0.6], [1.0, 0.0, -0.0]]
        {
            for one_minus_cos in [0.0, 1e-12, 0.3, 1.0, 2.0] {
                for azimuth in azimuths {
                    let new = turned(dir.map(splat), splat(one_minus_cos), azimuth.map(splat));
                    let new = new.map(|c| c.to_array()[0]);
                    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
                    assert!((dot(new, new) - 1.0).abs() < 4.0 * f64::EPSILON, "{dir:?} {one_minus_cos}");
                    assert!((1.0 - dot(new, dir) - one_minus_cos).abs() < 4.0 * f64::EPSILON, "{dir:?}");
                }
            }
        }
    }
}
