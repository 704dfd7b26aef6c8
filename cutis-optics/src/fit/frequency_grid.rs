//! Quadrature of ∫ k f(k) dk for profiles and Gaussians together.
//!
//! With k = e^t the integral is ∫ e^(2t) f dt over the whole line, and the trapezoid rule converges exponentially: for
//! e^(-v k²), analytic and decaying for |Im t| < pi/4, the error is e^(-pi²/(2h)); for the poles' e^(-z k) it is the square of
//! that. One logarithmic grid so serves narrow and wide terms alike.

use super::FitError;
use crate::{GaussianSum, Profile};

/// Step in ln k. e^(-pi²/(2h)) = 1e-18: below rounding.
const STEP: f64 = 0.12;
/// Lowest frequency, of that where the first profile has fallen to half. The part left out weighs (1e-5)²/2.
const LOW: f64 = 1e-5;
/// The upper end: where k R(k) has fallen to this part of its size at half height, …
const NEGLIGIBLE: f64 = 1e-13;
/// … and this factor more, so that Gaussians narrower than the profile's own detail are seen and punished.
const HEADROOM: f64 = 3.0;
/// Octaves searched up and down from 1/mm for the scale of a profile: 1e-18 to 1e18 per mm.
const SCALE_OCTAVES: i32 = 60;

/// Nodes in k and what each one counts.
pub(super) struct FrequencyGrid {
    k_per_mm: Vec<f64>,
    k_half_range_per_mm: (f64, f64),
}

impl FrequencyGrid {
    /// A grid that resolves all of `profiles`.
    pub(super) fn covering(profiles: &[&dyn Profile]) -> Result<Self, FitError> {
        let (mut high, mut range) = (0.0_f64, (f64::INFINITY, 0.0_f64));
        for profile in profiles {
            let half = half_frequency_per_mm(*profile)?;
            high = high.max(HEADROOM * end_frequency_per_mm(*profile, half));
            range = (range.0.min(half), range.1.max(half));
        }
        let low = LOW * range.0;
        let count = ((high / low).ln() / STEP).ceil() as usize;
        let k_per_mm = (0..=count).map(|i| low * (STEP * i as f64).exp()).collect();
        Ok(Self { k_per_mm, k_half_range_per_mm: range })
    }

    /// Frequencies, growing, 1/mm.
    pub(super) fn k_per_mm(&self) -> &[f64] {
        &self.k_per_mm
    }

    /// Number of nodes.
    pub(super) fn len(&self) -> usize {
        self.k_per_mm.len()
    }

    /// Lowest and highest frequency at which a profile has fallen to half: the scale for starting values.
    pub(super) fn k_half_range_per_mm(&self) -> (f64, f64) {
        self.k_half_range_per_mm
    }

    /// Square root of the quadrature weight at a node: sqrt(k · k dt), so that sums of squares are the integral.
    pub(super) fn root_weight(&self, k_per_mm: f64) -> f64 {
        k_per_mm * STEP.sqrt()
    }

    /// Smallest and largest variance that the nodes can tell from a spike or a constant, mm².
    pub(super) fn variance_range_mm2(&self) -> (f64, f64) {
        let (low, high) = (self.k_per_mm[0], self.k_per_mm[self.len() - 1]);
        // Narrow: e^-20 at the last node. Wide: e^-0.005 at the first, where nodes still see the whole fall.
        (40.0 / (high * high), 0.01 / (low * low))
    }

    /// sqrt(∫ k f² dk).
    pub(super) fn norm(&self, f: impl Fn(f64) -> f64) -> f64 {
        self.k_per_mm.iter().map(|&k| (self.root_weight(k) * f(k)).powi(2)).sum::<f64>().sqrt()
    }

    /// Relative RMS power error of a sum against a profile (d'Eon et al. 2007, eq. 10, by Parseval).
    pub(super) fn relative_error(&self, profile: &dyn Profile, sum: &GaussianSum) -> f64 {
        self.norm(|k| profile.spectrum(k) - sum.spectrum(k)) / self.norm(|k| profile.spectrum(k))
    }
}

/// Where the spectrum has fallen to half of the total, by octaves and bisection.
fn half_frequency_per_mm(profile: &dyn Profile) -> Result<f64, FitError> {
    let total = profile.total();
    if !(total.is_finite() && total > 0.0) {
        return Err(FitError::Total { total });
    }
    let above = |k: f64| profile.spectrum(k) > 0.5 * total;
    let fallen = (-SCALE_OCTAVES..=SCALE_OCTAVES).map(|i| 2_f64.powi(i)).find(|&k| !above(k));
    let k = fallen.filter(|&k| profile.spectrum(k).is_finite() && k > 2_f64.powi(-SCALE_OCTAVES));
    let (mut high, mut low) = k.map(|k| (k, 0.5 * k)).ok_or(FitError::Scale { total })?;
    // Six halvings of an octave: 1 %, enough for a scale.
    for _ in 0..6 {
        let middle = (low * high).sqrt();
        *(if above(middle) { &mut low } else { &mut high }) = middle;
    }
    Ok(high)
}

/// Where the profile no longer counts for the error integral. Two nodes in a row, as a spectrum may pass through zero.
fn end_frequency_per_mm(profile: &dyn Profile, half_per_mm: f64) -> f64 {
    let limit = NEGLIGIBLE * half_per_mm * profile.total();
    let small = |k: f64| (k * profile.spectrum(k)).abs() < limit;
    // A spectrum that never falls (a spike in r) is cut at 1e6 times its half frequency.
    let candidates = (0..64).map(|i| half_per_mm * (0.22 * f64::from(i)).exp());
    candidates.clone().find(|&k| small(k) && small(1.2 * k)).unwrap_or(half_per_mm * 1e6)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::{Dipole, Gaussian, Medium};

    fn gaussian(variance_mm2: f64) -> GaussianSum {
        GaussianSum::new(vec![Gaussian { weight: 1.0, variance_mm2 }])
    }

    #[test]
    fn gaussian_inner_products_meet_the_closed_form() {
        // ∫ k e^(-a k²/2) e^(-b k²/2) dk = 1/(a + b).
        let grid = FrequencyGrid::covering(&[&gaussian(1.0)]).unwrap();
        for (a, b) in [(1.0, 1.0), (0.2, 3.0), (30.0, 100.0)] {
            let (ga, gb) = (gaussian(a), gaussian(b));
            let ours: f64 = grid
                .k_per_mm()
                .iter()
                .map(|&k| grid.root_weight(k).powi(2) * ga.spectrum(k) * gb.spectrum(k))
                .sum();
            // The part below the grid, (1e-5)²/2 of 1/(a+b) times (a+b), is the largest error; plus 150 roundings.
            let tolerance =
                0.5e-10 * (a + b) * grid.k_half_range_per_mm().1.powi(2) * 1.2 + 150.0 * f64::EPSILON;
            assert!((ours * (a + b) - 1.0).abs() < tolerance, "{a} {b}: {}", ours * (a + b) - 1.0);
        }
    }

    #[test]
    fn dipole_norm_meets_the_closed_form() {
        // Without absorption R(k) = (e^(-a k) + e^(-b k))/2 and ∫ k e^(-c k) dk = 1/c².
        let dipole = Dipole::new(&Medium::new(0.0, 2.0, 1.3).unwrap()).unwrap();
        let (a, b) = (dipole.depth_real_mm(), dipole.height_virtual_mm());
        let exact = 0.25 * ((2.0 * a).powi(-2) + (2.0 * b).powi(-2) + 2.0 * (a + b).powi(-2));
        let grid = FrequencyGrid::covering(&[&dipole]).unwrap();
        let ours = grid.norm(|k| dipole.spectrum(k)).powi(2);
        // Below the grid lies k_low²/2, of the whole about 1e-10.
        assert!((ours / exact - 1.0).abs() < 1e-10, "{}", ours / exact - 1.0);
    }

    #[test]
    fn half_frequency_is_found_over_thirty_decades() {
        for exponent in -15..=15 {
            let variance = 10_f64.powi(2 * exponent);
            let half = half_frequency_per_mm(&gaussian(variance)).unwrap();
            let exact = (2.0 * core::f64::consts::LN_2 / variance).sqrt();
            assert!((half / exact - 1.0).abs() < 0.012, "{half} against {exact}");
        }
    }

    #[test]
    fn profiles_without_total_or_scale_are_refused() {
        struct Flat(f64);
        impl Profile for Flat {
            fn spectrum(&self, _: f64) -> f64 {
                self.0
            }
            fn at_mm(&self, _: f64) -> f64 {
                0.0
            }
        }
        for total in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(FrequencyGrid::covering(&[&Flat(total)]), Err(FitError::Total { .. })));
        }
        assert!(matches!(FrequencyGrid::covering(&[&Flat(1.0)]), Err(FitError::Scale { .. })));
    }
}
