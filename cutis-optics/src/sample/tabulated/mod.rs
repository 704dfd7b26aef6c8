//! Radii of any profile, from a table of the inverse of its cumulative distribution.
//!
//! Symbols: y = sqrt(-ln(1 - xi)); r(y) is piecewise cubic, see the module `rings` for the nodes and their tolerance.
//! The density and the distribution told are those of the table itself, not of the profile it was made from: an estimator
//! that divides by them has no bias, however coarse the table.

mod rings;

use super::{RadialSampler, SamplerError, in_lanes, odds, unit};
use crate::Profile;
use core::f64::consts::PI;
use wide::f32x8;

/// Mean free paths that stay far from the ends of f32, mm.
const MEAN_FREE_PATHS_MM: core::ops::RangeInclusive<f64> = 1e-12..=1e12;
/// Buckets for every piece: most hold one edge at most.
const BUCKETS_PER_PIECE: usize = 2;
/// Halvings of a piece when a radius is looked for in it: past the last digit of an f32.
const BISECTIONS: usize = 40;

/// Draws from any [`Profile`]: layered, simulated, a sum of others.
#[derive(Debug, Clone, PartialEq)]
pub struct TabulatedSampler {
    /// y where each piece begins, and infinity at the end.
    y_from: Vec<f32>,
    /// Coefficients of each piece in powers of y - `y_from`, mm.
    cubics_mm: Vec<[f32; 4]>,
    /// The piece in which each bucket of y begins.
    guide: Vec<u32>,
    buckets_per_y: f32,
    y_to: f32,
}

impl TabulatedSampler {
    /// The table of a profile. Where R is below 0, as rounding may leave it far out, it is taken for 0.
    ///
    /// The radius is within 1e-5 of the mean free path from the exact inverse up to 20 mean free paths away, and farther
    /// out within 2.5e-7 of itself and what the last digit of `xi` means.
    ///
    /// # Errors
    /// If the mean free path is no length, or the profile without light.
    pub fn new(profile: &dyn Profile, mean_free_path_mm: f64) -> Result<Self, SamplerError> {
        if !MEAN_FREE_PATHS_MM.contains(&mean_free_path_mm) {
            return Err(SamplerError::MeanFreePath { mean_free_path_mm });
        }
        let pieces = rings::pieces(profile, mean_free_path_mm);
        let Some(last) = pieces.last() else { return Err(SamplerError::Total { total: profile.total() }) };
        let y_to = last.y_to as f32;
        let mut y_from: Vec<f32> = pieces.iter().map(|piece| piece.y_from as f32).collect();
        let cubics_mm = pieces.iter().map(|piece| piece.cubic_mm.map(|c| c as f32)).collect();
        let buckets = BUCKETS_PER_PIECE * pieces.len();
        let buckets_per_y = buckets as f32 / y_to;
        let before = |bucket: usize| y_from.partition_point(|&y| ((y * buckets_per_y) as usize) < bucket);
        let guide = (0..=buckets).map(|bucket| before(bucket).saturating_sub(1) as u32).collect();
        y_from.push(f32::INFINITY);
        Ok(Self { y_from, cubics_mm, guide, buckets_per_y, y_to })
    }

    /// Number of pieces, each of five numbers.
    pub fn pieces(&self) -> usize {
        self.cubics_mm.len()
    }

    #[inline(always)]
    fn radii(&self, xi: f32x8) -> f32x8 {
        let y = odds(unit(xi), f32x8::ZERO, f32x8::ONE).ln_1p().sqrt();
        f32x8::new(y.to_array().map(|y| self.at(y)))
    }

    #[inline(always)]
    fn at(&self, y: f32) -> f32 {
        let bucket = ((y * self.buckets_per_y) as usize).min(self.guide.len() - 1);
        let mut piece = self.guide[bucket] as usize;
        while self.y_from[piece + 1] <= y {
            piece += 1;
        }
        let d = y - self.y_from[piece];
        let [a, b, c, e] = self.cubics_mm[piece];
        d.mul_add(d.mul_add(d.mul_add(e, c), b), a)
    }

    /// y and dr/dy at a radius; none where nothing is.
    fn found(&self, radius_mm: f64) -> Option<(f64, f64)> {
        let piece =
            self.cubics_mm.partition_point(|cubic| f64::from(cubic[0]) <= radius_mm).saturating_sub(1);
        let from = f64::from(self.y_from[piece]);
        let width = f64::from(self.y_from[piece + 1].min(self.y_to)) - from;
        let [a, b, c, e] = self.cubics_mm[piece].map(f64::from);
        let (mut low, mut high) = (0.0, width);
        for _ in 0..BISECTIONS {
            let d = 0.5 * (low + high);
            *(if a + d * (b + d * (c + d * e)) <= radius_mm { &mut low } else { &mut high }) = d;
        }
        let end_mm = a + width * (b + width * (c + width * e));
        let is_inside = radius_mm <= end_mm * (1.0 + 4.0 * f64::from(f32::EPSILON));
        is_inside.then_some((from + low, b + low * (2.0 * c + 3.0 * low * e)))
    }
}

impl RadialSampler for TabulatedSampler {
    fn radius_mm(&self, xi: f32) -> f32 {
        self.radii(f32x8::splat(xi)).to_array()[0]
    }

    /// With xi = 1 - e^(-y²): p = dxi/dr / (2 pi r) = y e^(-y²) / (pi r dr/dy).
    fn pdf_per_mm2(&self, radius_mm: f32) -> f32 {
        // The innermost piece is a straight line through 0: there p is the same everywhere, and 0/0 at 0 alone.
        let innermost_mm = self.at(self.y_from[1].min(self.y_to) * 0.5);
        let r_mm = f64::from(radius_mm.max(innermost_mm));
        let density = |(y, slope_mm): (f64, f64)| y * (-y * y).exp() / (PI * r_mm * slope_mm);
        self.found(r_mm).map_or(0.0, density) as f32
    }

    fn cdf(&self, radius_mm: f32) -> f32 {
        let last = self.cubics_mm.len() - 1;
        let y = match self.found(f64::from(radius_mm)) {
            Some((y, _)) => y,
            None if f64::from(radius_mm) < f64::from(self.cubics_mm[last][0]) => self.y_after(radius_mm),
            None => return 1.0,
        };
        -(-y * y).exp_m1() as f32
    }

    fn radii_mm(&self, xi: &[f32], radii_mm: &mut [f32]) {
        in_lanes(xi, radii_mm, |xi| self.radii(xi));
    }
}

impl TabulatedSampler {
    /// y of a radius between two pieces, where the profile has no light.
    fn y_after(&self, radius_mm: f32) -> f64 {
        f64::from(self.y_from[self.cubics_mm.partition_point(|cubic| cubic[0] <= radius_mm)])
    }
}
