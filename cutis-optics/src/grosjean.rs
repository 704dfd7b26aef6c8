//! Grosjean's diffusion of a half-space: what the better dipole and photon beam diffusion share.
//!
//! Symbols: `D_G` = (2 sigma_a + sigma_s') / (3 sigma_t'²), sigma_tr = sqrt(sigma_a / D_G), z_b = 2 A D_G height of the
//! extrapolated boundary with A = (1 + 3 C2)/(1 - 2 C1), C_phi = (1 - 2 C1)/4, C_E = (1 - 3 C2)/2.
//! Source: d'Eon & Irving 2011, doi:10.1145/1964921.1964951, and d'Eon 2012, "A Better Dipole" (neither opened; the formulas
//! are those of public implementations, checked against Monte Carlo in the tests).
//! The light scattered *once* is left out, its part is [`crate::SingleScattering`]; hence the factor alpha'², one collision
//! for the source and one for the way.

use crate::boundary::fresnel_moments;
use crate::{Medium, MediumError};
use core::f64::consts::PI;

/// The numbers of a half-space under air.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Grosjean {
    pub(crate) albedo_reduced: f64,
    pub(crate) sigma_t_reduced_per_mm: f64,
    pub(crate) sigma_tr_per_mm: f64,
    pub(crate) diffusion_mm: f64,
    /// 2 z_b, mm: a source at depth z has its mirror image at height z + 2 z_b.
    pub(crate) twice_boundary_mm: f64,
    pub(crate) c_phi: f64,
    pub(crate) c_e: f64,
}

impl Grosjean {
    /// Refuses what [`Medium::validated`] refuses, and indices below that of air.
    pub(crate) fn new(medium: &Medium) -> Result<Self, MediumError> {
        let medium = medium.validated()?;
        let eta = medium.refractive_index;
        if eta < 1.0 {
            return Err(MediumError::BelowAir { value: eta });
        }
        let moments = fresnel_moments(eta);
        let sigma_t = medium.sigma_t_reduced_per_mm();
        let diffusion_mm = (medium.sigma_a_per_mm + sigma_t) / (3.0 * sigma_t * sigma_t);
        let a = (1.0 + moments.three_c2) / (1.0 - moments.two_c1);
        Ok(Self {
            albedo_reduced: medium.albedo_reduced(),
            sigma_t_reduced_per_mm: sigma_t,
            sigma_tr_per_mm: (medium.sigma_a_per_mm / diffusion_mm).sqrt(),
            diffusion_mm,
            twice_boundary_mm: 4.0 * a * diffusion_mm,
            c_phi: 0.25 * (1.0 - moments.two_c1),
            c_e: 0.5 * (1.0 - moments.three_c2),
        })
    }

    /// q = sqrt(k² + sigma_tr²), 1/mm.
    pub(crate) fn q_per_mm(&self, k_per_mm: f64) -> f64 {
        k_per_mm.hypot(self.sigma_tr_per_mm)
    }

    /// Exitance per area at distance r from above a source of power 1 at `depth_mm`, 1/mm², its mirror image included.
    pub(crate) fn exitance_per_mm2(&self, depth_mm: f64, r_mm: f64) -> f64 {
        self.source_exitance_per_mm2(depth_mm, r_mm) + self.image_exitance_per_mm2(depth_mm, r_mm)
    }

    /// The part of the source itself.
    pub(crate) fn source_exitance_per_mm2(&self, depth_mm: f64, r_mm: f64) -> f64 {
        let (fluence, flux) = self.fluence_and_flux(depth_mm, r_mm);
        self.c_phi * fluence + self.c_e * flux
    }

    /// The part of its mirror image, a sink: less fluence, more flux.
    pub(crate) fn image_exitance_per_mm2(&self, depth_mm: f64, r_mm: f64) -> f64 {
        let (fluence, flux) = self.fluence_and_flux(depth_mm + self.twice_boundary_mm, r_mm);
        self.c_e * flux - self.c_phi * fluence
    }

    /// Of a point source at a distance z from the surface, 1/mm².
    fn fluence_and_flux(&self, z_mm: f64, r_mm: f64) -> (f64, f64) {
        let s = r_mm.hypot(z_mm);
        let x = self.sigma_tr_per_mm * s;
        let decay = (-x).exp() / (4.0 * PI * s);
        (decay / self.diffusion_mm, z_mm * (1.0 + x) * decay / (s * s))
    }

    /// The same per spatial frequency, divided by e^(-q depth), at the q of that frequency:
    /// C_phi (1 - e^(-2 q z_b)) / (2 D q) + C_E (1 + e^(-2 q z_b)) / 2.
    pub(crate) fn exitance_over_decay(&self, q_per_mm: f64) -> f64 {
        let x = q_per_mm * self.twice_boundary_mm;
        // (1 - e^-x)/q, whose limit is the length itself.
        let between_mm = if x > 0.0 { -(-x).exp_m1() / q_per_mm } else { self.twice_boundary_mm };
        0.5 * (self.c_phi * between_mm / self.diffusion_mm + self.c_e * (1.0 + (-x).exp()))
    }
}
