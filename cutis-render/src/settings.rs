//! How a scene is to be drawn.

use crate::RenderError;
use crate::film::Checkpoint;
use std::fmt;
use std::str::FromStr;

/// Everything that is chosen about the drawing and not about the scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Which of the published methods draws the picture.
    pub technique: TechniqueName,
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
            diffusion: Diffusion::Separable,
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

/// The published methods this renderer knows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TechniqueName {
    /// Sums of Gaussians in texture space with translucent shadows (d'Eon, Luebke & Enderton 2007).
    TextureSpace,
    /// Monte Carlo light transport in the real geometry.
    Truth,
}

impl TechniqueName {
    /// Every technique, in the order in which they are listed.
    pub const ALL: &[TechniqueName] = &[TechniqueName::TextureSpace, TechniqueName::Truth];

    /// Whether its pictures are estimated by chance, with a standard error.
    pub fn is_estimated(self) -> bool {
        self == TechniqueName::Truth
    }
}

/// Operators that spread irradiance over the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Diffusion {
    /// None: the surface is opaque. What diffusion does is best seen against this.
    None,
    /// Seven-tap blurs along u and v, scaled by the local stretch (d'Eon, Luebke & Enderton 2007, section 5.1).
    Separable,
}

/// Where the layers beside the picture live.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AovSpace {
    /// Seen through the camera, as large as the picture.
    Picture,
    /// As the texture of the first object, as large as the pass made it.
    Texture,
}

/// A layer that can be written beside the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Aov {
    /// Irradiance under the surface before any blur, W/m² (rgb).
    Irradiance,
    /// Millimetres per texel of the irradiance map along u and v.
    Stretch,
    /// Irradiance blurred by the n-th Gaussian, W/m² (rgb).
    Blur(u8),
    /// Distance through the body towards each of the first four lights, mm.
    Thickness,
    /// Shading normal in world space.
    Normal,
    /// Diffuse colour, linear.
    Albedo,
    /// Radiance reflected by the surface itself.
    Specular,
    /// Radiance that came through the body.
    Transmission,
    /// Radiance of light that has been inside the body: all but the specular part.
    Diffuse,
    /// Light that leaves a square metre of skin after having been inside, W/m² (rgb).
    Exitance,
    /// Standard error of the picture's radiance, where it is estimated by chance.
    StandardError,
    /// Number of the UV chart.
    Charts,
    /// Beside seams: mismatch of diffused light across them, relative to its mean at all seams; and 1 for the seam itself.
    Seams,
    /// Samples of a pixel: those that were shaded, and all that were taken.
    Samples,
    /// Places of all lights that were tried for a texel, to find out whether they are hidden.
    ShadowSamples,
}

/// Gaussians a kernel can have at most in the `blurN` layers.
const BLUR_LAYERS: u8 = 6;

impl Aov {
    /// All layers, in the order of the passes.
    pub fn all() -> Vec<Aov> {
        let blurs = (0..BLUR_LAYERS).map(Aov::Blur);
        let before = [Aov::Irradiance, Aov::Stretch];
        let after = [
            Aov::Thickness,
            Aov::Normal,
            Aov::Albedo,
            Aov::Specular,
            Aov::Transmission,
            Aov::Diffuse,
            Aov::Exitance,
            Aov::StandardError,
            Aov::Charts,
            Aov::Seams,
            Aov::Samples,
            Aov::ShadowSamples,
        ];
        before.into_iter().chain(blurs).chain(after).collect()
    }
}

impl Aov {
    /// Names of the layer's channels.
    pub fn channels(self) -> Vec<String> {
        let names: &[&str] = match self {
            Self::Stretch => &["U", "V"],
            Self::Thickness => &["light0", "light1", "light2", "light3"],
            Self::Normal => &["X", "Y", "Z"],
            Self::Charts => &["chart"],
            Self::Seams => &["mismatch", "seam"],
            Self::Samples => &["shaded", "taken"],
            Self::ShadowSamples => &["places"],
            _ => &["R", "G", "B"],
        };
        names.iter().map(|&name| name.to_owned()).collect()
    }
}

impl fmt::Display for Aov {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Aov::Irradiance => f.write_str("irradiance"),
            Aov::Stretch => f.write_str("stretch"),
            Aov::Blur(level) => write!(f, "blur{level}"),
            Aov::Thickness => f.write_str("thickness"),
            Aov::Normal => f.write_str("normal"),
            Aov::Albedo => f.write_str("albedo"),
            Aov::Specular => f.write_str("specular"),
            Aov::Transmission => f.write_str("transmission"),
            Aov::Diffuse => f.write_str("diffuse"),
            Aov::Exitance => f.write_str("exitance"),
            Aov::StandardError => f.write_str("standard-error"),
            Aov::Charts => f.write_str("charts"),
            Aov::Seams => f.write_str("seams"),
            Aov::Samples => f.write_str("samples"),
            Aov::ShadowSamples => f.write_str("shadow-samples"),
        }
    }
}

impl FromStr for Aov {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        Aov::all().into_iter().find(|aov| aov.to_string() == name).ok_or_else(|| {
            let names: Vec<_> = Aov::all().iter().map(Aov::to_string).collect();
            format!("there is no layer '{name}'; there are {}", names.join(", "))
        })
    }
}

impl fmt::Display for TechniqueName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            TechniqueName::TextureSpace => f.write_str("texture-space"),
            TechniqueName::Truth => f.write_str("truth"),
        }
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

impl fmt::Display for Diffusion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Diffusion::None => f.write_str("none"),
            Diffusion::Separable => f.write_str("separable"),
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

    #[test]
    fn layer_names_are_read_back() {
        for aov in Aov::all() {
            assert_eq!(aov.to_string().parse(), Ok(aov));
        }
        assert!("blur6".parse::<Aov>().is_err());
    }

    #[test]
    fn technique_names_are_read_back() {
        for technique in TechniqueName::ALL {
            assert_eq!(technique.to_string().parse(), Ok(*technique));
        }
        let refused = "raytrace".parse::<TechniqueName>().expect_err("unknown");
        assert!(refused.contains("'raytrace'") && refused.contains("texture-space"), "{refused}");
    }
}
