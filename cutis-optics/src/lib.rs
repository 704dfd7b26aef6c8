//! Light in tissue: media, diffusion profiles and the sums of Gaussians that stand for them.
//!
//! The way of the data: a [`Medium`] gives a [`Dipole`], a dipole is a [`Profile`] (radial, and in closed form in
//! spatial frequency), a profile is fitted by a [`GaussianSum`], three channels share variances in an
//! [`RgbGaussianSum`]. Layers make a [`Stack`] of [`Multipole`]s, a profile like any other; [`simulate`] is the Monte
//! Carlo that they are held to. Symbols are listed in `docs/notation.md`.
//! Lengths in mm, coefficients in 1/mm. Everything here is f64 and pure.
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

pub mod boundary;
mod burley;
mod dipole;
pub mod export;
pub mod fit;
mod gaussian_sum;
mod medium;
mod multipole;
pub mod presets;
mod profile;
mod rgb_gaussian_sum;
pub mod simulate;
mod source;
mod stack;
pub mod translate;

pub use burley::{Burley, BurleyError, BurleyScaling};
pub use dipole::{DiffusionValidity, Dipole};
pub use fit::{Fit, FitError, FitMethod, RgbFit, fit, fit_rgb, relative_rms_power_error, rgb_kernel};
pub use gaussian_sum::{Gaussian, GaussianSum};
pub use medium::{Medium, MediumError};
pub use multipole::{Multipole, MultipoleError, Response};
pub use presets::{Preset, UnknownPreset};
pub use profile::Profile;
pub use rgb_gaussian_sum::RgbGaussianSum;
pub use source::{ProfileSource, SourceError, UnknownSource};
pub use stack::{Stack, StackError, TissueLayer};

#[cfg(test)]
mod oracle;
