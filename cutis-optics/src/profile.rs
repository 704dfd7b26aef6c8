//! What a radial diffusion profile can tell, whatever it was made from.
//!
//! A source of profiles (dipole, slab, beam, simulation, a sum of Gaussians) answers three questions; fitting, plotting and
//! rendering need no more. The spectrum is the 2-D Fourier transform of a radial function, its Hankel transform
//! F(k) = 2 pi ∫ f(r) J0(k r) r dr: convolution over the plane becomes multiplication, F(0) is the total.

use crate::Pole;
use crate::powers::Powers;

/// A radially symmetric diffusion profile, normal incidence, flat surface.
pub trait Profile {
    /// Hankel transform at spatial frequency `k_per_mm` (radians per mm); no unit, real, largest at 0.
    fn spectrum(&self, k_per_mm: f64) -> f64;

    /// Radiant exitance per unit of incident flux at distance `r_mm` from the point lit, 1/mm².
    fn at_mm(&self, r_mm: f64) -> f64;

    /// The poles the profile is made of, where it is. What has poles can be fitted
    /// without optimisation ([`crate::FitMethod::Fast`]).
    fn poles(&self) -> Option<Vec<Pole>> {
        None
    }

    /// The profile as powers of one Gaussian with the usual settings, where poles and layers allow it
    /// ([`crate::FitMethod::Powers`]).
    fn powers(&self) -> Option<Powers> {
        None
    }

    /// Total over the plane: R_d for a reflectance profile. Equals the spectrum at frequency 0.
    fn total(&self) -> f64 {
        self.spectrum(0.0)
    }
}
