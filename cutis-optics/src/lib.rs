//! Light in tissue: media, diffusion profiles and the sums of Gaussians that stand for them.

mod gaussian_sum;
mod medium;

pub use gaussian_sum::{Gaussian, GaussianSum, RgbGaussianSum};
pub use medium::Medium;
