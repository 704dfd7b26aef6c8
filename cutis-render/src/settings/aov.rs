//! Layers that can be written beside the picture.

use std::fmt;
use std::str::FromStr;

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layer_names_are_read_back() {
        for aov in Aov::all() {
            assert_eq!(aov.to_string().parse(), Ok(aov));
        }
        assert!("blur6".parse::<Aov>().is_err());
    }
}
