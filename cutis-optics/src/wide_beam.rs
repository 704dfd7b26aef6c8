//! A profile as seen under a beam of some width, instead of a point.
//!
//! Symbols: b standard deviation of the beam along one axis; its spectrum is e^(-b² k²/2).
//! Light scattered once goes as 1/r towards a point that is lit; its power ∫ r R² dr is infinite, and an error relative to it
//! means nothing. Under a beam as narrow as one likes, it does.

//! In the radius, light that fell at distance s reaches r with density s/b² e^(-(r - s)²/2b²) I0e(r s/b²), where
//! I0e(x) = e^(-x) I0(x) is the modified Bessel function: one integral over a few b.

use crate::Profile;
use crate::boundary::unit_nodes;

/// Deviations of the beam beyond which there is nothing of it: e^-24 = 4e-11.
const REACH: f64 = 7.0;

/// A profile lit by a Gaussian beam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WideBeam<P> {
    profile: P,
    deviation_mm: f64,
}

impl<P: Profile> WideBeam<P> {
    /// `profile` under a beam of standard deviation `deviation_mm`.
    ///
    /// # Panics
    /// If the deviation is not above 0 and finite.
    pub fn new(profile: P, deviation_mm: f64) -> Self {
        assert!(deviation_mm > 0.0 && deviation_mm.is_finite(), "a beam has a width, got {deviation_mm} mm");
        Self { profile, deviation_mm }
    }
}

impl<P: Profile> Profile for WideBeam<P> {
    fn spectrum(&self, k_per_mm: f64) -> f64 {
        let x = k_per_mm * self.deviation_mm;
        self.profile.spectrum(k_per_mm) * (-0.5 * x * x).exp()
    }

    fn at_mm(&self, r_mm: f64) -> f64 {
        let b = self.deviation_mm;
        let from = (r_mm - REACH * b).max(0.0);
        let width = r_mm + REACH * b - from;
        let density = |s_mm: f64| {
            let apart = (r_mm - s_mm) / b;
            s_mm / (b * b) * (-0.5 * apart * apart).exp() * bessel_i0e(r_mm * s_mm / (b * b))
        };
        let part = |(unit, weight): (f64, f64)| {
            let s_mm = from + unit * width;
            weight * density(s_mm) * self.profile.at_mm(s_mm)
        };
        width * unit_nodes().map(part).sum::<f64>()
    }
}

/// e^(-x) I0(x) for x ≥ 0, to 2e-7 (Abramowitz & Stegun 9.8.1 and 9.8.2; the coefficients were checked against the integral).
fn bessel_i0e(x: f64) -> f64 {
    const NEAR: [f64; 7] =
        [1.0, 3.515_622_9, 3.089_942_4, 1.206_749_2, 0.265_973_2, 0.036_076_8, 0.004_581_3];
    const FAR: [f64; 9] = [
        0.398_942_28,
        0.013_285_92,
        0.002_253_19,
        -0.001_575_65,
        0.009_162_81,
        -0.020_577_06,
        0.026_355_37,
        -0.016_476_33,
        0.003_923_77,
    ];
    let polynomial = |coefficients: &[f64], t: f64| coefficients.iter().rev().fold(0.0, |sum, c| sum * t + c);
    let t = x / 3.75;
    if t < 1.0 { (-x).exp() * polynomial(&NEAR, t * t) } else { polynomial(&FAR, t.recip()) / x.sqrt() }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::hankel::inverse_hankel;
    use crate::oracle::simpson;
    use crate::{Gaussian, GaussianSum, Medium, SingleScattering};

    #[test]
    fn a_gaussian_gets_wider_by_the_beam() {
        let narrow = GaussianSum::new(vec![Gaussian { weight: 0.7, variance_mm2: 0.3 }]);
        let wide = GaussianSum::new(vec![Gaussian { weight: 0.7, variance_mm2: 0.3 + 0.04 }]);
        let seen = WideBeam::new(narrow, 0.2);
        for x in [0.0, 0.4, 1.5] {
            assert!((seen.spectrum(x) - wide.spectrum(x)).abs() < 1e-15);
            // The Bessel function's 2e-7.
            assert!((seen.at_mm(x) / wide.at_mm(x) - 1.0).abs() < 1e-6, "{x}");
        }
    }

    #[test]
    fn the_bessel_function_meets_its_integral() {
        // (1/pi) ∫ e^(x (cos t - 1)) dt over [0, pi].
        for x in [0.0, 0.5, 2.0, 3.7, 3.8, 10.0, 300.0] {
            let slow = simpson(0.0, core::f64::consts::PI, 2000, |t| (x * (t.cos() - 1.0)).exp());
            let slow = slow / core::f64::consts::PI;
            assert!((bessel_i0e(x) / slow - 1.0).abs() < 6e-7, "{x}: {} {slow}", bessel_i0e(x));
        }
    }

    #[test]
    fn radius_and_spectrum_are_of_one_profile() {
        // Light scattered once, which is infinite at the beam: back from the smoothed spectrum.
        let single = SingleScattering::new(&Medium::new(0.1, 0.9, 1.4).unwrap()).unwrap();
        let seen = WideBeam::new(single, 0.05);
        for r in [0.0, 0.03, 0.1, 0.5] {
            let slow = inverse_hankel(r, |k| seen.spectrum(k));
            // 48 nodes over a peak that is not smooth at the middle.
            assert!((seen.at_mm(r) / slow - 1.0).abs() < 1e-3, "{r}: {} {slow}", seen.at_mm(r));
        }
    }

    #[test]
    fn what_was_infinite_is_finite_and_far_away_nothing_changes() {
        let single = SingleScattering::new(&Medium::new(0.1, 0.9, 1.4).unwrap()).unwrap();
        let seen = WideBeam::new(single, 0.05);
        assert!(seen.at_mm(0.0).is_finite() && seen.at_mm(0.0) > seen.at_mm(0.05));
        // The beam adds b²/2 times the Laplacian, which for e^(-2 r)/r at r = 1 is about 10 R, and the next order.
        let off = seen.at_mm(1.0) / single.at_mm(1.0) - 1.0;
        assert!(off > 0.0 && off < 0.5 * 0.05 * 0.05 * 15.0, "{off}");
    }
}
