//! Places on the tangent plane around a point, few and evenly spread, with the density of a profile.
//!
//! Point i of N takes `xi` from the middle of its share [i/N, (i+1)/N) and turns by the golden ratio: the seeds of a
//! sunflower (Vogel 1979, doi:10.1016/0025-5564(79)90080-4, not opened), pulled in or out by the profile. Neighbouring pixels
//! take other places within the shares and other turns, so that sixteen of them together hold sixteen times the points:
//! interleaved sampling, Keller & Heidrich 2001, doi:10.1007/978-3-7091-6242-2_25 (not opened).

use super::RadialSampler;
use core::f64::consts::TAU;

/// Samples of a point where speed counts.
pub const DISC_SAMPLES: usize = 16;
/// Samples of a point where noise counts.
pub const DISC_SAMPLES_FINE: usize = 32;
/// Pixels, in a square, whose patterns complete each other.
pub const INTERLEAVED_PIXELS: u32 = 16;

/// One turn less the golden section of it, in turns.
const GOLDEN_TURNS: f64 = 0.381_966_011_250_105_2;

/// How many points, and how they are shifted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiscPattern {
    count: usize,
    shift: f64,
    turns: f64,
}

/// A place on the tangent plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiscSample {
    /// Along the tangent and the bitangent, mm.
    pub offset_mm: [f32; 2],
    /// Distance from the point, mm.
    pub radius_mm: f32,
    /// Density over the plane there, 1/mm².
    pub pdf_per_mm2: f32,
}

impl DiscPattern {
    /// A pattern of `count` points; `shift`, in [0, 1), is their place within their shares, `turns` turns all of them.
    pub fn new(count: usize, shift: f64, turns: f64) -> Self {
        Self { count, shift, turns }
    }

    /// The pattern of a pixel among its neighbours.
    pub fn interleaved(count: usize, x: u32, y: u32) -> Self {
        let pixels = f64::from(INTERLEAVED_PIXELS);
        let place = x % 4 + 4 * (y % 4);
        // 7 and 16 have no common factor: every shift meets one turn, and neighbours are far apart in both.
        let shifted = 7 * place % INTERLEAVED_PIXELS;
        Self::new(count, (f64::from(shifted) + 0.5) / pixels, f64::from(place) / pixels)
    }

    /// The same in another of many rounds, whose mean is taken: all of them together fill shares and turns evenly
    /// (multiples of the plastic number's powers, Roberts 2018).
    pub fn in_round(self, round: u32) -> Self {
        let along = |from: f64, step: f64| (from + step * f64::from(round)).fract();
        Self {
            shift: along(self.shift, 0.754_877_666_246_693),
            turns: along(self.turns, 0.569_840_290_998_053_3),
            ..self
        }
    }

    /// The points as a sampler spreads them, from the first share of `xi` to the last.
    pub fn samples(self, sampler: &dyn RadialSampler) -> impl Iterator<Item = DiscSample> {
        (0..self.count).map(move |i| {
            let xi = (i as f64 + self.shift) / self.count as f64;
            let radius_mm = sampler.radius_mm(xi as f32);
            let (sin, cos) = (TAU * (GOLDEN_TURNS * i as f64 + self.turns).fract()).sin_cos();
            DiscSample {
                offset_mm: [radius_mm * cos as f32, radius_mm * sin as f32],
                radius_mm,
                pdf_per_mm2: sampler.pdf_per_mm2(radius_mm),
            }
        })
    }
}

impl Default for DiscPattern {
    fn default() -> Self {
        Self::new(DISC_SAMPLES, 0.5, 0.0)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::sample::DipoleSampler;
    use crate::{Dipole, Medium, Profile};

    fn sampler() -> (Dipole, DipoleSampler) {
        let dipole = Dipole::new(&Medium::new(0.032, 0.74, 1.3).unwrap()).unwrap();
        (dipole, DipoleSampler::new(&dipole))
    }

    #[test]
    fn places_are_at_their_radius_with_its_density() {
        let (dipole, sampler) = sampler();
        for count in [0, 1, DISC_SAMPLES, DISC_SAMPLES_FINE, 1000] {
            let samples: Vec<DiscSample> = DiscPattern::new(count, 0.5, 0.2).samples(&sampler).collect();
            assert_eq!(samples.len(), count);
            for sample in samples {
                let [x, y] = sample.offset_mm;
                // Both products and both trigonometric functions are rounded.
                assert!((x.hypot(y) / sample.radius_mm - 1.0).abs() < 4.0 * f32::EPSILON, "{sample:?}");
                let density = dipole.at_mm(f64::from(sample.radius_mm)) / dipole.total();
                assert!((f64::from(sample.pdf_per_mm2) / density - 1.0).abs() < f64::from(f32::EPSILON));
            }
        }
        assert_eq!(DiscPattern::default().samples(&sampler).count(), DISC_SAMPLES);
    }

    #[test]
    fn sixteen_pixels_fill_every_share_and_every_turn_once() {
        let patterns: Vec<DiscPattern> =
            (0..16).map(|i| DiscPattern::interleaved(DISC_SAMPLES, 40 + i % 4, 8 + i / 4)).collect();
        for of in [|p: &DiscPattern| p.shift, |p: &DiscPattern| p.turns] {
            let mut sixteenths: Vec<u32> = patterns.iter().map(|p| (16.0 * of(p)) as u32).collect();
            sixteenths.sort_unstable();
            assert_eq!(sixteenths, (0..16).collect::<Vec<u32>>());
        }
    }

    #[test]
    fn rounds_fill_shares_and_turns_evenly_and_the_first_changes_nothing() {
        let first = DiscPattern::interleaved(DISC_SAMPLES, 1, 2);
        assert_eq!(first.in_round(0), first);
        for of in [|p: &DiscPattern| p.shift, |p: &DiscPattern| p.turns] {
            let mut values: Vec<f64> = (0..64).map(|round| of(&first.in_round(round))).collect();
            values.sort_by(f64::total_cmp);
            // Along one axis the gaps of such a sequence have a few widths, the widest here 3.3 of 64 even ones.
            assert!(values.windows(2).all(|pair| pair[1] - pair[0] < 3.5 / 64.0), "{values:?}");
        }
    }

    #[test]
    fn the_edge_of_a_shadow_is_met_closer_than_by_chance() {
        let (_, sampler) = sampler();
        // Through the point itself a half-plane brings half of the light, however the edge is turned. Sixteen random places
        // are off by 1/8, and all 256 of sixteen pixels by 1/32, as a standard error.
        let (mut squares, mut squares_of_all) = (0.0, 0.0);
        for turn in 0..64 {
            let (sin, cos) = (TAU * f64::from(turn) / 64.0).sin_cos();
            let is_lit =
                |s: &DiscSample| f64::from(s.offset_mm[0]) * cos + f64::from(s.offset_mm[1]) * sin > 0.0;
            let lit = |i: u32| {
                DiscPattern::interleaved(16, i % 4, i / 4).samples(&sampler).filter(is_lit).count() as f64
                    / 16.0
            };
            let of_pixels: Vec<f64> = (0..16).map(lit).collect();
            squares += of_pixels.iter().map(|lit| (lit - 0.5).powi(2)).sum::<f64>() / (16.0 * 64.0);
            squares_of_all += (of_pixels.iter().sum::<f64>() / 16.0 - 0.5).powi(2) / 64.0;
        }
        eprintln!("edge: off by {:.4}, of sixteen pixels by {:.4}", squares.sqrt(), squares_of_all.sqrt());
        assert!(squares.sqrt() < 0.5 / 8.0 && squares_of_all.sqrt() < 0.5 / 32.0);
    }
}
