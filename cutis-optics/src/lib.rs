//! Light in tissue: media, diffusion profiles and the sums of Gaussians that stand for them.
//!
//! The way of the data: a [`Medium`], or layers of them, become a [`Profile`] by one of the sources ([`ProfileSource`]:
//! [`Dipole`], [`BetterDipole`], a [`Stack`] of [`Multipole`]s, [`PhotonBeam`], or a [`RingProfile`] from [`simulate`], the
//! Monte Carlo that all others are held to); a profile is fitted by a [`GaussianSum`] ([`fit()`]), and several share
//! variances in an [`RgbGaussianSum`]. Symbols are listed in `docs/notation.md`.
//! Lengths in mm, coefficients in 1/mm. Everything here is f64 and pure.
//!
//! Renderers that gather light around a point draw radii from any of them: [`sample`].
//!
//! What leaves the house: [`export`] writes kernels as constants of shaders, [`translate`] says a material in the words of
//! other renderers, and how much is lost.
//!
//! From layers to a table in WGSL:
//!
//! ```
//! use cutis_optics::{FitMethod, Medium, Stack, TissueLayer, export::KernelTable, fit};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let upper = TissueLayer { medium: Medium::new(0.2, 4.8, 1.4)?, thickness_mm: 0.25 };
//! let lower = TissueLayer { medium: Medium::new(0.1, 3.0, 1.38)?, thickness_mm: f64::INFINITY };
//! let profile = Stack::in_air(&[upper, lower])?;
//! let table = KernelTable::from_fit("two layers", "multipole", &fit(&profile, 6, FitMethod::Energy)?);
//! let wgsl = table.to_wgsl();
//! # assert!(wgsl.contains("array<f32, 6>"));
//! # Ok(())
//! # }
//! ```

mod better_dipole;
pub mod boundary;
mod burley;
mod dipole;
pub mod export;
pub mod fit;
mod gaussian_sum;
mod grosjean;
mod hankel;
mod medium;
mod multipole;
mod photon_beam;
mod pole;
pub mod powers;
pub mod presets;
mod profile;
mod rgb_gaussian_sum;
mod ring_profile;
pub mod sample;
pub mod simulate;
mod single_scattering;
mod source;
mod stack;
mod tabulated_profile;
pub mod translate;
mod trust;
mod wide_beam;

pub use better_dipole::BetterDipole;
pub use boundary::Boundary;
pub use burley::{Burley, BurleyError, BurleyScaling};
pub use dipole::{DiffusionValidity, Dipole};
pub use fit::{
    Fit, FitError, FitMethod, FitSettings, JointFit, RgbFit, WorstError, fit, fit_joint, fit_rgb,
    fit_weights, fit_with, relative_rms_power_error, rgb_kernel, worst_absolute_error,
};
pub use gaussian_sum::{Gaussian, GaussianSum};
pub use medium::{Medium, MediumError};
pub use multipole::{Multipole, MultipoleError, Response, TooThin};
pub use photon_beam::PhotonBeam;
pub use pole::Pole;
pub use presets::{Preset, UnknownPreset};
pub use profile::Profile;
pub use rgb_gaussian_sum::RgbGaussianSum;
pub use ring_profile::RingProfile;
pub use single_scattering::SingleScattering;
pub use source::{BoxedProfile, ProfileSource, SourceError};
pub use stack::{Stack, StackError, StackTransmittance, TissueLayer};
pub use tabulated_profile::TabulatedProfile;
pub use trust::Trust;
pub use wide_beam::WideBeam;

#[cfg(test)]
mod oracle;
