//! A profile as seen under a beam of some width, instead of a point.
//!
//! Symbols: b standard deviation of the beam along one axis; its spectrum is e^(-b² k²/2).
//! Light scattered once goes as 1/r towards a point that is lit; its power ∫ r R² dr is infinite, and an error relative to it
//! means nothing. Under a beam as narrow as one likes, it does.

use crate::Profile;
use crate::hankel::inverse_hankel;

/// Where the spectrum ends: e^-32 = 1e-14.
const FARTHEST_EXPONENT: f64 = 32.0;

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
        let far_per_mm = (2.0 * FARTHEST_EXPONENT).sqrt() / self.deviation_mm;
        inverse_hankel(r_mm, far_per_mm, |k| self.spectrum(k))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::{Gaussian, GaussianSum, Medium, SingleScattering};

    #[test]
    fn a_gaussian_gets_wider_by_the_beam() {
        let narrow = GaussianSum::new(vec![Gaussian { weight: 0.7, variance_mm2: 0.3 }]);
        let wide = GaussianSum::new(vec![Gaussian { weight: 0.7, variance_mm2: 0.3 + 0.04 }]);
        let seen = WideBeam::new(narrow, 0.2);
        for x in [0.0, 0.4, 1.5] {
            assert!((seen.spectrum(x) - wide.spectrum(x)).abs() < 1e-15);
            // Simpson's rule over 4096 steps.
            assert!((seen.at_mm(x) - wide.at_mm(x)).abs() < 1e-9, "{x}");
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
