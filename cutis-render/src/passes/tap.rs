//! Seven taps that have exactly the variance that is asked for.
//!
//! The weights are a unit Gaussian integrated over unit cells, the public kernel {.006 .061 .242 .383 .242 .061 .006}
//! to full precision and scaled to sum 1. Its variance at spacing 1 is 1.08, and a tap that falls between two texels
//! is read by linear interpolation, which adds f(1-f) texel² of its own; so the spacing is found by inverting the
//! variance that the discrete kernel really has.
//!
//! The first blur of raw texels has one more thing to respect: a texel stands for the light on its whole footprint.
//! What a Gaussian of variance v makes of a footprint, sampled at texel centres, is the Gaussian integrated over
//! cells; its discrete variance is v + 1/12 texel² for wide Gaussians and falls to 0 for narrow ones, where all the
//! energy stays in its own texel. [`Taps::discrete_variance`] is that function, and blurs between levels take its
//! differences.

use std::f64::consts::FRAC_1_SQRT_2;
use std::sync::LazyLock;

/// Widest spacing in texels: nothing wider is asked for, because wide Gaussians live in small textures.
const MAX_SPACING: f64 = 64.0;
/// Entries of the table from standard deviation to spacing.
const SPACINGS: usize = 4096;
/// Entries of the table of discrete variances, over variances from 0 to [`NARROW_TEXEL2`].
const VARIANCES: usize = 512;
/// Variance in texel² up to which seven cells hold the Gaussian: 1 in 600 of its energy lies beyond them.
pub const WIDEST_CELLS_TEXEL2: f64 = 1.25;
/// Variance in texel² above which the discrete variance is v + 1/12 to 1e-6: its error falls as exp(-2 pi² v).
pub const NARROW_TEXEL2: f64 = 1.0;

/// The kernel's weights and the tables that set its spacing.
pub struct Taps {
    /// Weight of the centre, then of the taps at one, two and three spacings on either side.
    pub weights: [f32; 4],
    /// Spacing in texels by the standard deviation wanted, from 0 to `max_deviation` evenly.
    pub spacing: Vec<f32>,
    /// Standard deviation at the widest spacing, texels.
    pub max_deviation: f32,
    /// Discrete variance in texel² by the variance, from 0 to [`NARROW_TEXEL2`] evenly.
    pub narrow: Vec<f32>,
    /// Weights on neighbouring texels for variances from 0 to [`WIDEST_CELLS_TEXEL2`] evenly.
    pub cells: Vec<[f32; 4]>,
    /// Variance of the weights at spacing 1, texel².
    pub unit_variance: f32,
}

/// The one kernel of this crate.
pub static TAPS: LazyLock<Taps> = LazyLock::new(Taps::new);

impl Taps {
    fn new() -> Self {
        let weights = cell_weights(1.0);
        let max_deviation = variance_at(&weights, MAX_SPACING).sqrt();
        let spacing = (0..SPACINGS)
            .map(|i| spacing_for(&weights, (i as f64 / (SPACINGS - 1) as f64 * max_deviation).powi(2)) as f32)
            .collect();
        let narrow = (0..VARIANCES)
            .map(|i| discrete_variance_texel2(i as f64 / (VARIANCES - 1) as f64 * NARROW_TEXEL2) as f32)
            .collect();
        let cells = (0..VARIANCES)
            .map(|i| {
                cell_weights((i as f64 / (VARIANCES - 1) as f64 * WIDEST_CELLS_TEXEL2).sqrt())
                    .map(|w| w as f32)
            })
            .collect();
        Self {
            weights: weights.map(|w| w as f32),
            spacing,
            max_deviation: max_deviation as f32,
            narrow,
            cells,
            unit_variance: weights.iter().zip(0..).map(|(w, k)| 2.0 * w * f64::from(k * k)).sum::<f64>()
                as f32,
        }
    }

    /// Largest variance that [`Taps::cells`] covers, texel².
    pub fn widest_cells(&self) -> f32 {
        WIDEST_CELLS_TEXEL2 as f32
    }

    /// Weights on the texel itself and its neighbours at one, two and three texels: a Gaussian of this variance in
    /// texel², integrated over each texel.
    pub fn cells(&self, variance_texel2: f32) -> [f32; 4] {
        let x = (variance_texel2 / WIDEST_CELLS_TEXEL2 as f32 * (VARIANCES - 1) as f32).max(0.0);
        let i = (x as usize).min(VARIANCES - 2);
        let f = (x - i as f32).min(1.0);
        std::array::from_fn(|k| self.cells[i][k] + (self.cells[i + 1][k] - self.cells[i][k]) * f)
    }

    /// Spacing in texels at which taps read by cubic interpolation have this variance in texel². Cubic interpolation
    /// is exact for parabolas, so it adds nothing to the variance.
    pub fn cubic_spacing(&self, variance_texel2: f32) -> f32 {
        (variance_texel2.max(0.0) / self.unit_variance).sqrt()
    }

    /// Spacing in texels at which taps read by linear interpolation have this variance in texel².
    pub fn spacing(&self, variance_texel2: f32) -> f32 {
        let x = variance_texel2.max(0.0).sqrt() / self.max_deviation * (SPACINGS - 1) as f32;
        interpolate(&self.spacing, x)
    }

    /// Variance, texel², of what a Gaussian of variance `variance_texel2` makes of one lit texel.
    pub fn discrete_variance(&self, variance_texel2: f32) -> f32 {
        if variance_texel2 >= NARROW_TEXEL2 as f32 {
            return variance_texel2 + 1.0 / 12.0;
        }
        interpolate(&self.narrow, variance_texel2.max(0.0) / NARROW_TEXEL2 as f32 * (VARIANCES - 1) as f32)
    }
}

fn interpolate(table: &[f32], x: f32) -> f32 {
    let x = x.min((table.len() - 1) as f32);
    let i = (x as usize).min(table.len() - 2);
    table[i] + (table[i + 1] - table[i]) * (x - i as f32)
}

/// A Gaussian of standard deviation `sigma` integrated over the unit cell around `x`.
fn cell(x: f64, sigma: f64) -> f64 {
    let upper_tail = |x: f64| 0.5 * libm::erfc(x / sigma * FRAC_1_SQRT_2);
    upper_tail(x - 0.5) - upper_tail(x + 0.5)
}

/// A Gaussian integrated over the unit cells around 0, 1, 2 and 3, scaled so that all seven cells sum to 1.
fn cell_weights(sigma: f64) -> [f64; 4] {
    let cells: [f64; 4] = std::array::from_fn(|j| cell(j as f64, sigma.max(1e-6)));
    let total = cells[0] + 2.0 * (cells[1] + cells[2] + cells[3]);
    cells.map(|w| w / total)
}

/// Variance of the seven taps at a spacing, linear interpolation included: p² + f(1-f) is p² interpolated linearly
/// between the integers around p.
fn variance_at(weights: &[f64; 4], spacing: f64) -> f64 {
    (1..4)
        .map(|k| {
            let p = k as f64 * spacing;
            let f = p - p.floor();
            2.0 * weights[k] * (p * p + f * (1.0 - f))
        })
        .sum()
}

/// Inverse of [`variance_at`], which grows with the spacing, by bisection.
fn spacing_for(weights: &[f64; 4], variance: f64) -> f64 {
    let (mut lo, mut hi) = (0.0, MAX_SPACING);
    for _ in 0..60 {
        let middle = 0.5 * (lo + hi);
        if variance_at(weights, middle) < variance { lo = middle } else { hi = middle }
    }
    0.5 * (lo + hi)
}

fn discrete_variance_texel2(variance: f64) -> f64 {
    let sigma = variance.sqrt();
    if sigma < 1e-3 {
        return 0.0;
    }
    (1..40).map(|j| 2.0 * f64::from(j * j) * cell(f64::from(j), sigma)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_the_public_kernel_and_sum_to_one() {
        let w = TAPS.weights;
        for (weight, public) in w.iter().zip([0.383, 0.242, 0.061, 0.006]) {
            assert!((weight - public).abs() < 6e-4, "{weight} {public}");
        }
        assert!((w[0] + 2.0 * (w[1] + w[2] + w[3]) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn the_spaced_kernel_has_the_variance_asked_for() {
        let weights = TAPS.weights.map(f64::from);
        for variance in [0.001f32, 0.02, 0.3, 1.0, 1.083, 2.5, 7.7, 40.0, 900.0] {
            let got = variance_at(&weights, f64::from(TAPS.spacing(variance))) as f32;
            // The table has 4096 steps of 0.016 texels deviation, interpolated; narrow kernels feel the step most.
            assert!(
                (got / variance - 1.0).abs() < 5e-3 || (got - variance).abs() < 1e-4,
                "{variance}: {got}"
            );
        }
    }

    #[test]
    fn a_narrow_gaussian_keeps_its_energy_in_its_texel() {
        assert_eq!(TAPS.discrete_variance(0.0), 0.0);
        // Standard deviation of a tenth of a texel: 5 deviations to the texel's edge, 6e-7 of the energy leaves.
        assert!(TAPS.discrete_variance(0.01) < 1e-5);
        // Wide ones have the footprint's 1/12 on top.
        assert!((TAPS.discrete_variance(0.9) - 0.9 - 1.0 / 12.0).abs() < 1e-4);
    }
}
