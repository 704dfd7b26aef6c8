//! Light that was scattered exactly once in a half-space under a normal beam: no approximation.
//!
//! Symbols: `sigma_t'` reduced extinction (isotropic scattering by similarity theory), alpha' reduced albedo, mu cosine
//! inside the medium of the way to the surface, T its Fresnel transmittance, eta index of the medium.
//! Source: the idea is that of Habel, Christensen & Jarosz 2013, section 5 (not opened); the forms are ours.
//!
//! A point at depth z scatters alpha' sigma_t' e^(-sigma_t' z) of the beam evenly, and what leaves at distance r went a way
//! d = z/mu with r = d sqrt(1 - mu²). With s the sine of the angle to the normal,
//! R(r) = alpha' sigma_t' / (4 pi r) ∫ e^(-sigma_t' r (1 + mu)/s) T ds over s from 0 to 1/eta,
//! and since ∫ e^(-a z) J0(b z) dz = 1/sqrt(a² + b²),
//! R(k) = alpha' sigma_t' / 2 ∫ mu T dmu / sqrt(sigma_t'² (1 + mu)² + k² (1 - mu²)).
//! Both run over the cosine outside, where T has no singularity. R(r) goes as 1/r towards the beam and R(k) as 1/k: the
//! power of the profile, ∫ r R² dr, is infinite, so fits and errors need a beam of some width ([`crate::WideBeam`]).

use crate::boundary::{cos_inside, integral_over_unit};
use crate::simulate::fresnel_reflectance;
use crate::{Medium, MediumError, Profile};
use core::f64::consts::PI;

/// Light scattered once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SingleScattering {
    albedo_reduced: f64,
    sigma_t_reduced_per_mm: f64,
    eta: f64,
}

impl SingleScattering {
    /// Single scattering of `medium` under air.
    ///
    /// # Errors
    /// If the medium cannot be, or its refractive index is below 1.
    pub fn new(medium: &Medium) -> Result<Self, MediumError> {
        let medium = medium.validated()?;
        if medium.refractive_index < 1.0 {
            return Err(MediumError::BelowAir { value: medium.refractive_index });
        }
        Ok(Self {
            albedo_reduced: medium.albedo_reduced(),
            sigma_t_reduced_per_mm: medium.sigma_t_reduced_per_mm(),
            eta: medium.refractive_index,
        })
    }

    /// Transmittance to a cosine outside, and the cosine inside.
    fn way_out(&self, cos_outside: f64) -> (f64, f64) {
        (1.0 - fresnel_reflectance(1.0, self.eta, cos_outside).0, cos_inside(self.eta, cos_outside))
    }
}

impl Profile for SingleScattering {
    fn spectrum(&self, k_per_mm: f64) -> f64 {
        let sigma_t = self.sigma_t_reduced_per_mm;
        // mu dmu = mu_o dmu_o / eta².
        let integral = integral_over_unit(|outside| {
            let (transmittance, mu) = self.way_out(outside);
            let root = (sigma_t * (1.0 + mu)).hypot(k_per_mm * (1.0 - mu * mu).sqrt());
            transmittance * outside / root
        });
        0.5 * self.albedo_reduced * sigma_t * integral / (self.eta * self.eta)
    }

    /// Infinite at r = 0.
    fn at_mm(&self, r_mm: f64) -> f64 {
        let sigma_t = self.sigma_t_reduced_per_mm;
        // s = s_o/eta, ds = mu_o dmu_o / (eta s_o); with mu_o = 1 - t² the sine outside is t sqrt(2 - t²), so that
        // ds = 2 mu_o dt / (eta sqrt(2 - t²)) has no pole.
        let integral = integral_over_unit(|t| {
            let outside = 1.0 - t * t;
            let (transmittance, mu) = self.way_out(outside);
            let root = (2.0 - t * t).sqrt();
            let sine = t * root / self.eta;
            let decay = (-sigma_t * r_mm * (1.0 + mu) / sine).exp();
            transmittance * decay * 2.0 * outside / (self.eta * root)
        });
        self.albedo_reduced * sigma_t * integral / (4.0 * PI * r_mm)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::oracle::{hankel, simpson};
    use crate::simulate::{Grid, Layer, LayeredSlab, Rings, Simulation};

    fn single(sigma_a: f64, sigma_s: f64, n: f64) -> SingleScattering {
        SingleScattering::new(&Medium::new(sigma_a, sigma_s, n).unwrap()).unwrap()
    }

    #[test]
    fn total_of_a_matched_half_space_is_the_classical_integral() {
        // alpha/2 ∫ mu/(1 + mu) dmu = alpha/2 (1 - ln 2).
        for albedo in [0.1, 0.5, 1.0] {
            let exact = 0.5 * albedo * (1.0 - core::f64::consts::LN_2);
            let total = single(2.0 * (1.0 - albedo), 2.0 * albedo, 1.0).total();
            assert!((total / exact - 1.0).abs() < 1e-14, "{total} against {exact}");
        }
    }

    #[test]
    fn spectrum_is_the_hankel_transform_of_the_radial_form() {
        for s in [single(0.2, 0.8, 1.0), single(0.5, 1.5, 1.4), single(0.0, 5.0, 1.3)] {
            for x in [0.0, 0.5, 2.0, 10.0] {
                let k = x * s.sigma_t_reduced_per_mm;
                let slow = hankel(k, 1e-9, 60.0 / s.sigma_t_reduced_per_mm, |r| s.at_mm(r));
                // The disc left out holds about 1e-9 sigma_t'; Gauss's rule in the radius errs by 1e-6 where the
                // exponential is steep.
                assert!((s.spectrum(k) - slow).abs() < 2e-6, "{k}: {} against {slow}", s.spectrum(k));
            }
        }
    }

    #[test]
    fn near_the_beam_it_goes_as_one_over_r() {
        let s = single(0.1, 0.9, 1.4);
        // r R(r) → alpha' sigma_t'/(4 pi) ∫ T ds, by Simpson over the sine outside.
        let transmittance =
            |sine: f64| 1.0 - fresnel_reflectance(1.0, 1.4, (1.0 - sine * sine).max(0.0).sqrt()).0;
        let limit = 0.9 / (4.0 * PI) * simpson(0.0, 1.0, 200_000, transmittance) / 1.4;
        assert!((1e-6 * s.at_mm(1e-6) / limit - 1.0).abs() < 1e-4, "{} {limit}", 1e-6 * s.at_mm(1e-6));
    }

    #[test]
    fn it_is_what_a_simulation_with_hardly_any_scattering_sees() {
        // Albedo 0.002: what is scattered twice is below 0.002 of what is scattered once.
        let (sigma_a, sigma_s, n) = (0.998, 0.002, 1.4);
        let layer = Layer {
            sigma_a_per_mm: sigma_a,
            sigma_s_per_mm: sigma_s,
            g: 0.0,
            refractive_index: n,
            thickness_mm: f64::INFINITY,
        };
        let slab = LayeredSlab::in_air(vec![layer]).unwrap();
        let entered = 1.0 - slab.specular_reflectance();
        let grid =
            Grid { rings: Rings::even(0.25, 4).unwrap(), depth_step_mm: 1.0, depth_bins: 1, cosine_bins: 1 };
        let estimates = Simulation { slab, grid, seed: 4 }.run(409_600);
        let s = single(sigma_a, sigma_s, n);
        let truth = estimates.diffuse_reflectance();
        assert!((s.total() - truth.value / entered).abs() < 4.0 * truth.standard_error + 4e-3 * s.total());
        for (i, ring) in estimates.reflectance_per_mm2().iter().enumerate() {
            let (from, to) = (0.25 * i as f64, 0.25 * (i + 1) as f64);
            let light = simpson(from.max(1e-9), to, 2000, |r| 2.0 * PI * r * s.at_mm(r));
            let mean = light / (PI * (to * to - from * from));
            let off = (mean - ring.value / entered).abs();
            // Four standard errors, four rings: one honest run in 4000 fails.
            assert!(off < 4.0 * ring.standard_error / entered + 4e-3 * mean, "{i}: {mean} {ring:?}");
        }
    }
}
