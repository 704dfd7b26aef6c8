//! Arguments of `cutis profile`.

use clap::Args;
use cutis_optics::fit::GAUSSIANS_MAX;
use cutis_optics::{FitMethod, ProfileSource};
use cutis_render::Settings;
use std::path::PathBuf;

/// Names of the ways to fit.
pub const METHODS: [(&str, FitMethod); 4] = [
    ("optimal", FitMethod::Optimal),
    ("energy", FitMethod::Energy),
    ("fast", FitMethod::Fast),
    ("powers", FitMethod::Powers),
];

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
    /// Model of the light [default: dipole for one half-space, multipole for layers; monte-carlo is simulated]
    #[arg(long, value_name = "NAME", value_parser = super::names(ProfileSource::ALL))]
    pub source: Option<String>,
    /// Gaussians in each sum [1 to 16, default 6; a preset that is a kernel comes as it is]
    #[arg(long, value_name = "K")]
    pub gaussians: Option<usize>,
    /// How the sums are found: optimal has the least error and loses some energy, energy keeps the total; fast (four
    /// Gaussians for every pole, for the dipole) and powers (multiples of one variance, for dipole and multipole) are formulas. The joint
    /// kernel of three channels always keeps energy
    #[arg(long, value_name = "METHOD", default_value = "energy", value_parser = super::names(METHODS.map(|(name, _)| name)))]
    pub fit: String,
    /// Bound the variances to what a chain of seven-tap blurs can make: the first at most the squared mean free path, each
    /// at most four times the one before; for optimal and energy
    #[arg(long)]
    pub seven_tap: bool,
    /// Standard deviation of the beam that lights the profile [mm, above 0; default: a point, and a twentieth of a transport
    /// mean free path for better-dipole, beam and monte-carlo, which go as 1/r towards a point]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub beam: Option<f64>,
    /// Beckmann roughness of the surface, which holds less light back than a smooth one, by Schlick's approximation of Fresnel's equations; for dipole and multipole
    /// [0 to 1]
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    pub roughness: Option<f32>,
    /// Photon packets of the source monte-carlo, for each channel [2048 to 10^12]
    #[arg(long, value_name = "N", default_value_t = 1_000_000)]
    pub photons: u64,
    /// Seed of the source monte-carlo: the same seed gives the same numbers [0 to 2^64 - 1]
    #[arg(long, value_name = "N", default_value_t = Settings::default().seed)]
    pub seed: u64,
    /// Threads to work with [1 to 1024, default: one per processor]
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
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
