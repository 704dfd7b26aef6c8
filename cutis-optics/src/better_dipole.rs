//! The better dipole of a half-space: Grosjean's diffusion, one source, exitance from fluence and flux.
//!
//! Symbols: as in the module `grosjean`; z_r = l depth of the source.
//! Source: d'Eon 2012, "A Better Dipole" (not opened; the formula is the one public implementations use).
//! Closed in spatial frequency: R(k) = alpha'² e^(-q l) [C_phi (1 - e^(-2 q z_b)) / (2 D_G q) + C_E (1 + e^(-2 q z_b)) / 2],
//! because the fluence of a point source, e^(-sigma_tr s)/(4 pi D_G s), transforms to e^(-q |z|)/(2 D_G q).
//! Light scattered once is not in it: add [`crate::SingleScattering`].

use crate::grosjean::Grosjean;
use crate::{Medium, MediumError, Profile};

/// Light scattered more than once, from one source.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BetterDipole {
    grosjean: Grosjean,
}

impl BetterDipole {
    /// The better dipole of `medium` under air.
    ///
    /// # Errors
    /// If the medium cannot be, or its refractive index is below 1.
    pub fn new(medium: &Medium) -> Result<Self, MediumError> {
        Ok(Self { grosjean: Grosjean::new(medium)? })
    }

    fn depth_mm(&self) -> f64 {
        self.grosjean.sigma_t_reduced_per_mm.recip()
    }
}

impl Profile for BetterDipole {
    fn spectrum(&self, k_per_mm: f64) -> f64 {
        let q = self.grosjean.q_per_mm(k_per_mm);
        let power = self.grosjean.albedo_reduced.powi(2);
        power * (-q * self.depth_mm()).exp() * self.grosjean.exitance_over_decay(q)
    }

    fn at_mm(&self, r_mm: f64) -> f64 {
        self.grosjean.albedo_reduced.powi(2) * self.grosjean.exitance_per_mm2(self.depth_mm(), r_mm)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::oracle::hankel;

    #[test]
    fn spectrum_is_the_hankel_transform_of_the_radial_form() {
        for (sigma_a, sigma_s, n) in [(0.17, 0.88, 1.3), (0.1, 0.9, 1.0), (0.8, 0.2, 1.4), (0.01, 1.0, 1.5)] {
            let d = BetterDipole::new(&Medium::new(sigma_a, sigma_s, n).unwrap()).unwrap();
            for x in [0.0, 0.3, 1.0, 3.0] {
                let k = x / d.depth_mm();
                let far = 60.0 / d.grosjean.sigma_tr_per_mm;
                let slow = hankel(k, 1e-7 * d.depth_mm(), far, |r| d.at_mm(r));
                // Simpson's error in the slow transform, as for the dipole.
                assert!((d.spectrum(k) - slow).abs() < 2e-7, "{k}: {} against {slow}", d.spectrum(k));
            }
        }
    }

    #[test]
    fn without_absorption_everything_that_was_scattered_twice_comes_back() {
        // 2 C1 and 3 C2 cancel: C_phi 2 z_b/(2 D) + C_E = (1 - 2 C1) A / 2 + (1 - 3 C2)/2 = 1.
        for n in [1.0, 1.3, 1.5] {
            let d = BetterDipole::new(&Medium::new(0.0, 3.0, n).unwrap()).unwrap();
            assert!((d.total() - 1.0).abs() < 1e-14, "{}", d.total());
        }
    }

    #[test]
    fn an_index_below_air_is_refused() {
        let error = BetterDipole::new(&Medium::new(0.1, 1.0, 0.9).unwrap()).unwrap_err();
        assert!(error.to_string().contains("must be at least 1, got 0.9"), "{error}");
    }
}
