//! One blur of the light map in texture space, wider for red than for green and blue (Green 2004, GPU Gems, chapter 16,
//! section 16.4, listings 16-6 and 16-7).
//!
//! The light map is unwrapped and lit as for `texture-space`; light that comes through thin parts may be added
//! ([`crate::passes::thin_parts`]); [`crate::passes::seven_taps`] blurs it, and layers under the surface filter it on the way
//! ([`cutis_scene::Material::under`]). What leaves is a blend of that and of the sharp map, which none of this has touched,
//! times the colour of the body.
//! Not modelled: distances along the surface. The blur is as wide as so many texels, whatever these are on the body.

use super::{Exitance, Inside};
use crate::RenderError;
use crate::passes::resolve::Place;
use crate::settings::within;
use glam::Vec3;
use std::fmt;

/// Numbers of the technique `texture-blur`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextureBlurSettings {
    /// Weights of the taps.
    pub weights: BlurWeights,
    /// How often the light map is blurred, each time along u and along v, 0 to 64.
    pub passes: u32,
    /// Share of the blurred map in what leaves, 0 to 1.
    pub blend: f32,
    /// How wide a blur is.
    pub width: BlurWidth,
    /// Whether light that comes through thin parts, as `depth-absorption` finds it, is in the light map before it is blurred.
    pub depth: bool,
}

/// How wide a blur is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BlurWidth {
    /// The listing's, whose taps lie two texels apart, times a factor, 0 to 64.
    Listing(f32),
    /// So wide that all passes together spread red as far as the material does.
    Material,
}

/// Weights of the taps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BlurWeights {
    /// As printed in listing 16-7: red sums to 1.001, green to 1 and blue to 0.95.
    Printed,
    /// Each channel divided by its sum.
    Normalised,
}

impl BlurWeights {
    /// All of them.
    pub const ALL: [BlurWeights; 2] = [BlurWeights::Printed, BlurWeights::Normalised];
}

impl fmt::Display for BlurWeights {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            BlurWeights::Printed => "printed",
            BlurWeights::Normalised => "normalised",
        })
    }
}

impl Default for TextureBlurSettings {
    fn default() -> Self {
        Self {
            weights: BlurWeights::Normalised,
            passes: 1,
            blend: 1.0,
            width: BlurWidth::Listing(1.0),
            depth: false,
        }
    }
}

impl TextureBlurSettings {
    /// Checks every number against its range.
    ///
    /// # Errors
    /// Names the first that is out of its range.
    pub fn check(&self) -> Result<(), RenderError> {
        within("passes of the blur", self.passes as f32, "0 to 64", self.passes <= 64)?;
        if let BlurWidth::Listing(factor) = self.width {
            within(
                "width of the blur",
                factor,
                "0 to 64 times the listing's",
                (0.0..=64.0).contains(&factor),
            )?;
        }
        within("blend of the blur", self.blend, "0 to 1", (0.0..=1.0).contains(&self.blend))
    }
}

/// Light that was blurred in texture space; weights say how much of it is blended with how much of the sharp map.
pub struct Blurred;

impl Inside for Blurred {
    fn exitance(&self, place: &Place) -> Exitance {
        let maps = place.maps;
        let local = maps.diffused.weighted_sum(&maps.kernel.weights, place.point.atlas_uv, place.chart);
        Exitance { local, transmitted: Vec3::ZERO }
    }
}
