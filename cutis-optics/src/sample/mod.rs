//! Radii drawn from a radial profile, for renderers that gather light around a point of the picture.
//!
//! Symbols: `xi` a number in [0, 1), evenly distributed; p(r) = R(r)/R_d density over the plane, 1/mm²; radii then have the
//! density 2 pi r p(r) per mm. All samplers speak f32, as renderers do; tables and normalisation are f64.
//! Source: image-space importance sampling, Mertens, Kautz, Bekaert, Van Reeth & Seidel 2003, "Efficient rendering of local
//! subsurface scattering" (as restated in the project's theory notes).
//! Which one: [`DipoleSampler`] is exact and needs no table, [`GaussianSampler`] draws from what the blurs of a renderer draw
//! with, [`TabulatedSampler`] takes any [`crate::Profile`], and [`MixtureSampler`] draws one set of radii for several of them.
//! Not modelled: the true distance on a curved surface. The estimator divides R at that distance by p at the radius drawn.

mod dipole;
mod disc;
mod gaussians;
mod mixture;
mod tabulated;
mod uniform_disc;

pub use dipole::DipoleSampler;
pub use disc::{DISC_SAMPLES, DISC_SAMPLES_FINE, DiscPattern, DiscSample, INTERLEAVED_PIXELS};
pub use gaussians::GaussianSampler;
pub use mixture::MixtureSampler;
pub use tabulated::TabulatedSampler;
pub use uniform_disc::UniformDisc;

use wide::f32x8;

/// The largest f32 below 1: what 1 and more are taken for.
pub const XI_MAX: f32 = 1.0 - 0.5 * f32::EPSILON;

/// Draws radii whose density over the plane is that of a profile.
pub trait RadialSampler {
    /// The radius that belongs to `xi` in [0, 1), mm. Numbers outside are moved to its ends, NaN to 0.
    ///
    /// It grows with `xi` where the profile is one piece; a mixture (poles, Gaussians) spends one interval of `xi` on
    /// each of its parts.
    fn radius_mm(&self, xi: f32) -> f32;

    /// Density over the plane at a radius, 1/mm²: p(r), with ∫ p 2 pi r dr = 1.
    fn pdf_per_mm2(&self, radius_mm: f32) -> f32;

    /// Share of the samples within a radius.
    fn cdf(&self, radius_mm: f32) -> f32;

    /// Many radii at once; the same bits as [`RadialSampler::radius_mm`] gives, faster.
    ///
    /// # Panics
    /// If the slices are not of one length.
    fn radii_mm(&self, xi: &[f32], radii_mm: &mut [f32]);
}

/// Why there is no sampler.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SamplerError {
    /// A density has no negative part. Fits by `energy` have none.
    #[error(
        "a Gaussian of weight {weight} cannot be sampled; fit with the method energy, which keeps weights above 0"
    )]
    NegativeWeight {
        /// The weight.
        weight: f64,
    },
    /// Not a width.
    #[error("the variance of a Gaussian to sample must lie in 1e-30 to 1e30 mm², got {variance_mm2} mm²")]
    Variance {
        /// The variance, mm².
        variance_mm2: f64,
    },
    /// Nothing to distribute.
    #[error("a profile with a total of {total} cannot be sampled")]
    Total {
        /// The total.
        total: f64,
    },
    /// Not a length.
    #[error(
        "the mean free path of a profile to sample must lie in 1e-12 to 1e12 mm, got {mean_free_path_mm} mm"
    )]
    MeanFreePath {
        /// What was given, mm.
        mean_free_path_mm: f64,
    },
}

/// `xi` moved into [0, [`XI_MAX`]], NaN to 0.
#[inline(always)]
fn unit(xi: f32x8) -> f32x8 {
    // The processor's maximum and minimum hand on their second operand where the first is NaN.
    xi.max(f32x8::ZERO).fast_min(f32x8::splat(XI_MAX))
}

/// The same for a single number.
fn in_unit(xi: f32) -> f32 {
    // Unlike a clamp, a maximum of NaN and 0 is 0.
    XI_MAX.min(xi.max(0.0))
}

/// Odds of the part of [0, 1) before `xi` against the part behind it, within the interval that holds it: 0 at `from`,
/// without end towards `to`. Of both differences no digit is lost, and ln(1 + odds) = -ln(1 - share).
#[inline(always)]
fn odds(xi: f32x8, from: f32x8, to: f32x8) -> f32x8 {
    (xi - from) / (to - xi)
}

/// Eight at a time; the last few share their lanes with zeros.
#[inline(always)]
fn in_lanes(xi: &[f32], radii_mm: &mut [f32], radii_of: impl Fn(f32x8) -> f32x8) {
    assert_eq!(xi.len(), radii_mm.len(), "a radius for every number");
    let (eights, rest) = xi.as_chunks::<8>();
    let (radii_eights, radii_rest) = radii_mm.as_chunks_mut::<8>();
    for (xi, radii) in eights.iter().zip(radii_eights) {
        *radii = radii_of(f32x8::new(*xi)).to_array();
    }
    if !rest.is_empty() {
        let mut last = [0.0; 8];
        last[..rest.len()].copy_from_slice(rest);
        radii_rest.copy_from_slice(&radii_of(f32x8::new(last)).to_array()[..rest.len()]);
    }
}

#[cfg(test)]
mod tests;
