//! What a translation loses: the distance of two profiles, and of their totals.
//!
//! Relative RMS power error (d'Eon, Luebke & Enderton 2007, eq. 10) of *any* two profiles, by Parseval in spatial frequency:
//! sqrt(∫ k (F - G)² dk / ∫ k F² dk). Profiles that rise as 1/r (Burley's, or any with single scattering) have infinite power
//! there, so both are seen as lit by a Gaussian beam of standard deviation b: their spectra are multiplied by e^(-b² k²/2).
//! The number depends on b, which is therefore part of the answer: the finer the beam, the more the centre counts.

use crate::Profile;

/// Standard deviation of the fine beam that losses are stated for, in transport mean free paths.
pub const FINE_BEAM_MEAN_FREE_PATHS: f64 = 0.05;
/// Standard deviation of the wide beam, in transport mean free paths: parameters are fitted under it, because detail finer
/// than that is wrong in diffusion theory itself. Fitted under the fine beam, Burley's profile would be blunted three times
/// over to please a centre that the dipole rounds off.
pub const WIDE_BEAM_MEAN_FREE_PATHS: f64 = 1.0;

/// Step in ln k. The integrands are analytic for |Im ln k| < pi/4: the trapezoid rule errs by e^(-pi²/(2 · 0.1)) = 1e-21.
const STEP: f64 = 0.1;
/// Lowest frequency times b. What lies below weighs (1e-10 w/b)²/2 for a profile of width w: 1e-6 at w = 1e7 b.
const LOWEST: f64 = 1e-10;
/// Highest frequency times b: e^(-7²) = 1e-21.
const HIGHEST: f64 = 7.0;

/// One channel of a translation: how far what the target draws is from what was asked.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct ChannelLoss {
    /// Under a beam of [`FINE_BEAM_MEAN_FREE_PATHS`].
    pub fine: LitError,
    /// Under a beam of [`WIDE_BEAM_MEAN_FREE_PATHS`].
    pub wide: LitError,
    /// Total of the target over total of the profile, less 1.
    pub relative_change_of_total: f64,
}

/// A relative RMS power error, and the beam that belongs to it.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct LitError {
    /// Standard deviation b of the beam, mm.
    pub beam_standard_deviation_mm: f64,
    /// sqrt(∫ k (F - G)² e^(-b² k²) dk / ∫ k F² e^(-b² k²) dk), no unit.
    pub relative_rms_power_error: f64,
}

impl ChannelLoss {
    /// Measures `drawn` against `wanted`, of transport mean free path l.
    pub fn between(wanted: &dyn Profile, drawn: &dyn Profile, l_mm: f64) -> Self {
        let under = |mean_free_paths: f64| {
            let beam_standard_deviation_mm = mean_free_paths * l_mm;
            let lit = LitSpectrum::new(wanted, beam_standard_deviation_mm);
            LitError { beam_standard_deviation_mm, relative_rms_power_error: lit.relative_error(drawn) }
        };
        Self {
            fine: under(FINE_BEAM_MEAN_FREE_PATHS),
            wide: under(WIDE_BEAM_MEAN_FREE_PATHS),
            relative_change_of_total: drawn.total() / wanted.total() - 1.0,
        }
    }
}

/// A profile lit by a Gaussian beam, sampled once, so that many others can be held against it.
pub struct LitSpectrum {
    nodes: Vec<Node>,
    norm: f64,
}

struct Node {
    k_per_mm: f64,
    value: f64,
    /// k · k dt e^(-b² k²).
    weight: f64,
}

impl LitSpectrum {
    /// Samples `profile` under a beam of standard deviation b.
    ///
    /// # Panics
    /// If b is not a positive, finite length.
    pub fn new(profile: &dyn Profile, beam_standard_deviation_mm: f64) -> Self {
        let b = beam_standard_deviation_mm;
        assert!(b > 0.0 && b.is_finite(), "a beam has a width, got {b} mm");
        let count = ((HIGHEST / LOWEST).ln() / STEP).ceil() as usize;
        let node = |i: usize| {
            let x = LOWEST * (STEP * i as f64).exp();
            let k_per_mm = x / b;
            Node {
                k_per_mm,
                value: profile.spectrum(k_per_mm),
                weight: STEP * k_per_mm.powi(2) * (-x * x).exp(),
            }
        };
        let nodes: Vec<Node> = (0..=count).map(node).collect();
        let norm = nodes.iter().map(|n| n.weight * n.value * n.value).sum::<f64>().sqrt();
        Self { nodes, norm }
    }

    /// Relative RMS power error of another profile under the same beam, no unit.
    pub fn relative_error(&self, other: &dyn Profile) -> f64 {
        let square = |n: &Node| n.weight * (n.value - other.spectrum(n.k_per_mm)).powi(2);
        self.nodes.iter().map(square).sum::<f64>().sqrt() / self.norm
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::{Burley, Dipole, Gaussian, GaussianSum, Medium, relative_rms_power_error};

    fn gaussian(weight: f64, variance_mm2: f64) -> GaussianSum {
        GaussianSum::new(vec![Gaussian { weight, variance_mm2 }])
    }

    #[test]
    fn two_gaussians_meet_the_closed_form() {
        // ∫ k e^(-c k²) dk = 1/(2c); with the beam, c is the mean of the two variances plus b².
        let (v, u, b) = (1.3, 0.4, 0.2);
        let inner = |c: f64| 0.5 / (c + b * b);
        let square = 0.25 * inner(v) - 2.0 * 0.5 * 0.6 * inner(0.5 * (v + u)) + 0.36 * inner(u);
        let exact = (square / (0.25 * inner(v))).sqrt();
        let ours = LitSpectrum::new(&gaussian(0.5, v), b).relative_error(&gaussian(0.6, u));
        assert!((ours / exact - 1.0).abs() < 1e-11, "{ours} against {exact}");
    }

    #[test]
    fn a_fine_beam_gives_the_error_of_the_fits() {
        let dipole = Dipole::new(&Medium::new(0.032, 0.74, 1.3).unwrap()).unwrap();
        let sum = crate::fit(&dipole, 4, crate::FitMethod::Optimal).unwrap().sum;
        let ours = LitSpectrum::new(&dipole, 1e-4).relative_error(&sum);
        let theirs = relative_rms_power_error(&dipole, &sum).unwrap();
        // The beam blurs by (b/l)² = 1e-8 of the power; the lowest frequency leaves out less.
        assert!((ours / theirs - 1.0).abs() < 1e-4, "{ours} against {theirs}");
    }

    #[test]
    fn the_power_of_burley_grows_without_end_as_the_beam_gets_finer() {
        // k R → A/(2d): each factor of e in b adds A²/(4 d²) to ∫ k R² dk.
        let burley = Burley::new(0.7, 1.0).unwrap();
        let power = |b: f64| LitSpectrum::new(&burley, b).norm.powi(2);
        let step = power(1e-6) - power(1e-5);
        let expected = 0.49 / 4.0 * 10_f64.ln();
        assert!((step / expected - 1.0).abs() < 1e-5, "{step} against {expected}");
    }

    #[test]
    fn totals_are_compared() {
        let loss = ChannelLoss::between(&gaussian(0.5, 1.0), &gaussian(0.4, 1.0), 0.1);
        assert!((loss.relative_change_of_total + 0.2).abs() < 1e-15);
        // Same shape: the error is that of the height, under every beam.
        assert!((loss.fine.relative_rms_power_error - 0.2).abs() < 1e-12);
        assert!((loss.wide.relative_rms_power_error - 0.2).abs() < 1e-12);
    }
}
