//! Flags of the numbers that one technique has of its own, under a heading for each.
//!
//! What is left out stays as it is by default, or as a paper has it (`--as-in`). Ranges are checked by the technique itself
//! ([`crate::techniques`]).

mod depth_absorption;
mod image_space;
mod texture_blur;
mod wrap;

use crate::techniques::ramp;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use cutis_render::prepare::ColourRamp;
use cutis_render::technique::texture_blur::BlurWidth;
pub use depth_absorption::DepthAbsorptionArgs;
use glam::Vec3;
pub use image_space::ImageSpaceArgs;
use std::fmt::Display;
use std::sync::Arc;
pub use texture_blur::TextureBlurArgs;
pub use wrap::WrapArgs;

/// Numbers of all techniques that have some of their own.
#[derive(Debug, Clone, Default, Args)]
pub struct TechniqueArgs {
    #[command(flatten)]
    pub wrap: WrapArgs,
    #[command(flatten)]
    pub depth_absorption: DepthAbsorptionArgs,
    #[command(flatten)]
    pub texture_blur: TextureBlurArgs,
    #[command(flatten)]
    pub image_space: ImageSpaceArgs,
}

/// One of some values, by name.
fn one_of<T: Display + Copy + Send + Sync>(all: &'static [T]) -> impl TypedValueParser<Value = T> {
    let find = |name: String| all.iter().copied().find(|one| one.to_string() == name).ok_or("is not known");
    PossibleValuesParser::new(all.iter().map(ToString::to_string)).try_map(find)
}

/// `on` or `off`: a paper's wish can be undone by either.
fn switch() -> impl TypedValueParser<Value = bool> {
    PossibleValuesParser::new(["on", "off"]).map(|word| word == "on")
}

/// Three numbers.
pub fn colour(words: &str) -> Result<Vec3, String> {
    let numbers: Option<Vec<f32>> = words.split(',').map(|word| word.trim().parse().ok()).collect();
    let three: Option<[f32; 3]> = numbers.and_then(|numbers| numbers.try_into().ok());
    three.map(Vec3::from).ok_or_else(|| "must be three numbers, R,G,B, such as 0.15,0,0".to_owned())
}

/// Gradient stops.
fn stops(words: &str) -> Result<Arc<ColourRamp>, String> {
    ramp::of_words(words).map(Arc::new)
}

/// A factor, or as wide as the material asks for.
fn blur_width(words: &str) -> Result<BlurWidth, String> {
    match words {
        "material" => Ok(BlurWidth::Material),
        _ => words.parse().map(BlurWidth::Listing).map_err(|_| "must be a number or 'material'".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_three_numbers() {
        assert_eq!(colour("0.15, 0,1e-1"), Ok(Vec3::new(0.15, 0.0, 0.1)));
        for bad in ["", "1", "1,2", "1,2,3,4", "red", "1,,2", "1;2;3"] {
            assert!(colour(bad).is_err_and(|reason| reason.contains("three numbers")), "{bad}");
        }
    }

    #[test]
    fn widths_are_factors_or_those_of_the_material() {
        assert_eq!(blur_width("2.5"), Ok(BlurWidth::Listing(2.5)));
        assert_eq!(blur_width("material"), Ok(BlurWidth::Material));
        assert!(blur_width("wide").is_err());
    }
}
