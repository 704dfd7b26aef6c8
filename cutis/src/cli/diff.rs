//! The words of `cutis diff`.

use clap::Args;
use cutis_render::difference::DEFAULT_PIXELS_PER_DEGREE;
use std::path::PathBuf;

/// Arguments of `cutis diff`.
#[derive(Debug, Args)]
pub struct DiffArgs {
    /// Picture to judge: .png or .jpg (as a screen shows it), .exr or .hdr (linear light)
    pub picture: PathBuf,
    /// Picture to judge it by, of the same size and kind
    pub reference: PathBuf,
    /// Layer to compare instead of the picture; EXR files only
    #[arg(long, value_name = "NAME")]
    pub layer: Option<String>,
    /// Sharpness of the view, for FLIP [pixels per degree of the visual angle, 1 to 1000]
    #[arg(long, value_name = "N", default_value_t = DEFAULT_PIXELS_PER_DEGREE, allow_negative_numbers = true)]
    pub pixels_per_degree: f64,
    /// Write FLIP's error of each pixel in the colours of magma: .png
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// End with code 1 if the mean FLIP is above this (HDR-FLIP for linear light, otherwise LDR-FLIP) [0 to 1]
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub fail_above: Option<f64>,
    /// Print one JSON object on stdout, and nothing else
    #[arg(long)]
    pub json: bool,
}
