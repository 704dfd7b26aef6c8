//! How good a picture is: a draft at once, then the whole, then the fine one.

use super::Wish;
use crate::view::look::Drawing;
use cutis_render::settings::Quality;
use cutis_render::{Diffusion, Settings, TechniqueName};

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

/// Pictures whose mean is taken, where each has a pattern of its own: its grain falls to an eighth.
const ROUNDS: u32 = 64;

/// How many pictures of a side are drawn for the mean of all. A film of many pictures has one of each.
pub fn rounds(wish: &Wish, side: usize) -> u32 {
    let Drawing { technique, diffusion, .. } = wish.looks[side].drawing;
    let has_pattern = technique == TechniqueName::ImageSpace && diffusion != Diffusion::None;
    if has_pattern && !wish.is_for_a_file { ROUNDS } else { 1 }
}

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
        let plain = Settings::default().with_quality(drawing.quality);
        // Left to itself, the window goes beyond what a picture in a file is worth: there is time.
        let (samples, shadow_samples) = match (self, drawing.quality) {
            (Stage::Fine, Quality::Auto) => (16, 32),
            _ => (plain.samples_per_pixel, plain.shadow_samples),
        };
        let samples_per_pixel = match (self, technique.is_estimated()) {
            (Stage::Draft, _) => 1,
            (Stage::Fine, true) => TRUTH_SAMPLES,
            _ => samples,
        };
        Settings {
            technique,
            techniques: drawing.techniques.clone(),
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
            shadow_samples,
            ambient_samples: plain.ambient_samples,
            close_holes: true,
            ..Settings::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_picture_of_a_quality_has_its_samples() {
        let mut drawing = Drawing::default();
        for quality in [Quality::Full, Quality::Low] {
            drawing.set_quality(quality);
            let (fine, plain) =
                (Stage::Fine.settings(&drawing, [64, 48]), Settings::default().with_quality(quality));
            let numbers =
                |s: &Settings| [s.irradiance_size, s.samples_per_pixel, s.shadow_samples, s.ambient_samples];
            assert_eq!(numbers(&fine), numbers(&plain), "{quality}");
            assert_eq!([fine.width, fine.height], [64, 48], "the window says how large");
        }
        drawing.set_quality(Quality::Auto);
        assert_eq!(drawing, Drawing::default(), "the way back");
    }
}
