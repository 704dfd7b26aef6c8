//! What a paper drew with, as far as it tells.

use cutis_render::TechniqueName;
use cutis_render::settings::TechniqueSettings;
use cutis_render::technique::depth_absorption::{DepthAbsorptionSettings, EntryPoint};
use cutis_render::technique::image_space::{ImageSpaceProfile, ImageSpaceSettings, SampleCount};
use cutis_render::technique::texture_blur::{BlurWeights, TextureBlurSettings};
use cutis_render::technique::wrap::{WrapForm, WrapSettings, WrapShine};
use std::fmt;

/// A paper whose pictures can be drawn after it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Paper {
    /// Green 2004, "Real-time approximations to subsurface scattering", GPU Gems, chapter 16.
    Green2004,
    /// Mertens, Kautz, Bekaert, Van Reeth & Seidel 2003, "Efficient rendering of local subsurface scattering".
    Mertens2003,
}

/// What a paper had before its camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stage {
    /// Width and height of its pictures, pixels.
    pub size: [u32; 2],
    /// Preset of the material.
    pub material: &'static str,
    /// Longest side of the box around the scene, mm.
    pub longest_side_mm: f32,
}

impl Paper {
    /// All of them.
    pub const ALL: [Paper; 2] = [Paper::Green2004, Paper::Mertens2003];

    /// For people.
    pub fn title(self) -> &'static str {
        match self {
            Paper::Green2004 => "as in the paper: Green 2004",
            Paper::Mertens2003 => "as in the paper: Mertens 2003 (500 x 500, skin, 10 cm head)",
        }
    }

    /// The techniques it describes.
    pub fn techniques(self) -> &'static [TechniqueName] {
        match self {
            Paper::Green2004 => {
                &[TechniqueName::Wrap, TechniqueName::DepthAbsorption, TechniqueName::TextureBlur]
            }
            Paper::Mertens2003 => &[TechniqueName::ImageSpace],
        }
    }

    /// Settings with this paper's numbers for its techniques. What it does not tell is as by default.
    pub fn settings(self, settings: TechniqueSettings) -> TechniqueSettings {
        match self {
            Paper::Green2004 => TechniqueSettings {
                // Listing 16-1, whose last column of the table is the power that shines.
                wrap: WrapSettings {
                    form: WrapForm::Table,
                    energy_conserving: false,
                    radius_mm: None,
                    shine: WrapShine::Power,
                    ..WrapSettings::default()
                },
                // Listing 16-4: one look into one map of distances.
                depth_absorption: DepthAbsorptionSettings {
                    entry: EntryPoint::Distance,
                    samples: 1,
                    layers: 1,
                    ..DepthAbsorptionSettings::default()
                },
                // Listings 16-6 and 16-7.
                texture_blur: TextureBlurSettings {
                    weights: BlurWeights::Printed,
                    depth: false,
                    ..TextureBlurSettings::default()
                },
                ..settings
            },
            Paper::Mertens2003 => TechniqueSettings {
                image_space: ImageSpaceSettings {
                    // Section 6.2: "We omit the Jacobian for simplicity"; the counter of valid samples.
                    jacobian: false,
                    count: SampleCount::Valid,
                    // Section 5: "we take the camera view"; views of lights are a way out that section 7.1 names.
                    light_views: false,
                    profile: ImageSpaceProfile::Medium,
                    // Section 6.1 combines importance samples with uniform ones, and tells no numbers.
                    ..ImageSpaceSettings::default()
                },
                ..settings
            },
        }
    }

    /// What was before its camera, where it tells (section 7 of Mertens et al.).
    pub fn stage(self) -> Option<Stage> {
        match self {
            Paper::Green2004 => None,
            Paper::Mertens2003 => Some(Stage { size: [500, 500], material: "skin1", longest_side_mm: 100.0 }),
        }
    }
}

impl fmt::Display for Paper {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Paper::Green2004 => "green-2004",
            Paper::Mertens2003 => "mertens-2003",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn papers_change_their_own_techniques_and_are_in_range() {
        let usual = TechniqueSettings::default();
        for paper in Paper::ALL {
            let settings = paper.settings(usual.clone());
            assert!(settings != usual, "{paper}");
            for &technique in TechniqueName::ALL {
                assert_eq!(settings.check(technique), Ok(()), "{paper}");
            }
        }
        assert_eq!(Paper::Green2004.settings(usual.clone()).image_space, usual.image_space);
        assert_eq!(Paper::Mertens2003.settings(usual.clone()).wrap, usual.wrap);
    }

    #[test]
    fn what_a_paper_drew_is_there() {
        let stage = Paper::Mertens2003.stage().expect("it tells");
        assert!(cutis_optics::presets::find(stage.material).is_ok());
    }
}
