//! A homogeneous scattering medium and the numbers diffusion theory derives from it.
//!
//! Symbols: `sigma_a` absorption, `sigma_s'` = (1 - g) sigma_s reduced scattering, `sigma_t'` their sum, `alpha'` reduced
//! albedo, `D` diffusion coefficient, `sigma_tr` effective transport coefficient, `l` transport mean free path.
//! Source: Jensen, Marschner, Levoy & Hanrahan 2001, doi:10.1145/383259.383319 (not opened), as restated by
//! Mertens et al. 2003, table 1. Reduced coefficients carry no phase function: similarity theory is assumed.

use crate::boundary::{self, Boundary};

/// Largest coefficient taken for real, 1/mm: products of two of them and their inverses stay far from overflow.
pub const COEFFICIENT_MAX_PER_MM: f64 = 1e9;
/// Smallest reduced scattering taken for real, 1/mm (a mean free path of 1000 km): below it nothing diffuses.
pub const SCATTERING_MIN_PER_MM: f64 = 1e-9;
/// Refractive indices, relative to the other side, for which the boundary polynomial stays a reflectance.
pub const REFRACTIVE_INDEX_RANGE: core::ops::RangeInclusive<f64> = 0.5..=3.0;

/// Absorption, reduced scattering and refractive index of one medium at one wavelength or channel.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Medium {
    /// Absorption coefficient sigma_a, 1/mm.
    pub sigma_a_per_mm: f64,
    /// Reduced scattering coefficient sigma_s' = (1 - g) sigma_s, 1/mm.
    pub sigma_s_reduced_per_mm: f64,
    /// Refractive index relative to air.
    pub refractive_index: f64,
}

/// Why a medium is refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MediumError {
    /// NaN or infinite.
    #[error("{quantity} must be finite, got {value}")]
    NotFinite {
        /// The field at fault.
        quantity: &'static str,
        /// Its value.
        value: f64,
    },
    /// Below zero.
    #[error("{quantity} must not be negative, got {value} 1/mm")]
    Negative {
        /// The field at fault.
        quantity: &'static str,
        /// Its value, 1/mm.
        value: f64,
    },
    /// Beyond any material; usually a unit mistaken.
    #[error("{quantity} must not exceed {COEFFICIENT_MAX_PER_MM:e} 1/mm, got {value:e} 1/mm")]
    TooLarge {
        /// The field at fault.
        quantity: &'static str,
        /// Its value, 1/mm.
        value: f64,
    },
    /// A medium that does not scatter has no diffusion profile.
    #[error("sigma_s_reduced_per_mm must be at least {SCATTERING_MIN_PER_MM:e} 1/mm, got {value:e} 1/mm")]
    NoScattering {
        /// Reduced scattering, 1/mm.
        value: f64,
    },
    /// Outside the range of the boundary polynomial.
    #[error("refractive_index must lie in 0.5 to 3, got {value}")]
    RefractiveIndex {
        /// The index given.
        value: f64,
    },
    /// Photon beams, better dipole and single scattering are worked out for tissue under something thinner.
    #[error("refractive_index must be at least 1, got {value}")]
    BelowAir {
        /// The index given.
        value: f64,
    },
    /// A rough surface lets in a share of the light.
    #[error("rho_dt_mean of a rough surface must lie in 0 to 1, got {rho_dt_mean}")]
    RoughBoundary {
        /// The share given.
        rho_dt_mean: f64,
    },
}

impl Medium {
    /// A checked medium: `sigma_a` and `sigma_s'` in 1/mm, refractive index relative to air.
    pub fn new(
        sigma_a_per_mm: f64,
        sigma_s_reduced_per_mm: f64,
        refractive_index: f64,
    ) -> Result<Self, MediumError> {
        Self { sigma_a_per_mm, sigma_s_reduced_per_mm, refractive_index }.validated()
    }

    /// The same medium, if all its numbers can be real.
    pub fn validated(self) -> Result<Self, MediumError> {
        check_coefficient("sigma_a_per_mm", self.sigma_a_per_mm)?;
        check_coefficient("sigma_s_reduced_per_mm", self.sigma_s_reduced_per_mm)?;
        if self.sigma_s_reduced_per_mm < SCATTERING_MIN_PER_MM {
            return Err(MediumError::NoScattering { value: self.sigma_s_reduced_per_mm });
        }
        let value = self.refractive_index;
        if !value.is_finite() {
            return Err(MediumError::NotFinite { quantity: "refractive_index", value });
        }
        if !REFRACTIVE_INDEX_RANGE.contains(&value) {
            return Err(MediumError::RefractiveIndex { value });
        }
        Ok(self)
    }

    /// The same medium in which every length, its free paths first, is `factor` times as long.
    pub fn stretched(&self, factor: f64) -> Self {
        Self {
            sigma_a_per_mm: self.sigma_a_per_mm / factor,
            sigma_s_reduced_per_mm: self.sigma_s_reduced_per_mm / factor,
            ..*self
        }
    }

    /// A mixture with another medium that fills a share of the volume, 0 to 1: particles of both are met as often as they fill
    /// it, and the index of refraction goes with them.
    pub fn mixed(&self, other: &Self, share: f64) -> Self {
        let mean = |a: f64, b: f64| a * (1.0 - share) + b * share;
        Self {
            sigma_a_per_mm: mean(self.sigma_a_per_mm, other.sigma_a_per_mm),
            sigma_s_reduced_per_mm: mean(self.sigma_s_reduced_per_mm, other.sigma_s_reduced_per_mm),
            refractive_index: mean(self.refractive_index, other.refractive_index),
        }
    }

    /// Reduced extinction sigma_t' = sigma_a + sigma_s', 1/mm.
    pub fn sigma_t_reduced_per_mm(&self) -> f64 {
        self.sigma_a_per_mm + self.sigma_s_reduced_per_mm
    }

    /// Reduced albedo alpha' = sigma_s' / sigma_t', between 0 and 1.
    pub fn albedo_reduced(&self) -> f64 {
        self.sigma_s_reduced_per_mm / self.sigma_t_reduced_per_mm()
    }

    /// Diffusion coefficient D = 1 / (3 sigma_t'), mm.
    pub fn diffusion_coefficient_mm(&self) -> f64 {
        1.0 / (3.0 * self.sigma_t_reduced_per_mm())
    }

    /// Effective transport coefficient sigma_tr = sqrt(3 sigma_a sigma_t'), 1/mm: far from the light, fluence falls as
    /// exp(-sigma_tr r).
    pub fn sigma_tr_per_mm(&self) -> f64 {
        (3.0 * self.sigma_a_per_mm * self.sigma_t_reduced_per_mm()).sqrt()
    }

    /// Transport mean free path l = 1 / sigma_t', mm.
    pub fn transport_mean_free_path_mm(&self) -> f64 {
        self.sigma_t_reduced_per_mm().recip()
    }

    /// Diffuse mean free path 1 / sigma_tr, mm; infinite without absorption.
    pub fn diffuse_mean_free_path_mm(&self) -> f64 {
        self.sigma_tr_per_mm().recip()
    }

    /// Boundary factor A against air (see [`boundary::reflection_parameter`]).
    pub fn boundary_to_air(&self) -> f64 {
        boundary::reflection_parameter(self.refractive_index)
    }
}

/// Boundary factor A of a face of `medium`, if the boundary can be real.
pub(crate) fn reflection_parameter(medium: &Medium, boundary: Boundary) -> Result<f64, MediumError> {
    Medium { refractive_index: boundary.eta_inside_over_outside(), ..*medium }.validated()?;
    if let Boundary::Rough { rho_dt_mean, .. } = boundary
        && !(rho_dt_mean > 0.0 && rho_dt_mean <= 1.0)
    {
        return Err(MediumError::RoughBoundary { rho_dt_mean });
    }
    Ok(boundary.reflection_parameter())
}

fn check_coefficient(quantity: &'static str, value: f64) -> Result<(), MediumError> {
    if !value.is_finite() {
        return Err(MediumError::NotFinite { quantity, value });
    }
    if value < 0.0 {
        return Err(MediumError::Negative { quantity, value });
    }
    if value > COEFFICIENT_MAX_PER_MM {
        return Err(MediumError::TooLarge { quantity, value });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn marble_green_by_hand() {
        // 0.0041 + 2.62 = 2.6241; the rest by pocket calculator, six figures each, hence 1e-6.
        let m = Medium::new(0.0041, 2.62, 1.5).unwrap();
        for (ours, by_hand) in [
            (m.sigma_t_reduced_per_mm(), 2.6241),
            (m.albedo_reduced(), 0.998_437_6),
            (m.diffusion_coefficient_mm(), 0.127_027_7),
            (m.sigma_tr_per_mm(), 0.179_656_4),
            (m.transport_mean_free_path_mm(), 0.381_083_0),
            (m.diffuse_mean_free_path_mm(), 5.566_180),
        ] {
            assert!((ours / by_hand - 1.0).abs() < 1e-6, "{ours} against {by_hand}");
        }
    }

    #[test]
    fn no_absorption_means_albedo_one_and_no_decay() {
        let m = Medium::new(0.0, 11.6, 1.3).unwrap();
        assert_eq!((m.albedo_reduced(), m.sigma_tr_per_mm()), (1.0, 0.0));
        assert!(m.diffuse_mean_free_path_mm().is_infinite());
    }

    #[test]
    fn impossible_media_are_refused_by_name() {
        let told = |a, s, n| Medium::new(a, s, n).unwrap_err().to_string();
        assert!(told(f64::NAN, 1.0, 1.3).contains("sigma_a_per_mm must be finite"));
        assert!(told(0.1, f64::INFINITY, 1.3).contains("sigma_s_reduced_per_mm must be finite"));
        assert!(told(-0.1, 1.0, 1.3).contains("not be negative, got -0.1"));
        assert!(told(0.1, 0.0, 1.3).contains("at least 1e-9"));
        assert!(told(2e9, 1.0, 1.3).contains("must not exceed 1e9"));
        assert!(told(0.1, 1.0, 0.0).contains("0.5 to 3"));
        assert!(told(0.1, 1.0, f64::NAN).contains("refractive_index must be finite"));
    }

    proptest! {
        #[test]
        fn derived_numbers_are_finite_over_the_whole_range(
            ln_a in -40.0..20.7_f64, ln_s in -20.7..20.7_f64, n in 0.5..3.0_f64,
        ) {
            let m = Medium::new(ln_a.exp(), ln_s.exp(), n).unwrap();
            prop_assert!(m.albedo_reduced() > 0.0 && m.albedo_reduced() <= 1.0);
            prop_assert!(m.sigma_tr_per_mm().is_finite() && m.boundary_to_air() > 0.0);
            // Definition of the diffusion length: D sigma_tr² = sigma_a. Four roundings on each side.
            let back = m.diffusion_coefficient_mm() * m.sigma_tr_per_mm().powi(2);
            prop_assert!((back / m.sigma_a_per_mm - 1.0).abs() < 8.0 * f64::EPSILON);
        }
    }
}
