//! The published methods, and the numbers that each of them has of its own.

use crate::RenderError;
use crate::technique::depth_absorption::DepthAbsorptionSettings;
use crate::technique::image_space::ImageSpaceSettings;
use crate::technique::texture_blur::TextureBlurSettings;
use crate::technique::wrap::WrapSettings;
use std::fmt;
use std::str::FromStr;

/// The published methods this renderer knows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TechniqueName {
    /// Light that wraps around the body, with a tint where it ends (Green 2004, section 16.2).
    Wrap,
    /// Absorption over the distance that a depth map tells (Green 2004, section 16.3).
    DepthAbsorption,
    /// One blur of the light map, of another width for red (Green 2004, section 16.4).
    TextureBlur,
    /// Sums of Gaussians in texture space with translucent shadows (d'Eon, Luebke & Enderton 2007).
    TextureSpace,
    /// Samples of the diffusion profile, taken from an image of the irradiance (Mertens et al. 2003).
    ImageSpace,
    /// Monte Carlo light transport in the real geometry.
    Truth,
}

impl TechniqueName {
    /// Every technique, in the order in which they are listed.
    pub const ALL: &[TechniqueName] = &[
        TechniqueName::Wrap,
        TechniqueName::DepthAbsorption,
        TechniqueName::TextureBlur,
        TechniqueName::TextureSpace,
        TechniqueName::ImageSpace,
        TechniqueName::Truth,
    ];

    /// Whether its pictures are estimated by chance, with a standard error.
    pub fn is_estimated(self) -> bool {
        self == TechniqueName::Truth
    }
}

impl fmt::Display for TechniqueName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            TechniqueName::Wrap => "wrap",
            TechniqueName::DepthAbsorption => "depth-absorption",
            TechniqueName::TextureBlur => "texture-blur",
            TechniqueName::TextureSpace => "texture-space",
            TechniqueName::ImageSpace => "image-space",
            TechniqueName::Truth => "truth",
        })
    }
}

impl FromStr for TechniqueName {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        TechniqueName::ALL.iter().copied().find(|technique| technique.to_string() == name).ok_or_else(|| {
            let names: Vec<_> = TechniqueName::ALL.iter().map(TechniqueName::to_string).collect();
            format!("there is no technique '{name}'; there are {}", names.join(", "))
        })
    }
}

/// Numbers of the techniques that have some of their own, those of the papers by default. They stay while another technique
/// draws.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TechniqueSettings {
    /// Of `wrap`.
    pub wrap: WrapSettings,
    /// Of `depth-absorption`.
    pub depth_absorption: DepthAbsorptionSettings,
    /// Of `texture-blur`.
    pub texture_blur: TextureBlurSettings,
    /// Of `image-space`.
    pub image_space: ImageSpaceSettings,
}

impl TechniqueSettings {
    /// Checks the numbers of one technique.
    ///
    /// # Errors
    /// Names the first that is out of its range.
    pub fn check(&self, technique: TechniqueName) -> Result<(), RenderError> {
        match technique {
            TechniqueName::Wrap => self.wrap.check(),
            TechniqueName::DepthAbsorption => self.depth_absorption.check(),
            TechniqueName::TextureBlur => self.texture_blur.check(),
            TechniqueName::ImageSpace => self.image_space.check(),
            TechniqueName::TextureSpace | TechniqueName::Truth => Ok(()),
        }
    }
}

/// A number that must lie in a range; not a number lies in none.
pub(crate) fn within(
    name: &'static str,
    value: f32,
    range: &'static str,
    is_good: bool,
) -> Result<(), RenderError> {
    if is_good && !value.is_nan() {
        Ok(())
    } else {
        Err(RenderError::BadSetting { name, range, value: value.to_string() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn technique_names_are_read_back() {
        for technique in TechniqueName::ALL {
            assert_eq!(technique.to_string().parse(), Ok(*technique));
        }
        let refused = "raytrace".parse::<TechniqueName>().expect_err("unknown");
        assert!(refused.contains("'raytrace'") && refused.contains("texture-space"), "{refused}");
    }
}
