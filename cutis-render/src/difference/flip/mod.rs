//! FLIP: how visible the difference is to a person who flips between two pictures on one screen.
//!
//! Symbols: `p` pixels per degree of the visual angle; YyCxCz an opponent space linear in light; ΔE the error of a
//! pixel, 0 (unseen) to 1. Colours are blurred as the eye blurs them ([`contrast`]), then compared in L*a*b* with Hunt's
//! effect and the HyAB distance ([`colour`]); edges and points are compared apart ([`features`]) and amplify the error
//! of the colour. [`exposures`] takes pictures without limit of brightness apart into exposures.
//!
//! Source: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström & Fairchild 2020, "FLIP: A Difference Evaluator for
//! Alternating Images", doi:10.1145/3406183; Andersson, Nilsson, Shirley & Akenine-Möller 2021, "Visualizing Errors in
//! Rendered High Dynamic Range Images", doi:10.2312/egs.20211015 (constants compared with the authors' published code,
//! version 1.7; equation numbers not checked). Beyond the edge of the picture its edge is repeated, as in that code.

mod colour;
mod contrast;
mod exposures;
mod features;
mod plane;

pub use exposures::{Exposures, HdrFlip, hdr_flip};

use super::Pair;
use colour::{Perceived, opponent};
use contrast::ContrastFilter;
use features::FeatureFilter;
use glam::Vec3;
use plane::Plane;
use rayon::prelude::*;

/// Pixels per degree of someone 0.7 m before a screen 0.7 m and 3840 pixels wide, rounded.
pub const DEFAULT_PIXELS_PER_DEGREE: f64 = 67.0;

/// Exponent of the difference of features (`q_f` in the paper).
const FEATURE_EXPONENT: f32 = 0.5;

/// The error of every pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct FlipMap {
    /// Errors in 0..=1, rows from the top.
    pub errors: Vec<f32>,
    /// Their mean.
    pub mean: f64,
    /// The largest.
    pub max: f32,
}

impl FlipMap {
    fn new(errors: Vec<f32>) -> Self {
        // In order: the same bits on any number of threads.
        let mean = errors.iter().map(|&e| f64::from(e)).sum::<f64>() / errors.len() as f64;
        let max = errors.iter().copied().fold(0.0, f32::max);
        Self { errors, mean, max }
    }
}

/// FLIP of two pictures on a screen: display-linear Rec. 709, clamped to 0..=1, 1 being the screen's white.
///
/// # Panics
/// If `pixels_per_degree` is not a number of at least 1.
pub fn ldr_flip(pair: Pair<'_>, pixels_per_degree: f64) -> FlipMap {
    let filters = Filters::new(pixels_per_degree);
    FlipMap::new(filters.errors(pair.test, pair.reference, pair.width, |colour| colour))
}

/// What the eye of a viewer at a distance does to a picture.
struct Filters {
    contrast: ContrastFilter,
    features: FeatureFilter,
}

impl Filters {
    fn new(pixels_per_degree: f64) -> Self {
        assert!(pixels_per_degree >= 1.0, "at least 1 pixel per degree, got {pixels_per_degree}");
        let contrast = ContrastFilter::new(pixels_per_degree);
        Self { contrast, features: FeatureFilter::new(pixels_per_degree) }
    }

    /// Errors of two pictures that `show` brings onto a screen.
    fn errors(
        &self,
        test: &[Vec3],
        reference: &[Vec3],
        width: usize,
        show: impl Fn(Vec3) -> Vec3 + Sync,
    ) -> Vec<f32> {
        let seen = |pixels| self.seen(pixels, width, &show);
        let (test, reference) = (seen(test), seen(reference));
        let colours = test.colours.par_iter().zip(&reference.colours);
        let features = test.features.par_iter().zip(&reference.features);
        colours.zip(features).map(|((a, b), (f, g))| combined(a.distance(b), f.distance(g))).collect()
    }

    fn seen(&self, pixels: &[Vec3], width: usize, show: &(impl Fn(Vec3) -> Vec3 + Sync)) -> Seen {
        let on_screen = |&pixel: &Vec3| opponent(show(pixel).clamp(Vec3::ZERO, Vec3::ONE));
        let opponents: Vec<Vec3> = pixels.par_iter().map(on_screen).collect();
        let channels = [0, 1, 2].map(|c| Plane::new(width, opponents.par_iter().map(|o| o[c]).collect()));
        let colours = self.contrast.filtered(&channels).into_par_iter().map(Perceived::new).collect();
        let [lightness, ..] = channels;
        Seen { colours, features: self.features.of(lightness) }
    }
}

/// A picture as it is seen.
struct Seen {
    colours: Vec<Perceived>,
    features: Vec<features::Features>,
}

/// ΔE = ΔE_colour^(1 - ΔE_feature).
fn combined(colour: f32, feature: f32) -> f32 {
    let feature = (feature * std::f32::consts::FRAC_1_SQRT_2).powf(FEATURE_EXPONENT);
    colour.powf(1.0 - feature).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests;
