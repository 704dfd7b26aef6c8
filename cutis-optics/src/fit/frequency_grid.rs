//! Quadrature of ∫ k f(k) dk for profiles and Gaussians together.
//!
//! With ln k = t the integral is ∫ k² f dt over the whole line, and the trapezoid rule converges exponentially: for
//! e^(-v k²), analytic and decaying for |Im t| < pi/4, the error falls as e^(-pi²/(2h)); for the poles' e^(-z k) it is the square of
//! that. One logarithmic grid so serves narrow and wide terms alike. Towards k = 0 there is nothing to resolve any more but a
//! long way to go; with ln k = t - e^(-t) (t from where that begins) a dozen nodes go all of it.

use super::FitError;
use crate::{GaussianSum, Profile};
use wide::f64x4;

/// Step in t. Of ∫ k e^(-k²) dk the rule misses 2 |Gamma(1 + i pi/h)| = 1e-16, so that errors of 1e-6 are still errors.
const STEP: f64 = 0.12;
/// Where the leap to k = 0 begins, of the frequency where the first profile has fallen to half. Gaussians wide enough to
/// change below are a thousand times as wide as the profile.
const LOW: f64 = 1e-2;
/// First t of the leap: k is then e^-9 of where it began, and the part left out weighs the square of 1e-6.
const LEAP: f64 = -2.0;
/// The upper end: where k R(k) has fallen to this part of its size at half height, …
const NEGLIGIBLE: f64 = 1e-11;
/// … and this factor more, so that Gaussians narrower than the profile's own detail are seen and punished.
const HEADROOM: f64 = 2.0;
/// Exponent below which a Gaussian counts as 0: e^-60 of the 1 it begins with lies ten decades below rounding.
const EXPONENT_LEAST: f64 = -60.0;
/// Octaves searched up and down from 1/mm for the scale of a profile: 1e-18 to 1e18 per mm.
const SCALE_OCTAVES: i32 = 60;

/// Nodes in k and what each one counts.
pub(super) struct FrequencyGrid {
    k_per_mm: Vec<f64>,
    /// -k²/2: what a variance is multiplied by in the exponent of its Gaussian.
    exponents_per_mm2: Vec<f64>,
    /// Square root of k² d(ln k)/dt times the step.
    root_weights: Vec<f64>,
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
        let begin_per_mm = LOW * range.0;
        let last = (high / begin_per_mm).ln() + 1.0;
        let count = ((last - LEAP) / STEP).ceil() as usize;
        let t = |i: usize| LEAP + STEP * i as f64;
        let k_per_mm: Vec<f64> = (0..=count).map(|i| begin_per_mm * (t(i) - (-t(i)).exp()).exp()).collect();
        let root = |(i, k): (usize, &f64)| k * (STEP * (1.0 + (-t(i)).exp())).sqrt();
        let root_weights = k_per_mm.iter().enumerate().map(root).collect();
        let exponents_per_mm2 = k_per_mm.iter().map(|k| -0.5 * k * k).collect();
        Ok(Self { k_per_mm, exponents_per_mm2, root_weights, k_half_range_per_mm: range })
    }

    /// Every n-th node: the rule then misses 2 |Gamma(1 + i pi/(n h))| of ∫ k e^(-k²) dk, 2e-8 for two and 1e-3 for four.
    pub(super) fn every(&self, n: usize) -> Self {
        let chosen = |values: &[f64], scale: f64| values.iter().step_by(n).map(|v| v * scale).collect();
        Self {
            k_per_mm: chosen(&self.k_per_mm, 1.0),
            exponents_per_mm2: chosen(&self.exponents_per_mm2, 1.0),
            root_weights: chosen(&self.root_weights, (n as f64).sqrt()),
            k_half_range_per_mm: self.k_half_range_per_mm,
        }
    }

    /// Frequencies, growing, 1/mm.
    pub(super) fn k_per_mm(&self) -> &[f64] {
        &self.k_per_mm
    }

    /// -k²/2 for each frequency, 1/mm².
    pub(super) fn exponents_per_mm2(&self) -> &[f64] {
        &self.exponents_per_mm2
    }

    /// Number of nodes.
    pub(super) fn len(&self) -> usize {
        self.k_per_mm.len()
    }

    /// Lowest and highest frequency at which a profile has fallen to half: the scale for starting values.
    pub(super) fn k_half_range_per_mm(&self) -> (f64, f64) {
        self.k_half_range_per_mm
    }

    /// A Gaussian of weight 1 at the nodes, times the square root of the quadrature weight; 0 where it is below rounding.
    pub(super) fn fill_gaussian(&self, variance_mm2: f64, values: &mut [f64]) {
        const LANES: usize = 4;
        let seen = self.exponents_per_mm2.partition_point(|e| variance_mm2 * e > EXPONENT_LEAST);
        let whole = seen.next_multiple_of(LANES).min(self.len() - self.len() % LANES);
        let (lanes, rest) = values.split_at_mut(whole);
        let nodes = self.exponents_per_mm2.chunks_exact(LANES).zip(self.root_weights.chunks_exact(LANES));
        for (place, (e, weight)) in lanes.chunks_exact_mut(LANES).zip(nodes) {
            let of = |four: &[f64]| f64x4::new([four[0], four[1], four[2], four[3]]);
            let four = of(weight) * (f64x4::splat(variance_mm2) * of(e)).exp();
            place.copy_from_slice(&four.to_array());
        }
        let nodes = self.exponents_per_mm2[whole..].iter().zip(&self.root_weights[whole..]);
        for (place, (e, weight)) in rest.iter_mut().zip(nodes) {
            let exponent = variance_mm2 * e;
            *place = if exponent > EXPONENT_LEAST { weight * exponent.exp() } else { 0.0 };
        }
    }

    /// Square roots of the quadrature weights, so that sums of squares are the integral; one for each frequency.
    pub(super) fn root_weights(&self) -> &[f64] {
        &self.root_weights
    }

    /// Smallest and largest variance that the nodes can tell from a spike or a constant, mm².
    pub(super) fn variance_range_mm2(&self) -> (f64, f64) {
        let (half, high) = (self.k_half_range_per_mm.0, self.k_per_mm[self.len() - 1]);
        // Narrow: e^-20 at the last node. Wide: e^-5 where the leap begins.
        (40.0 / (high * high), 10.0 / (LOW * LOW * half * half))
    }

    /// sqrt(∫ k f² dk).
    pub(super) fn norm(&self, f: impl Fn(f64) -> f64) -> f64 {
        let nodes = self.k_per_mm.iter().zip(&self.root_weights);
        nodes.map(|(&k, weight)| (weight * f(k)).powi(2)).sum::<f64>().sqrt()
    }

    /// Relative RMS power error of a sum against a profile (d'Eon et al. 2007, eq. 10, by Parseval).
    pub(super) fn relative_error(&self, profile: &dyn Profile, sum: &GaussianSum) -> f64 {
        self.norm(|k| profile.spectrum(k) - sum.spectrum(k)) / self.norm(|k| profile.spectrum(k))
    }
}

/// Where the spectrum has fallen to half of the total, by bisection, of octaves first.
fn half_frequency_per_mm(profile: &dyn Profile) -> Result<f64, FitError> {
    let total = profile.total();
    if !(total.is_finite() && total > 0.0) {
        return Err(FitError::Total { total });
    }
    let above = |k: f64| profile.spectrum(k) > 0.5 * total;
    let (mut down, mut up) = (-SCALE_OCTAVES, SCALE_OCTAVES);
    if !above(2_f64.powi(down)) || above(2_f64.powi(up)) || !profile.spectrum(2_f64.powi(up)).is_finite() {
        return Err(FitError::Scale { total });
    }
    while up - down > 1 {
        let middle = (up + down) / 2;
        *(if above(2_f64.powi(middle)) { &mut down } else { &mut up }) = middle;
    }
    let (mut low, mut high) = (2_f64.powi(down), 2_f64.powi(up));
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
    let candidates = (0..35).map(|i| half_per_mm * (0.4 * f64::from(i)).exp());
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
            let nodes = grid.k_per_mm().iter().zip(grid.root_weights());
            let ours: f64 = nodes.map(|(&k, w)| w * w * ga.spectrum(k) * gb.spectrum(k)).sum();
            // The trapezoid rule's own, and what lies below the grid: (1e-2 e^-9)²/2 k_half² (a + b).
            let tolerance = 4e-13 + 1e-12 * (a + b);
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
        // Below the grid lies k_low²/2, of the whole about 1e-12; the rest is the trapezoid rule's.
        assert!((ours / exact - 1.0).abs() < 2e-12, "{}", ours / exact - 1.0);
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
