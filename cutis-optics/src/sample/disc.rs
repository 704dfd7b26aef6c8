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
