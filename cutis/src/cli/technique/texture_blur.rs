//! Flags of `texture-blur`.

use super::{blur_width, one_of, switch};
use clap::Args;
use cutis_render::technique::texture_blur::{BlurWeights, BlurWidth};

/// One blur of the light map.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Technique texture-blur (Green 2004, section 16.4)")]
pub struct TextureBlurArgs {
    /// Weights of the taps: as printed in listing 16-7, or each channel divided by its sum [default: normalised]
    #[arg(long, value_name = "NAME", value_parser = one_of(&BlurWeights::ALL))]
    pub blur_weights: Option<BlurWeights>,
    /// How often the light map is blurred, each time along u and along v [0 to 64, default 1]
    #[arg(long, value_name = "N")]
    pub blur_passes: Option<u32>,
    /// Share of the blurred map in what leaves [fraction, 0 to 1, default 1]
    #[arg(long, value_name = "FRACTION", allow_negative_numbers = true)]
    pub blur_blend: Option<f32>,
    /// How wide a blur is: times the listing's, whose taps lie two texels apart, or material: so wide that all passes
    /// together spread red as far as the material does [factor, 0 to 64, default 1]
    #[arg(long, value_name = "FACTOR", allow_hyphen_values = true, value_parser = blur_width)]
    pub blur_width: Option<BlurWidth>,
    /// Whether light that comes through thin parts, as depth-absorption finds it, is in the map before it is blurred
    /// [default: off]
    #[arg(long, value_name = "SWITCH", value_parser = switch())]
    pub blur_depth: Option<bool>,
}
