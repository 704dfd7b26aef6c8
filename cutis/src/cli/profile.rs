//! Arguments of `cutis profile`.

use clap::Args;
use cutis_optics::ProfileSource;
use cutis_optics::fit::GAUSSIANS_MAX;
use cutis_render::Settings;
use std::path::PathBuf;

/// Arguments of `cutis profile`.
#[derive(Debug, Args)]
pub struct ProfileArgs {
    /// A preset by name, or a .toml file with [[layer]] entries; left out where --layer is given
    pub material: Option<String>,
    /// A layer, top first; may be given several times: "mu_a=..,mu_s=..,g=..,n=..,d=.." [mu_a, mu_s: 1/mm; d: mm, inf for
    /// the last; without g 0, without n 1, without d inf]
    #[arg(long, value_name = "LAYER", conflicts_with = "material")]
    pub layer: Vec<String>,
    /// One channel only [default: all three of a coloured material]
    #[arg(long, value_name = "CHANNEL", value_parser = super::names(["r", "g", "b"]))]
    pub channel: Option<String>,
    /// Wavelength, for materials with spectra [nm]; no material has them yet
    #[arg(long, value_name = "NM", conflicts_with = "channel", allow_negative_numbers = true)]
    pub wavelength: Option<f64>,
    /// Model of the light [default: dipole for one half-space, multipole for layers]
    #[arg(long, value_name = "NAME", value_parser = super::names(ProfileSource::ALL))]
    pub source: Option<String>,
    /// Gaussians in each sum [1 to 16, default 6; a preset that is a kernel comes as it is]
    #[arg(long, value_name = "K")]
    pub gaussians: Option<usize>,
    /// What the sums keep: optimal has the least error and loses some energy, energy keeps the total
    #[arg(long, value_name = "METHOD", default_value = "energy", value_parser = super::names(["optimal", "energy"]))]
    pub fit: String,
    /// Print one JSON object on stdout, and nothing else
    #[arg(long)]
    pub json: bool,
    /// Draw profile, fit, residual and spectrum: .svg or .png
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Write the kernel, or the material for another renderer; may be given several times. By extension: .json .csv .wgsl
    /// .glsl .hlsl; .mtlx for OpenPBR, .gltf for glTF
    #[arg(long, value_name = "FILE")]
    pub export: Vec<PathBuf>,
    /// What the files hold, whatever their extension: one for each --export, in the same order
    #[arg(long, value_name = "FORMAT", value_parser = super::names(crate::profile::format_names()))]
    pub export_as: Vec<String>,
    /// Use an extension of glTF that is a draft
    #[arg(long, value_name = "NAME", num_args = 0..=1, require_equals = true, default_missing_value = "volume-scatter", value_parser = super::names(["volume-scatter", "scatter"]))]
    pub drafts: Option<String>,
    /// Tell totals, lengths, whether the model holds here, and how many Gaussians give which error
    #[arg(long)]
    pub explain: bool,
}

impl ProfileArgs {
    /// Gaussians in each sum: as many as a renderer uses, unless told otherwise.
    pub fn gaussians_or_default(&self) -> usize {
        self.gaussians.unwrap_or(Settings::default().gaussians)
    }

    /// Most Gaussians.
    pub const GAUSSIANS_MAX: usize = GAUSSIANS_MAX;
}
