//! Flags of `depth-absorption`.

use super::{colour, one_of, stops};
use clap::Args;
use cutis_render::prepare::ColourRamp;
use cutis_render::technique::depth_absorption::EntryPoint;
use glam::Vec3;
use std::path::PathBuf;
use std::sync::Arc;

/// Absorption over the distance that a depth map tells.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Technique depth-absorption (Green 2004, section 16.3)")]
pub struct DepthAbsorptionArgs {
    /// Extinction of each channel on the way through the body [1/mm, 0 or above, default: one over the distance that the
    /// material spreads light by]
    #[arg(long, value_name = "R,G,B", allow_hyphen_values = true, value_parser = colour)]
    pub sigma_t: Option<Vec3>,
    /// Colour for each distance through the body, in place of an extinction, as gradient stops "MM:R,G,B; MM:R,G,B; ...", such
    /// as "0:1,0.9,0.8; 4:0.5,0.1,0.05; 20:0,0,0" [mm, growing from 0; linear, 0 or above]
    #[arg(long, value_name = "STOPS", conflicts_with = "sigma_t", value_parser = stops)]
    pub absorption_ramp: Option<Arc<ColourRamp>>,
    /// The same from a picture, whose middle row is the ramp, from no distance on the left to --absorption-ramp-length on the
    /// right
    #[arg(long, value_name = "FILE", conflicts_with_all = ["sigma_t", "absorption_ramp"], requires = "absorption_ramp_length")]
    pub absorption_ramp_image: Option<PathBuf>,
    /// Distance at the right end of that picture [mm, above 0]
    #[arg(long, value_name = "MM", allow_negative_numbers = true, requires = "absorption_ramp_image")]
    pub absorption_ramp_length: Option<f32>,
    /// How far the body is grown along its normals in the depth map, against the background at its edges [mm, 0 to 1000,
    /// default 0.5]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub growth: Option<f32>,
    /// What is known of the place where light enters: its distance, or its normal and colour, too [default: surface]
    #[arg(long, value_name = "NAME", value_parser = one_of(&EntryPoint::ALL))]
    pub entry: Option<EntryPoint>,
    /// Places on the light's side that are looked at for a point, so that features of the back show through less [1 to 64,
    /// default 8]
    #[arg(long, value_name = "N")]
    pub depth_samples: Option<u32>,
    /// Radius of the disc that these are spread over [mm, 0 to 1000, default 1]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub depth_filter_radius: Option<f32>,
    /// Surfaces along the light's way that are told apart; 1: all behind the nearest is flesh, as in the paper [1 to 16,
    /// default 1]
    #[arg(long, value_name = "N")]
    pub depth_layers: Option<u32>,
}
