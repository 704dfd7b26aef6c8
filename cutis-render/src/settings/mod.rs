//! How a scene is to be drawn.

mod aov;
mod technique;

use crate::RenderError;
use crate::film::Checkpoint;
pub use aov::{Aov, AovSpace};
use std::fmt;
pub(crate) use technique::within;
pub use technique::{TechniqueName, TechniqueSettings};

/// Everything that is chosen about the drawing and not about the scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Which of the published methods draws the picture.
    pub technique: TechniqueName,
    /// Numbers that belong to one technique each.
    pub techniques: TechniqueSettings,
    /// Operator that spreads light over the surface.
    pub diffusion: Diffusion,
    /// Width of the picture, pixels.
    pub width: u32,
    /// Height of the picture, pixels.
    pub height: u32,
    /// Samples per pixel; the technique `texture-space` rounds them up to a square number and lays them out as a jittered
    /// grid, `truth` takes as many paths.
    pub samples_per_pixel: u32,
    /// Width and height of the texture that holds the irradiance of the largest object, texels.
    pub irradiance_size: u32,
    /// Gaussians in the kernel of a material that is given by its coefficients.
    pub gaussians: usize,
    /// Numbers of the kernel's Gaussians that are left out, to see what each does; the others keep their weights.
    pub muted_gaussians: Vec<usize>,
    /// Shadow rays per texel towards a light with an extent.
    pub shadow_samples: u32,
    /// Ambient-occlusion rays per texel of the (smaller) occlusion map.
    pub ambient_samples: u32,
    /// Whether to measure what the diffusion did to energy and seams.
    pub diffusion_report: bool,
    /// Noise at which the technique `truth` stops before all samples are taken: root mean squared standard error over mean
    /// radiance.
    pub target_error: Option<f64>,
    /// Whether the technique `truth` caps the holes of open bodies instead of refusing them.
    pub close_holes: bool,
    /// Where the technique `truth` keeps its state and goes on from it.
    pub checkpoint: Option<Checkpoint>,
    /// Seed of every random choice: the same seed and scene give the same bits.
    pub seed: u64,
    /// Layers wanted beside the picture.
    pub aovs: Vec<Aov>,
    /// Whether those layers are seen through the camera or as the textures they are.
    pub aov_space: AovSpace,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            technique: TechniqueName::TextureSpace,
            techniques: TechniqueSettings::default(),
            diffusion: Diffusion::HeatFlow,
            width: 1024,
            height: 1024,
            samples_per_pixel: 4,
            irradiance_size: 2048,
            gaussians: 6,
            muted_gaussians: Vec::new(),
            shadow_samples: 4,
            ambient_samples: 6,
            diffusion_report: false,
            target_error: None,
            close_holes: false,
            checkpoint: None,
            seed: 1,
            aovs: Vec::new(),
            aov_space: AovSpace::Picture,
        }
    }
}

/// How much work a picture is worth: after table 1 of d'Eon, Luebke & Enderton 2007.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quality {
    /// Maps of 2048² texels, 2500 × 1500 samples, which the paper shows at a smaller size: 1250 × 750 pixels of four here.
    Full,
    /// Maps and picture of 1024², one sample a pixel, half of the rays.
    Low,
    /// What [`Settings::default`] says.
    Auto,
}

impl Quality {
    /// All of them, in the order in which they are listed.
    pub const ALL: [Quality; 3] = [Quality::Full, Quality::Low, Quality::Auto];
}

impl fmt::Display for Quality {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Quality::Full => "full",
            Quality::Low => "low",
            Quality::Auto => "auto",
        })
    }
}

/// Largest side of a picture or texture: 16384² texels of four floats are 4 GiB.
const MAX_SIZE: u32 = 16_384;

impl Settings {
    /// These with the sizes and numbers of samples of a quality; shadow maps are as large as the irradiance.
    #[must_use]
    pub fn with_quality(self, quality: Quality) -> Self {
        let auto = Self::default();
        let (width, height, samples_per_pixel, irradiance_size, divisor) = match quality {
            Quality::Full => (1250, 750, 4, 2048, 1),
            Quality::Low => (1024, 1024, 1, 1024, 2),
            Quality::Auto => (auto.width, auto.height, auto.samples_per_pixel, auto.irradiance_size, 1),
        };
        let (shadow_samples, ambient_samples) =
            (auto.shadow_samples / divisor, auto.ambient_samples / divisor);
        Self { width, height, samples_per_pixel, irradiance_size, shadow_samples, ambient_samples, ..self }
    }

    /// Samples along a side of a pixel, where they are laid out as a grid.
    pub fn samples_grid(&self) -> u32 {
        (self.samples_per_pixel as f32).sqrt().ceil() as u32
    }

    /// The technique that says how light gets through the bodies: an opaque surface is the same for all, and is drawn as by
    /// `texture-space`.
    pub fn light_inside(&self) -> TechniqueName {
        if self.diffusion == Diffusion::None { TechniqueName::TextureSpace } else { self.technique }
    }

    /// Whether light spreads by heat flow; other techniques than `texture-space` have ways of their own.
    pub fn lets_heat_flow(&self) -> bool {
        self.light_inside() == TechniqueName::TextureSpace && self.diffusion == Diffusion::HeatFlow
    }

    /// Checks every setting against its range.
    ///
    /// # Errors
    /// Names the first setting that is out of its range.
    pub fn check(&self) -> Result<(), RenderError> {
        let in_range = |name, value: u32, lo: u32, hi: u32, range| {
            let bad = || RenderError::BadSetting { name, range, value: value.to_string() };
            if (lo..=hi).contains(&value) { Ok(()) } else { Err(bad()) }
        };
        in_range("width", self.width, 1, MAX_SIZE, "1 to 16384 pixels")?;
        in_range("height", self.height, 1, MAX_SIZE, "1 to 16384 pixels")?;
        in_range("samples per pixel", self.samples_per_pixel, 1, 1_048_576, "1 to 1048576")?;
        in_range("irradiance size", self.irradiance_size, 16, MAX_SIZE, "16 to 16384 texels")?;
        in_range("gaussians", self.gaussians as u32, 1, 16, "1 to 16")?;
        in_range("shadow samples", self.shadow_samples, 1, 1024, "1 to 1024")?;
        in_range("ambient samples", self.ambient_samples, 1, 4096, "1 to 4096")?;
        self.techniques.check(self.technique)?;
        match self.target_error {
            Some(error) if !(error > 0.0 && error < 1.0) => Err(RenderError::BadSetting {
                name: "target error",
                range: "above 0 and below 1",
                value: error.to_string(),
            }),
            _ => Ok(()),
        }
    }
}

/// Operators that spread irradiance over the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Diffusion {
    /// None: the surface is opaque. What diffusion does is best seen against this.
    None,
    /// Seven-tap blurs along u and v, scaled by the local stretch (d'Eon, Luebke & Enderton 2007, section 5.1).
    Separable,
    /// Heat that flows from texel to texel by the metric of the surface, across seams as within charts.
    HeatFlow,
}

impl fmt::Display for Diffusion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Diffusion::None => f.write_str("none"),
            Diffusion::Separable => f.write_str("separable"),
            Diffusion::HeatFlow => f.write_str("heat-flow"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn qualities_are_those_of_the_papers_table() {
        let samples = |s: &Settings| {
            let grid = s.samples_per_pixel.isqrt();
            [s.width * grid, s.height * grid, s.irradiance_size]
        };
        let own = Settings { seed: 7, ..Settings::default() };
        assert_eq!(samples(&own.clone().with_quality(Quality::Full)), [2500, 1500, 2048]);
        assert_eq!(samples(&own.clone().with_quality(Quality::Low)), [1024, 1024, 1024]);
        assert_eq!(own.clone().with_quality(Quality::Auto), own, "the rest is kept");
        for quality in Quality::ALL {
            assert_eq!(own.clone().with_quality(quality).check(), Ok(()));
        }
    }
}
