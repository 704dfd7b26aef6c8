//! `--explain`: the numbers behind a profile, whether to believe them, and what more Gaussians would buy.

use super::Profiled;
use super::channel::Channel;
use super::job::Job;
use cutis_optics::{DiffusionValidity, FitSettings, Medium, ProfileSource, Stack, TooThin, Trust, fit_with};
use miette::{Result, miette};
use serde::Serialize;

/// Numbers of Gaussians that are tried.
const TRIED: std::ops::RangeInclusive<usize> = 1..=8;

/// The sources that are formulas.
const DIFFUSION_SOURCES: [ProfileSource; 4] =
    [ProfileSource::Dipole, ProfileSource::BetterDipole, ProfileSource::Multipole, ProfileSource::Beam];

/// A channel, explained.
#[derive(Serialize)]
pub struct Explanation {
    pub total_diffuse_reflectance: f64,
    /// 0 for a half-space; null for a kernel, which does not know.
    pub total_transmittance: Option<f64>,
    /// Which formula to believe for these layers.
    pub sources: Vec<Trust>,
    pub layers: Vec<LayerExplanation>,
    pub fits: Vec<Trial>,
}

/// Lengths of a layer, and whether diffusion holds in it.
#[derive(Serialize)]
pub struct LayerExplanation {
    pub albedo_reduced: f64,
    /// 1/sigma_t': from one scattering to the next, phase function reduced.
    pub transport_mean_free_path_mm: f64,
    /// 1/sigma_tr: how far diffused light gets; null without absorption.
    pub diffuse_mean_free_path_mm: Option<f64>,
    pub diffusion_holds: bool,
    pub verdict: String,
}

/// What a number of Gaussians leaves.
#[derive(Serialize)]
pub struct Trial {
    pub gaussians: usize,
    pub relative_rms_power_error: f64,
    pub energy: f64,
}

/// An explanation for each channel.
pub fn all(profiled: &Profiled, job: &Job) -> Result<Vec<Explanation>> {
    profiled.channels.iter().map(|channel| explanation(channel, job)).collect()
}

fn explanation(channel: &Channel, job: &Job) -> Result<Explanation> {
    let stack = Stack::in_air(&channel.layers).ok();
    let thin = stack.as_ref().map(Stack::too_thin).unwrap_or_default();
    let thin = |number: usize| thin.iter().find(|(layer, _)| *layer == number).map(|(_, thin)| *thin);
    let media = channel.layers.iter().map(|layer| &layer.medium).enumerate();
    Ok(Explanation {
        total_diffuse_reflectance: channel.profile.total(),
        total_transmittance: channel.total_transmittance(),
        sources: DIFFUSION_SOURCES
            .iter()
            .filter(|_| !channel.layers.is_empty())
            .map(|source| source.trust(&channel.layers))
            .collect(),
        layers: media.zip(channel.validity()).map(|((i, medium), v)| layer(medium, v, thin(i + 1))).collect(),
        fits: TRIED.map(|gaussians| trial(channel, gaussians, job)).collect::<Result<_>>()?,
    })
}

fn layer(medium: &Medium, validity: DiffusionValidity, thin: Option<TooThin>) -> LayerExplanation {
    let diffuse_mm = medium.diffuse_mean_free_path_mm();
    LayerExplanation {
        albedo_reduced: medium.albedo_reduced(),
        transport_mean_free_path_mm: medium.transport_mean_free_path_mm(),
        diffuse_mean_free_path_mm: diffuse_mm.is_finite().then_some(diffuse_mm),
        diffusion_holds: validity.is_good() && thin.is_none(),
        verdict: thin.map_or_else(|| validity.to_string(), |thin| thin.to_string()),
    }
}

fn trial(channel: &Channel, gaussians: usize, job: &Job) -> Result<Trial> {
    let settings = FitSettings { gaussians, ..job.fit_settings(&channel.layers) };
    let fit =
        fit_with(&*channel.profile, &settings).map_err(|error| miette!("{gaussians} Gaussians: {error}"))?;
    Ok(Trial { gaussians, relative_rms_power_error: fit.relative_rms_power_error, energy: fit.energy })
}
