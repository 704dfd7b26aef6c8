//! Normalised diffusion: two exponentials over r, the profile that real-time engines draw.
//!
//! Symbols: `A` total (surface albedo), `d` = l/s shape length, l a mean free path of which there are three readings with a
//! scaling s(A) each; R(r) = A (e^(-r/d) + e^(-r/3d)) / (8 pi d r).
//! Source: Christensen & Burley 2015, "Approximate reflectance profiles for efficient subsurface scattering" (not opened;
//! the profile and the three scalings as public renderers restate them, from the project's notes).
//! The spectrum is ours: e^(-a r)/r transforms to 2 pi / sqrt(a² + k²), so
//! R(k) = A/4 [1/sqrt(1 + (k d)²) + 3/sqrt(1 + (3 k d)²)].
//! It falls as 1/k, the profile rises as 1/r: the plain power ∫ r R² dr is infinite, and only a beam of some width measures
//! it (see [`crate::translate::loss`]).

use crate::Profile;
use core::f64::consts::PI;

/// Burley's normalised diffusion profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Burley {
    albedo: f64,
    shape_length_mm: f64,
}

/// Which length the scaling s(A) turns into the shape length, d = l / s(A).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BurleyScaling {
    /// l is the transport mean free path; light falls in along the normal.
    Searchlight,
    /// l is the transport mean free path; light falls in diffusely.
    DiffuseTransmission,
    /// l is the *diffuse* mean free path 1/sigma_tr; light falls in along the normal.
    DiffuseMeanFreePath,
}

/// Why there is no such profile.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum BurleyError {
    /// Not a share of the light.
    #[error("the albedo of a Burley profile must lie above 0 and not above 1, got {value}")]
    Albedo {
        /// What was given.
        value: f64,
    },
    /// Not a length.
    #[error("the shape length of a Burley profile must be finite and above 0 mm, got {value}")]
    Length {
        /// What was given, mm.
        value: f64,
    },
}

impl BurleyScaling {
    /// s(A), no unit.
    pub fn factor(self, albedo: f64) -> f64 {
        match self {
            Self::Searchlight => 1.85 - albedo + 7.0 * (albedo - 0.8).abs().powi(3),
            Self::DiffuseTransmission => 1.9 - albedo + 3.5 * (albedo - 0.8).powi(2),
            Self::DiffuseMeanFreePath => 3.5 + 100.0 * (albedo - 0.33).powi(4),
        }
    }
}

impl Burley {
    /// The profile of total `albedo` and shape length d.
    pub fn new(albedo: f64, shape_length_mm: f64) -> Result<Self, BurleyError> {
        if !(albedo > 0.0 && albedo <= 1.0) {
            return Err(BurleyError::Albedo { value: albedo });
        }
        if !(shape_length_mm > 0.0 && shape_length_mm.is_finite()) {
            return Err(BurleyError::Length { value: shape_length_mm });
        }
        Ok(Self { albedo, shape_length_mm })
    }

    /// The profile that an engine draws for `albedo` and a mean free path read in the sense of `scaling`.
    pub fn from_mean_free_path(albedo: f64, l_mm: f64, scaling: BurleyScaling) -> Result<Self, BurleyError> {
        Self::new(albedo, l_mm / scaling.factor(albedo))
    }

    /// d, mm.
    pub fn shape_length_mm(&self) -> f64 {
        self.shape_length_mm
    }
}

impl Profile for Burley {
    fn spectrum(&self, k_per_mm: f64) -> f64 {
        let x = k_per_mm * self.shape_length_mm;
        0.25 * self.albedo * (1.0_f64.hypot(x).recip() + 3.0 * 1.0_f64.hypot(3.0 * x).recip())
    }

    /// Infinite at r = 0.
    fn at_mm(&self, r_mm: f64) -> f64 {
        let d = self.shape_length_mm;
        let x = r_mm / d;
        self.albedo * ((-x).exp() + (-x / 3.0).exp()) / (8.0 * PI * d * r_mm)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::oracle::{hankel, simpson};

    #[test]
    fn spectrum_is_the_hankel_transform_of_the_radial_form() {
        let burley = Burley::new(0.6, 0.7).unwrap();
        for x in [0.0, 0.3, 1.0, 3.0] {
            let k = x / 0.7;
            // r² R ~ r near 0: the disc left out weighs 1e-8; e^(-120/3) lies outside. Simpson over 4000 steps of ln r
            // errs below 1e-8 where k r still turns slowly; where it turns fast the profile is e^-10 down.
            let slow = hankel(k, 1e-8 * 0.7, 120.0 * 0.7, |r| burley.at_mm(r));
            assert!((burley.spectrum(k) - slow).abs() < 1e-6, "{k}: {} against {slow}", burley.spectrum(k));
        }
    }

    #[test]
    fn total_is_the_albedo_in_frequency_and_over_the_plane() {
        for (albedo, d) in [(1.0, 0.01), (0.3, 2.0)] {
            let burley = Burley::new(albedo, d).unwrap();
            assert!((burley.total() - albedo).abs() < 2.0 * f64::EPSILON);
            let ring = |t: f64| 2.0 * PI * burley.at_mm(t.exp()) * (2.0 * t).exp();
            let over_plane = simpson((1e-9 * d).ln(), (120.0 * d).ln(), 4000, ring);
            // The disc inside 1e-9 d holds 5e-10.
            assert!((over_plane / albedo - 1.0).abs() < 1e-8, "{over_plane}");
        }
    }

    #[test]
    fn near_the_centre_it_is_one_over_r_and_far_out_one_exponential() {
        let burley = Burley::new(0.5, 1.0).unwrap();
        // r R → A/(4 pi d), with slope -(1 + 1/3)/2.
        assert!((1e-6 * burley.at_mm(1e-6) * 4.0 * PI / 0.5 - 1.0).abs() < 1e-6);
        let ratio = 61.0 * burley.at_mm(61.0) / (60.0 * burley.at_mm(60.0));
        // The short exponential is e^-40 down.
        assert!((ratio / (-1.0_f64 / 3.0).exp() - 1.0).abs() < 1e-13);
        // k R → A/4 (1/d + 1/d).
        assert!((1e7 * burley.spectrum(1e7) / 0.25 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn scalings_by_hand() {
        // At A = 0.8 and A = 0.33 all powers vanish; at A = 0.5: 0.3³ · 7 = 0.189, 0.3² · 3.5 = 0.315, 0.17⁴ · 100 = 0.083521.
        for (scaling, albedo, by_hand) in [
            (BurleyScaling::Searchlight, 0.8, 1.05),
            (BurleyScaling::Searchlight, 0.5, 1.539),
            (BurleyScaling::DiffuseTransmission, 0.8, 1.1),
            (BurleyScaling::DiffuseTransmission, 0.5, 1.715),
            (BurleyScaling::DiffuseMeanFreePath, 0.33, 3.5),
            (BurleyScaling::DiffuseMeanFreePath, 0.5, 3.583_521),
        ] {
            assert!((scaling.factor(albedo) - by_hand).abs() < 1e-12, "{scaling:?} {albedo}");
        }
        let drawn = Burley::from_mean_free_path(0.5, 2.0, BurleyScaling::Searchlight).unwrap();
        assert!((drawn.shape_length_mm() - 2.0 / 1.539).abs() < 1e-12);
    }

    #[test]
    fn impossible_profiles_are_refused() {
        for albedo in [0.0, -0.1, 1.1, f64::NAN] {
            assert!(matches!(Burley::new(albedo, 1.0), Err(BurleyError::Albedo { .. })), "{albedo}");
        }
        for length in [0.0, -1.0, f64::INFINITY, f64::NAN] {
            assert!(matches!(Burley::new(0.5, length), Err(BurleyError::Length { .. })), "{length}");
        }
    }
}
