//! Light in tissue: media, diffusion profiles and the sums of Gaussians that stand for them.
//!
//! The way of the data: a [`Medium`] gives a [`Dipole`], a dipole is a [`Profile`] (radial, and in closed form in
//! spatial frequency), a profile is fitted by a [`GaussianSum`], three channels share variances in an
//! [`RgbGaussianSum`]. Layers make a [`Stack`] of [`Multipole`]s, a profile like any other; [`simulate`] is the Monte
//! Carlo that they are held to. Symbols are listed in `docs/notation.md`.
//! Lengths in mm, coefficients in 1/mm. Everything here is f64 and pure.

mod better_dipole;
pub mod boundary;
mod dipole;
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
pub mod simulate;
mod single_scattering;
mod source;
mod stack;
mod wide_beam;

pub use better_dipole::BetterDipole;
pub use boundary::Boundary;
pub use dipole::{DiffusionValidity, Dipole};
pub use fit::{
    Fit, FitError, FitMethod, FitSettings, JointFit, RgbFit, WorstError, fit, fit_joint, fit_rgb,
    fit_weights, fit_with, relative_rms_power_error, rgb_kernel, worst_absolute_error,
};
pub use gaussian_sum::{Gaussian, GaussianSum};
pub use medium::{Medium, MediumError};
pub use multipole::{Multipole, MultipoleError, Response};
pub use photon_beam::PhotonBeam;
pub use pole::Pole;
pub use presets::{Preset, UnknownPreset};
pub use profile::Profile;
pub use rgb_gaussian_sum::RgbGaussianSum;
pub use ring_profile::RingProfile;
pub use single_scattering::SingleScattering;
pub use source::{BoxedProfile, Source, SourceError};
pub use stack::{Stack, StackError, TissueLayer};
pub use wide_beam::WideBeam;

#[cfg(test)]
mod oracle;
