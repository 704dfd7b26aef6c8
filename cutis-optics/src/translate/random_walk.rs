//! What a renderer draws that walks at random through a medium given by its colour and mean free path.
//!
//! Symbols: C colour, the diffuse albedo of a half-space without Fresnel reflection; alpha single-scattering albedo; g mean
//! cosine; s = sqrt((1 - alpha)/(1 - alpha g)).
//! The inversion of the colour is van de Hulst's, C = (1 - s)(1 - 0.139 s)/(1 + 1.17 s), and its inverse by Kulla & Conty
//! 2017, s = 4.09712 + 4.20863 C - sqrt(9.59217 + 41.6808 C + 17.7126 C²), alpha = (1 - s²)/(1 - g s²); neither was opened:
//! the constants are those of OpenPBR, of both glTF drafts and of Cycles, held against exact albedos in the tests.
//!
//! The walk itself is not simulated here: its *shape* is taken from the dipole of that medium with a matched boundary (light
//! leaves such walks without reflection), its *total* is C, which is what the inversion is for. So single scattering and the
//! oblique entry of the light are missing in the shape, and with them what the walk does within a mean free path.

use super::Subject;
use super::least::least_error_length;
use super::loss::{LitSpectrum, WIDE_BEAM_MEAN_FREE_PATHS};
use crate::medium::SCATTERING_MIN_PER_MM;
use crate::{Dipole, Medium, Profile};

/// Mean free paths tried, in transport mean free paths of ours.
const LENGTHS: [f64; 2] = [1e-2, 1e2];

/// Diffuse albedo C of a half-space with single-scattering albedo alpha and mean cosine g, no Fresnel reflection.
///
/// Within 0.005 of the exact value for isotropic scattering.
pub fn diffuse_albedo(alpha: f64, g: f64) -> f64 {
    let s = ((1.0 - alpha) / (1.0 - alpha * g)).sqrt();
    (1.0 - s) * (1.0 - 0.139 * s) / (1.0 + 1.17 * s)
}

/// Single-scattering albedo alpha that shows the colour C, 0 to 1.
pub fn single_scattering_albedo(colour: f64, g: f64) -> f64 {
    let s = 4.09712 + 4.20863 * colour - (9.59217 + 41.6808 * colour + 17.7126 * colour * colour).sqrt();
    ((1.0 - s * s) / (1.0 - g * s * s)).clamp(0.0, 1.0)
}

/// The profile of a walk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RandomWalk {
    colour: f64,
    mean_free_path_mm: f64,
    /// Of a medium whose mean free path is 1 mm: any other is the same picture in another size.
    dipole: Dipole,
}

impl RandomWalk {
    /// The walk of isotropic steps that shows `colour`; alpha is not taken below `alpha_min` (0 for none).
    ///
    /// # Panics
    /// If the colour is not a number.
    pub fn new(colour: f64, mean_free_path_mm: f64, alpha_min: f64) -> Self {
        let alpha = single_scattering_albedo(colour, 0.0).max(alpha_min);
        let medium = Medium {
            sigma_a_per_mm: 1.0 - alpha,
            sigma_s_reduced_per_mm: alpha.max(SCATTERING_MIN_PER_MM),
            refractive_index: 1.0,
        };
        let dipole = Dipole::new(&medium).expect("an albedo makes a medium");
        Self { colour, mean_free_path_mm, dipole }
    }

    /// Mean free path 1/(sigma_a + sigma_s), mm.
    pub fn mean_free_path_mm(&self) -> f64 {
        self.mean_free_path_mm
    }
}

impl Profile for RandomWalk {
    fn spectrum(&self, k_per_mm: f64) -> f64 {
        self.colour * self.dipole.spectrum(k_per_mm * self.mean_free_path_mm) / self.dipole.total()
    }

    fn at_mm(&self, r_mm: f64) -> f64 {
        let l = self.mean_free_path_mm;
        self.colour * self.dipole.at_mm(r_mm / l) / (l * l * self.dipole.total())
    }
}

/// For each channel the walk of our total whose mean free path makes the relative RMS power error least, under the wide
/// beam.
pub(super) fn fitted_walks(subject: &Subject, alpha_min: f64) -> [RandomWalk; 3] {
    let colour = subject.albedo();
    [0, 1, 2].map(|c| {
        let l_mm = subject.mean_free_path_mm[c];
        let lit = LitSpectrum::new(subject.profiles[c], WIDE_BEAM_MEAN_FREE_PATHS * l_mm);
        let [from_mm, to_mm] = LENGTHS.map(|x| x * l_mm);
        let drawn = |length_mm: f64| RandomWalk::new(colour[c], length_mm, alpha_min);
        drawn(least_error_length(from_mm, to_mm, |length_mm| lit.relative_error(&drawn(length_mm))))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_meet_the_exact_albedos_of_an_isotropic_half_space() {
        // Diffuse albedo by Chandrasekhar's H function, matched boundary, from an independent computation.
        for (alpha, exact) in [
            (0.2, 0.046_264_87),
            (0.5, 0.146_544_38),
            (0.8, 0.341_866_85),
            (0.9, 0.478_024_49),
            (0.99, 0.794_563_65),
            (0.999, 0.929_713_28),
        ] {
            assert!(
                (diffuse_albedo(alpha, 0.0) - exact).abs() < 0.005,
                "{alpha}: {}",
                diffuse_albedo(alpha, 0.0)
            );
            let back = single_scattering_albedo(exact, 0.0);
            assert!((back - alpha).abs() < 0.01, "{exact}: {back}");
        }
    }

    #[test]
    fn the_inversion_undoes_the_colour() {
        for g in [-0.5, 0.0, 0.8] {
            for i in 0..=50 {
                let alpha = f64::from(i) / 50.0;
                let back = single_scattering_albedo(diffuse_albedo(alpha, g), g);
                // The constants have six digits; near alpha = 0 a small colour carries little about alpha.
                assert!((back - alpha).abs() < 2e-3, "{alpha} {g}: {back}");
            }
        }
    }

    #[test]
    fn size_is_all_that_the_mean_free_path_changes() {
        let (unit, tiny) = (RandomWalk::new(0.6, 1.0, 0.0), RandomWalk::new(0.6, 1e-12, 0.0));
        assert_eq!(tiny.spectrum(2e12), unit.spectrum(2.0));
        assert!((tiny.at_mm(3e-12) * 1e-24 / unit.at_mm(3.0) - 1.0).abs() < 1e-14);
        // The total over the plane, by Simpson over 4000 steps of ln r; e^-40 lies outside.
        let walk = RandomWalk::new(0.6, 0.5, 0.0);
        let ring = |t: f64| core::f64::consts::TAU * walk.at_mm(t.exp()) * (2.0 * t).exp();
        let total = crate::oracle::simpson((1e-8_f64).ln(), (60.0_f64).ln(), 4000, ring);
        assert!((total / 0.6 - 1.0).abs() < 1e-8, "{total}");
    }

    #[test]
    fn black_and_white_are_drawn() {
        let white = RandomWalk::new(1.0, 2.0, 0.0);
        assert!((white.total() - 1.0).abs() < 1e-12 && white.spectrum(1.0) < 0.3);
        assert_eq!(RandomWalk::new(0.0, 2.0, 0.0).total(), 0.0);
        let floor = RandomWalk::new(0.01, 2.0, 0.2);
        assert!((floor.total() - 0.01).abs() < 1e-15 && floor != RandomWalk::new(0.01, 2.0, 0.0));
    }
}
