//! The words of `cutis compare`.

use super::{TechniqueArgs, default_size, names};
use crate::backend::Backend;
use clap::Args;
use cutis_render::Settings;
use cutis_render::difference::DEFAULT_PIXELS_PER_DEGREE;
use std::path::PathBuf;

/// Arguments of `cutis compare`.
#[derive(Debug, Args)]
pub struct CompareArgs {
    /// Scene to render: .toml, .glb, .gltf or .obj; left out: the built-in head
    pub scene: Option<PathBuf>,
    /// What to compare: TECHNIQUE, TECHNIQUE/DIFFUSION or TECHNIQUE:FLAG=VALUE, such as
    /// texture-space,texture-space/none,image-space:profile-samples=64:jacobian=off; may be given several times [default:
    /// every technique]
    #[arg(long, value_name = "A,B,...")]
    pub techniques: Vec<String>,
    /// The one that the others are judged by; rendered too if it is not among them [default: truth if this build has it,
    /// otherwise the first]
    #[arg(long, value_name = "NAME")]
    pub reference: Option<String>,
    /// Where it is computed; what graphics adapters do not draw is drawn by the processor
    #[arg(long, value_name = "NAME", default_value_t = Backend::Cpu.to_string(), value_parser = names(Backend::ALL))]
    pub backend: String,
    /// Page to write: one .html file that needs no other
    #[arg(short, long, value_name = "FILE", default_value = "report.html")]
    pub output: PathBuf,
    /// Write the numbers as a table, too: .csv
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Print one JSON object on stdout, and nothing else
    #[arg(long)]
    pub json: bool,
    /// Width and height of the pictures [pixels, 1x1 to 16384x16384]
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value_t = default_size())]
    pub size: String,
    /// Samples per pixel, rounded up to a square number [1 to 4096]
    #[arg(long, value_name = "N", default_value_t = Settings::default().samples_per_pixel)]
    pub samples: u32,
    /// Samples per pixel of the reference [1 to 1048576, default: 256 paths of truth, as many as of the others for what is
    /// not left to chance]
    #[arg(long, value_name = "N")]
    pub reference_samples: Option<u32>,
    /// Cap the holes of open bodies, for truth, which needs closed ones
    #[arg(long)]
    pub close_holes: bool,
    /// Seed of every random choice: the same seed gives the same pictures [0 to 2^64 - 1]
    #[arg(long, value_name = "N", default_value_t = Settings::default().seed)]
    pub seed: u64,
    /// Width and height of the largest object's irradiance texture, rounded up to a multiple of 8 [texels, 16 to 16384]
    #[arg(long, value_name = "N", default_value_t = Settings::default().irradiance_size)]
    pub irradiance_size: u32,
    /// Threads to work with [1 to 1024, default: one per processor]
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
    /// Sharpness of the view, for FLIP [pixels per degree of the visual angle, 1 to 1000]
    #[arg(long, value_name = "N", default_value_t = DEFAULT_PIXELS_PER_DEGREE, allow_negative_numbers = true)]
    pub pixels_per_degree: f64,
    /// Of all entries that do not say it themselves.
    #[command(flatten)]
    pub own: TechniqueArgs,
}
