//! Dipole diffusion profile of a half-space, in the radius and in closed form in spatial frequency.
//!
//! Symbols: `z_r` = l depth of the real source, `z_v` = l + 4 A D height of the virtual one, s = sqrt(r² + z²).
//! Source: Jensen, Marschner, Levoy & Hanrahan 2001, doi:10.1145/383259.383319 (not opened), as restated by Mertens et al.
//! 2003, table 1. The spectrum is ours: one pole z (1 + sigma_tr s) e^(-sigma_tr s) / (4 pi s³) is -d/dz of the screened
//! potential e^(-sigma_tr s) / (4 pi s), whose 2-D transform is e^(-|z| q) / (2 q), q = sqrt(k² + sigma_tr²); so the pole
//! transforms to e^(-|z| q) / 2, with no approximation.
//! Not modelled: single scattering, oblique light, anything closer than about one mean free path to the point lit.

use crate::medium::reflection_parameter;
use crate::powers::{Powers, PowersSettings, of_half_space};
use crate::{Boundary, Medium, MediumError, Pole, Profile};

/// Reduced albedo below which the dipole is reported as untrustworthy.
pub const ALBEDO_REDUCED_MIN: f64 = 0.95;

/// The dipole of a half-space seen from air.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dipole {
    albedo_reduced: f64,
    sigma_tr_per_mm: f64,
    depth_real_mm: f64,
    height_virtual_mm: f64,
}

/// How far to trust diffusion theory for a medium.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum DiffusionValidity {
    /// Scattering dominates: the total is within a few percent of transport theory.
    #[error("reduced albedo {albedo_reduced:.4}: diffusion holds beyond {radius_mm:.4} mm")]
    Good {
        /// alpha'.
        albedo_reduced: f64,
        /// One transport mean free path, mm: closer than that the *shape* is still wrong.
        radius_mm: f64,
    },
    /// Too much absorption: the total is too high (for index 1.4 by 10 % at alpha' = 0.9, by 41 % at 0.2).
    #[error(
        "reduced albedo {albedo_reduced:.4} is below {ALBEDO_REDUCED_MIN}: diffusion reflects too much; take beam or monte-carlo instead"
    )]
    AlbedoTooLow {
        /// alpha'.
        albedo_reduced: f64,
    },
}

impl DiffusionValidity {
    /// True where no warning is due.
    pub fn is_good(&self) -> bool {
        matches!(self, Self::Good { .. })
    }
}

impl Dipole {
    /// The dipole of `medium` under air; refuses what [`Medium::validated`] refuses.
    pub fn new(medium: &Medium) -> Result<Self, MediumError> {
        Self::with_boundary(medium, Boundary::smooth(medium.refractive_index))
    }

    /// The dipole of `medium` under something else than air, or under a rough surface.
    pub fn with_boundary(medium: &Medium, boundary: Boundary) -> Result<Self, MediumError> {
        let medium = medium.validated()?;
        let reflection_parameter = reflection_parameter(&medium, boundary)?;
        let l_mm = medium.transport_mean_free_path_mm();
        Ok(Self {
            albedo_reduced: medium.albedo_reduced(),
            sigma_tr_per_mm: medium.sigma_tr_per_mm(),
            depth_real_mm: l_mm,
            height_virtual_mm: l_mm + 4.0 * reflection_parameter * medium.diffusion_coefficient_mm(),
        })
    }

    /// Depth z_r of the real source under the surface, mm (positive).
    pub fn depth_real_mm(&self) -> f64 {
        self.depth_real_mm
    }

    /// Height z_v of the virtual source over the surface, mm (positive).
    pub fn height_virtual_mm(&self) -> f64 {
        self.height_virtual_mm
    }

    /// Effective transport coefficient sigma_tr, 1/mm.
    pub fn sigma_tr_per_mm(&self) -> f64 {
        self.sigma_tr_per_mm
    }

    /// The real and the virtual source.
    pub(crate) fn both(&self) -> [Pole; 2] {
        [self.depth_real_mm, self.height_virtual_mm].map(|depth_mm| Pole {
            power: self.albedo_reduced,
            depth_mm,
            sigma_tr_per_mm: self.sigma_tr_per_mm,
        })
    }

    /// Whether diffusion theory may be trusted here, with the numbers to say why not.
    pub fn validity(&self) -> DiffusionValidity {
        let albedo_reduced = self.albedo_reduced;
        if albedo_reduced < ALBEDO_REDUCED_MIN {
            DiffusionValidity::AlbedoTooLow { albedo_reduced }
        } else {
            DiffusionValidity::Good { albedo_reduced, radius_mm: self.depth_real_mm }
        }
    }
}

impl Profile for Dipole {
    /// R(k) = alpha'/2 (e^(-z_r q) + e^(-z_v q)), q = sqrt(k² + sigma_tr²).
    fn spectrum(&self, k_per_mm: f64) -> f64 {
        let q = k_per_mm.hypot(self.sigma_tr_per_mm);
        let poles = (-self.depth_real_mm * q).exp() + (-self.height_virtual_mm * q).exp();
        0.5 * self.albedo_reduced * poles
    }

    /// R(r) of Jensen et al. 2001: both poles.
    fn at_mm(&self, r_mm: f64) -> f64 {
        self.both().iter().map(|pole| pole.at_mm(r_mm)).sum()
    }

    fn poles(&self) -> Option<Vec<Pole>> {
        Some(self.both().to_vec())
    }

    fn powers(&self) -> Option<Powers> {
        Some(of_half_space(self, &PowersSettings::for_half_space(self)))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::oracle::{hankel, simpson};
    use crate::presets::measured_media::MEASURED_MEDIA;
    use core::f64::consts::PI;

    fn dipole(sigma_a: f64, sigma_s: f64, n: f64) -> Dipole {
        Dipole::new(&Medium::new(sigma_a, sigma_s, n).unwrap()).unwrap()
    }

    #[test]
    fn spectrum_is_the_hankel_transform_of_the_radial_form() {
        for d in [dipole(0.17, 0.88, 1.3), dipole(0.0041, 2.62, 1.5), dipole(1.45, 0.03, 1.3)] {
            for x in [0.0, 0.1, 0.5, 1.0, 2.0, 4.0] {
                let k = x / d.depth_real_mm();
                // e^-40 and (1e-7)² of the integral lie outside; Simpson over 4000 steps of ln r errs by less than
                // 1e-9 while k r turns slowly, and where it turns fast the profile is already e^-10 down.
                let far = 40.0 / d.sigma_tr_per_mm();
                let slow = hankel(k, 1e-7 * d.depth_real_mm(), far, |r| d.at_mm(r));
                let error = (d.spectrum(k) - slow).abs() / d.total();
                assert!(error < 2e-7, "k z_r = {x}: {} against {slow}", d.spectrum(k));
            }
        }
    }

    #[test]
    fn total_is_the_integral_over_the_plane() {
        for (name, channels) in MEASURED_MEDIA {
            for medium in channels.iter().filter(|m| m.sigma_a_per_mm > 0.0) {
                let d = Dipole::new(medium).unwrap();
                let far = (40.0 / d.sigma_tr_per_mm()).ln();
                let ring = |t: f64| 2.0 * PI * d.at_mm(t.exp()) * (2.0 * t).exp();
                let total = simpson((1e-7 * d.depth_real_mm()).ln(), far, 2000, ring);
                assert!((total / d.total() - 1.0).abs() < 1e-8, "{name}: {total} against {}", d.total());
            }
        }
    }

    #[test]
    fn without_absorption_everything_comes_back() {
        // Both exponents are exactly 0 at k = 0: no rounding at all.
        assert_eq!(dipole(0.0, 11.6, 1.3).total(), 1.0);
    }

    #[test]
    fn strong_absorption_returns_little_and_weak_absorption_much() {
        let totals: Vec<f64> = (-6..=3).map(|e| dipole(10_f64.powi(e), 1.0, 1.4).total()).collect();
        assert!(totals.windows(2).all(|w| w[1] < w[0]), "{totals:?}");
        // alpha'/2 (e^-x + e^-(1+4A/3)x), x → sqrt 3 as sigma_a → ∞: below alpha' e^-sqrt3.
        assert!(totals[9] < 1e-3 * 0.177, "{totals:?}");
        // 1 - R_d ≈ (z_r + z_v)/2 sigma_tr = (1 + 2A/3) sqrt(3e-6) = 0.0055.
        assert!((totals[0] - 0.9945).abs() < 1e-4, "{totals:?}");
    }

    #[test]
    fn warns_by_albedo() {
        assert!(dipole(0.0041, 2.62, 1.5).validity().is_good());
        let low = dipole(0.2, 0.32, 1.3).validity();
        assert!(!low.is_good() && low.to_string().contains("0.6154"), "{low}");
    }

    #[test]
    fn another_boundary_only_moves_the_virtual_source() {
        let medium = Medium::new(0.01, 1.0, 1.4).unwrap();
        let matched = Dipole::with_boundary(&medium, Boundary::smooth(1.0)).unwrap();
        let expected = medium.transport_mean_free_path_mm() * (1.0 + 4.0 / 3.0);
        assert!((matched.height_virtual_mm() / expected - 1.0).abs() < 4.0 * f64::EPSILON);
        assert!(Dipole::with_boundary(&medium, Boundary::smooth(7.0)).is_err());
    }
}
