//! Photon beam diffusion of a half-space under a normal beam.
//!
//! Symbols: as in the module `grosjean`; z depth of a source on the beam, d its distance to the point at r.
//! Source: Habel, Christensen & Jarosz 2013, doi:10.1111/cgf.12148 (not opened; the formula is the one public
//! implementations use). The beam is a line of sources alpha' sigma_t' e^(-sigma_t' z), each a better dipole of its own, times
//! kappa = 1 - e^(-2 sigma_t' (d + z)), which takes back what diffusion sees too much of near the beam:
//! R(r) = alpha'² ∫ sigma_t' e^(-sigma_t' z) kappa (C_phi phi + C_E E) dz.
//!
//! In spatial frequency (ours) the line without kappa is closed, sigma_t'/(sigma_t' + q) times the better dipole over its
//! decay. What kappa takes back is, for the sources, a single integral over the cosine mu of the way (z = d mu):
//! ∫ e^(-a d) J0(b d) dd = (a² + b²)^(-1/2), ∫ d e^(-a d) J0(b d) dd = a (a² + b²)^(-3/2), with
//! a = sigma_tr + (2 + 3 mu) sigma_t' and b = k sqrt(1 - mu²); the mirror images, which are far and smooth, are summed over
//! rings.
//! Light scattered once is not in it: add [`crate::SingleScattering`].

use crate::boundary::{integral_over_unit, unit_nodes};
use crate::grosjean::Grosjean;
use crate::{Medium, MediumError, Profile};
use core::f64::consts::TAU;

/// Ends of the panels that the rings of the images lie in, in mean free paths: e^(-2 · 12) is left out.
const PANELS: [f64; 6] = [0.0, 0.5, 1.5, 3.0, 6.0, 12.0];
/// Depth at which a beam attenuated three times over has ended, in mean free paths: e^(-3 · 12).
const DEPTH: f64 = 12.0;
/// Step in ln z of the radial form; the integrand is analytic; far away the result is right to 1e-8.
const STEP: f64 = 0.1;
/// Shallowest source of the radial form, in the smaller of r and l.
const SHALLOWEST: f64 = 1e-9;
/// Deepest source of the radial form, in mean free paths: e^-40.
const DEEPEST: f64 = 40.0;

/// Light scattered more than once.
#[derive(Debug, Clone, PartialEq)]
pub struct PhotonBeam {
    grosjean: Grosjean,
    /// Radii (mm) and what kappa takes back there from the images, times area.
    images_taken_back: Vec<(f64, f64)>,
}

impl PhotonBeam {
    /// Photon beam diffusion in `medium` under air.
    ///
    /// # Errors
    /// If the medium cannot be, or its refractive index is below 1.
    pub fn new(medium: &Medium) -> Result<Self, MediumError> {
        let grosjean = Grosjean::new(medium)?;
        Ok(Self { grosjean, images_taken_back: images_taken_back(&grosjean) })
    }

    /// What kappa takes back from the sources, per spatial frequency.
    fn sources_taken_back(&self, k_per_mm: f64) -> f64 {
        let g = &self.grosjean;
        let sigma_t = g.sigma_t_reduced_per_mm;
        let integral = integral_over_unit(|mu| {
            let a = g.sigma_tr_per_mm + (2.0 + 3.0 * mu) * sigma_t;
            let root2 = a * a + k_per_mm * k_per_mm * (1.0 - mu * mu);
            let (first, second) = (root2.sqrt().recip(), a / (root2 * root2.sqrt()));
            g.c_phi / g.diffusion_mm * second + g.c_e * mu * (first + g.sigma_tr_per_mm * second)
        });
        0.5 * sigma_t * integral
    }
}

/// Rings for the images, with the integral over the beam done.
fn images_taken_back(g: &Grosjean) -> Vec<(f64, f64)> {
    let sigma_t = g.sigma_t_reduced_per_mm;
    let per_area = |r_mm: f64| {
        let depth = DEPTH / sigma_t;
        depth
            * integral_over_unit(|unit| {
                let z = unit * depth;
                let lost = (-sigma_t * (3.0 * z + 2.0 * r_mm.hypot(z))).exp();
                sigma_t * lost * g.image_exitance_per_mm2(z, r_mm)
            })
    };
    let mut rings = Vec::new();
    for ends in PANELS.windows(2) {
        let (from, width) = (ends[0] / sigma_t, (ends[1] - ends[0]) / sigma_t);
        rings.extend(unit_nodes().map(|(unit, weight)| {
            let r = from + unit * width;
            (r, TAU * r * width * weight * per_area(r))
        }));
    }
    rings
}

impl Profile for PhotonBeam {
    fn spectrum(&self, k_per_mm: f64) -> f64 {
        let g = &self.grosjean;
        let q = g.q_per_mm(k_per_mm);
        let sigma_t = g.sigma_t_reduced_per_mm;
        let line = sigma_t / (sigma_t + q) * g.exitance_over_decay(q);
        let images: f64 = self.images_taken_back.iter().map(|&(r, w)| w * libm::j0(k_per_mm * r)).sum();
        g.albedo_reduced.powi(2) * (line - self.sources_taken_back(k_per_mm) - images)
    }

    /// Infinite at r = 0, as the logarithm.
    fn at_mm(&self, r_mm: f64) -> f64 {
        if r_mm == 0.0 {
            return f64::INFINITY;
        }
        let g = &self.grosjean;
        let sigma_t = g.sigma_t_reduced_per_mm;
        let (from, to) = ((SHALLOWEST * r_mm.min(1.0 / sigma_t)).ln(), (DEEPEST / sigma_t).ln());
        let count = ((to - from) / STEP) as usize;
        let sum: f64 = (0..=count)
            .map(|i| {
                let z = (from + STEP * i as f64).exp();
                let kappa = -(-2.0 * sigma_t * (r_mm.hypot(z) + z)).exp_m1();
                z * sigma_t * (-sigma_t * z).exp() * kappa * g.exitance_per_mm2(z, r_mm)
            })
            .sum();
        g.albedo_reduced.powi(2) * STEP * sum
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::oracle::{bessel_j0, hankel, simpson};

    fn beam(sigma_a: f64, sigma_s: f64, n: f64) -> PhotonBeam {
        PhotonBeam::new(&Medium::new(sigma_a, sigma_s, n).unwrap()).unwrap()
    }

    #[test]
    fn spectrum_is_the_hankel_transform_of_the_radial_form() {
        for b in [beam(0.17, 0.88, 1.3), beam(0.1, 0.9, 1.0), beam(0.8, 0.2, 1.4), beam(0.02, 3.0, 1.5)] {
            for x in [0.0, 0.5, 2.0, 10.0] {
                let k = x * b.grosjean.sigma_t_reduced_per_mm;
                let far = 60.0 / b.grosjean.sigma_tr_per_mm;
                let slow = hankel(k, 1e-8 / b.grosjean.sigma_t_reduced_per_mm, far.min(60.0), |r| b.at_mm(r));
                assert!((b.spectrum(k) - slow).abs() < 2e-6, "{x}: {} against {slow}", b.spectrum(k));
            }
        }
    }

    #[test]
    fn fast_waves_see_the_peak() {
        // 50 turns to a mean free path: even steps, forty to a turn, out to ten mean free paths; the disc left out holds
        // 2 pi 1e-6 r R(r), and less than 1e-4 of the light lies beyond, where its waves cancel.
        let b = beam(0.3, 0.7, 1.4);
        let k = 50.0;
        let slow = simpson(1e-6, 10.0, 20_000, |r| TAU * r * b.at_mm(r) * bessel_j0(k * r));
        assert!((b.spectrum(k) - slow).abs() < 2e-6, "{} against {slow}", b.spectrum(k));
    }

    #[test]
    fn it_is_positive_and_falls() {
        let b = beam(0.1, 0.9, 1.4);
        assert_eq!(b.at_mm(0.0), f64::INFINITY);
        let mut last = f64::INFINITY;
        for x in [0.01, 0.1, 1.0, 3.0, 10.0] {
            let here = b.at_mm(x);
            assert!(here > 0.0 && here < last, "R({x}) = {here}");
            last = here;
        }
    }

    #[test]
    fn far_away_it_is_a_line_of_better_dipoles() {
        // kappa is 1 beyond a few mean free paths: the sum over the beam by another rule.
        let b = beam(0.05, 2.0, 1.4);
        let g = &b.grosjean;
        let sigma_t = g.sigma_t_reduced_per_mm;
        for r in [6.0, 10.0] {
            let slow = simpson(0.0, 40.0 / sigma_t, 4000, |z| {
                sigma_t * (-sigma_t * z).exp() * g.exitance_per_mm2(z, r)
            });
            let slow = slow * g.albedo_reduced.powi(2);
            assert!((b.at_mm(r) / slow - 1.0).abs() < 1e-8, "{r}: {} against {slow}", b.at_mm(r));
        }
    }
}
