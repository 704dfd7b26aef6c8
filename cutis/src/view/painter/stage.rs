//! How good a picture is: a draft at once, then the whole, then the fine one.

use crate::view::look::Drawing;
use cutis_render::{Settings, TechniqueName};

/// A step on the way to the best picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Half the size, one sample a pixel, small textures: while things move.
    Draft,
    /// The size of the window, with the textures that were chosen.
    Whole,
    /// Smooth edges and shadows; for what is estimated by chance, ever less noise.
    Fine,
}

/// Largest irradiance texture of a draft, texels.
const DRAFT_TEXELS: u32 = 512;
/// Paths per pixel at which the truth is taken for finished.
const TRUTH_SAMPLES: u32 = 4096;

impl Stage {
    /// From the first to the best.
    pub const ALL: [Self; 3] = [Self::Draft, Self::Whole, Self::Fine];

    /// Whether a technique has a picture at this stage: what is estimated by chance gets better by itself.
    pub fn is_for(self, technique: TechniqueName) -> bool {
        self != Stage::Whole || !technique.is_estimated()
    }

    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Draft => "draft",
            Stage::Whole => "whole",
            Stage::Fine => "fine",
        }
    }

    /// The settings of a picture of a size.
    pub fn settings(self, drawing: &Drawing, size: [u32; 2]) -> Settings {
        let Drawing { technique, diffusion, irradiance_size, gaussians, .. } = *drawing;
        let size = size.map(|side| if self == Stage::Draft { side.div_ceil(2) } else { side }.max(1));
        let samples_per_pixel = match (self, technique.is_estimated()) {
            (Stage::Draft, _) => 1,
            (Stage::Fine, true) => TRUTH_SAMPLES,
            (_, true) | (Stage::Whole, _) => 4,
            (Stage::Fine, _) => 16,
        };
        Settings {
            technique,
            diffusion,
            width: size[0],
            height: size[1],
            samples_per_pixel,
            irradiance_size: if self == Stage::Draft {
                irradiance_size.min(DRAFT_TEXELS)
            } else {
                irradiance_size
            },
            gaussians,
            muted_gaussians: drawing.muted_gaussians.clone(),
            shadow_samples: if self == Stage::Fine { 32 } else { Settings::default().shadow_samples },
            close_holes: true,
            ..Settings::default()
        }
    }
}
