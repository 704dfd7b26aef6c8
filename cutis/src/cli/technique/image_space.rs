//! Flags of `image-space`.

use super::{one_of, switch};
use clap::Args;
use cutis_render::technique::image_space::{ImageSpaceProfile, SampleCount};

/// Samples of the diffusion profile, taken from an image of the irradiance.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Technique image-space (Mertens et al. 2003)")]
pub struct ImageSpaceArgs {
    /// Samples of the profile for a sample of the picture [1 to 4096, default 32]
    #[arg(long, value_name = "N")]
    pub profile_samples: Option<u32>,
    /// Samples beside them that are spread evenly over a disc and find light beyond a shadow's border [0 to 4096, default 8]
    #[arg(long, value_name = "N")]
    pub uniform_samples: Option<u32>,
    /// Radius of that disc [mm, above 0, up to 1000000, default: that of 95 % of the light]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub uniform_radius: Option<f32>,
    /// Whether areas on the tangent plane are turned into areas on the body; the paper leaves that out [default: on]
    #[arg(long, value_name = "SWITCH", value_parser = switch())]
    pub jacobian: Option<bool>,
    /// What the sum of the samples is divided by: those that met the body, as in the paper, or all. Where lights have images of
    /// their own (--light-views), these show what the camera misses, and all count [default: valid]
    #[arg(long, value_name = "NAME", value_parser = one_of(&SampleCount::ALL))]
    pub sample_count: Option<SampleCount>,
    /// Whether light that enters on the far side is taken from images that the lights see [default: on]
    #[arg(long, value_name = "SWITCH", value_parser = switch())]
    pub light_views: Option<bool>,
    /// What radii are drawn from: the dipole of the medium or the multipole of layers, where they are known, or the sum of Gaussians of texture-space
    /// [default: medium]
    #[arg(long, value_name = "NAME", value_parser = one_of(&ImageSpaceProfile::ALL))]
    pub sampled_profile: Option<ImageSpaceProfile>,
}
