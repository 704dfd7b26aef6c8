//! One channel of a material: its profile, and the sum of Gaussians for it.

use super::job::Job;
use super::material::Substance;
use super::source::{self, Sourced};
use crate::cli::METHODS;
use cutis_optics::{
    BoxedProfile, DiffusionValidity, Dipole, Fit, FitMethod, GaussianSum, ProfileSource, Stack, TissueLayer,
    WorstError, fit, fit_with, worst_absolute_error,
};
use miette::{Result, miette};
use std::time::Instant;

/// Share of the light that the rings of a simulation may miss without a word.
const MISSED_LIGHT: f64 = 1e-3;

/// Names of the channels, as `--channel` takes them.
pub const CHANNEL_NAMES: [&str; 3] = ["r", "g", "b"];

/// A channel, computed.
pub struct Channel {
    /// `r`, `g` or `b`; none where all are the same.
    pub name: Option<&'static str>,
    /// Which model made it; none for a kernel that was given.
    pub source: Option<ProfileSource>,
    pub layers: Vec<TissueLayer>,
    pub profile: BoxedProfile,
    /// What comes out below; none of endless layers and kernels.
    pub transmitted: Option<BoxedProfile>,
    /// Standard deviation of the beam it is seen under, mm; none for a point.
    pub beam_standard_deviation_mm: Option<f64>,
    /// What chance may have done to the total, where it was simulated.
    pub total_standard_error: Option<f64>,
    /// Light that left beyond the rings of a simulation, of what entered.
    pub light_beyond_rings: f64,
    pub worst: WorstError,
    pub sum: ChannelFit,
    pub wall_seconds: f64,
}

/// A sum of Gaussians and how it came about.
pub enum ChannelFit {
    /// Fitted to the profile.
    Fitted(Fit),
    /// The profile *is* this sum.
    Given(GaussianSum),
}

impl ChannelFit {
    pub fn sum(&self) -> &GaussianSum {
        match self {
            Self::Fitted(fit) => &fit.sum,
            Self::Given(sum) => sum,
        }
    }

    pub fn method(&self) -> &'static str {
        match self {
            Self::Fitted(fit) => method_name(fit.method),
            Self::Given(_) => "given",
        }
    }

    /// Relative RMS power error; none is left by a sum that is the profile.
    pub fn error(&self) -> f64 {
        match self {
            Self::Fitted(fit) => fit.relative_rms_power_error,
            Self::Given(_) => 0.0,
        }
    }
}

/// Name of a method, as `--fit` takes it.
pub fn method_name(method: FitMethod) -> &'static str {
    METHODS.iter().find(|(_, known)| *known == method).map_or("", |(name, _)| name)
}

/// The channels that are asked for: one, or red, green and blue.
pub fn compute(job: &Job) -> Result<Vec<Channel>> {
    let all: Vec<usize> = job.channel.map_or_else(|| vec![0, 1, 2], |c| vec![c]);
    match &job.material.substance {
        Substance::Grey(layers) => Ok(vec![of_layers(job, job.channel, layers)?]),
        Substance::Coloured(channels) => all.iter().map(|&c| of_layers(job, Some(c), &channels[c])).collect(),
        Substance::Kernel(kernel) => all.iter().map(|&c| of_kernel(job, c, kernel.channel(c))).collect(),
    }
}

fn of_layers(job: &Job, channel: Option<usize>, layers: &[TissueLayer]) -> Result<Channel> {
    let start = Instant::now();
    let source = job.source.unwrap_or_else(|| ProfileSource::default_for(layers));
    let Sourced {
        profile,
        transmitted,
        beam_standard_deviation_mm,
        total_standard_error,
        light_beyond_rings,
    } = source::of_layers(job, source, layers).map_err(|error| in_channel(channel, &error))?;
    let settings = job.fit_settings(layers);
    let fitted = fit_with(&*profile, &settings).map_err(|error| in_channel(channel, &error))?;
    let wall_seconds = start.elapsed().as_secs_f64();
    let worst = worst_absolute_error(&*profile, &fitted.sum).map_err(|error| in_channel(channel, &error))?;
    Ok(Channel {
        name: channel.map(|c| CHANNEL_NAMES[c]),
        source: Some(source),
        layers: layers.to_vec(),
        profile,
        transmitted,
        beam_standard_deviation_mm,
        total_standard_error,
        light_beyond_rings,
        worst,
        sum: ChannelFit::Fitted(fitted),
        wall_seconds,
    })
}

fn of_kernel(job: &Job, channel: usize, kernel: GaussianSum) -> Result<Channel> {
    let start = Instant::now();
    let sum = if job.gaussians_were_given && job.gaussians < kernel.terms.len() {
        let fitted = fit(&kernel, job.gaussians, job.method);
        ChannelFit::Fitted(fitted.map_err(|error| in_channel(Some(channel), &error))?)
    } else {
        ChannelFit::Given(kernel.clone())
    };
    let worst =
        worst_absolute_error(&kernel, sum.sum()).map_err(|error| in_channel(Some(channel), &error))?;
    Ok(Channel {
        name: Some(CHANNEL_NAMES[channel]),
        source: None,
        layers: Vec::new(),
        profile: Box::new(kernel),
        transmitted: None,
        beam_standard_deviation_mm: None,
        total_standard_error: None,
        light_beyond_rings: 0.0,
        worst,
        sum,
        wall_seconds: start.elapsed().as_secs_f64(),
    })
}

fn in_channel(channel: Option<usize>, reason: &dyn std::fmt::Display) -> miette::Report {
    match channel {
        Some(c) => miette!("channel {}: {reason}", CHANNEL_NAMES[c]),
        None => miette!("{reason}"),
    }
}

impl Channel {
    /// `sources` of reports and tables: the model, or that there is none.
    pub fn source_name(&self) -> String {
        self.source.map_or_else(|| "kernel".to_owned(), |source| source.to_string())
    }

    /// Length of the finest detail, mm: the transport mean free path of the top layer; of a kernel the standard deviation
    /// of its narrowest Gaussian.
    pub fn mean_free_path_mm(&self) -> f64 {
        let narrowest = || self.sum.sum().terms.first().map_or(1.0, |g| g.variance_mm2.sqrt());
        self.layers.first().map_or_else(narrowest, |layer| layer.medium.transport_mean_free_path_mm())
    }

    /// T_d: 0 of endless layers; none of a kernel, which does not know.
    pub fn total_transmittance(&self) -> Option<f64> {
        let known = !self.layers.is_empty();
        known.then(|| self.transmitted.as_ref().map_or(0.0, |transmitted| transmitted.total()))
    }

    /// For each layer whether diffusion holds in it.
    pub fn validity(&self) -> Vec<DiffusionValidity> {
        let of = |layer: &TissueLayer| Dipole::new(&layer.medium).ok().map(|dipole| dipole.validity());
        self.layers.iter().filter_map(of).collect()
    }

    /// Warnings: more light than came, light that the rings of a simulation missed, and each layer where classical
    /// diffusion is asked for and does not hold.
    pub fn warnings(&self) -> Vec<String> {
        let channel = self.name.map_or_else(String::new, |name| format!("channel {name}, "));
        let total = self.profile.total();
        if self.source == Some(ProfileSource::MonteCarlo) {
            let missed = self.light_beyond_rings > MISSED_LIGHT * total;
            return missed
                .then(|| {
                    format!(
                        "{channel}{:.6} of the light leaves beyond the rings and is not in the profile",
                        self.light_beyond_rings
                    )
                })
                .into_iter()
                .collect();
        }
        if !matches!(self.source, Some(ProfileSource::Dipole | ProfileSource::Multipole)) {
            let gains = total > 1.0;
            return gains
                .then(|| format!("{channel}the source gives back {total:.4} of the light, more than it got; take dipole or monte-carlo instead"))
                .into_iter()
                .collect();
        }
        let numbered = self.validity().into_iter().enumerate().filter(|(_, validity)| !validity.is_good());
        let weak = numbered.map(|(i, validity)| format!("{channel}layer {}: {validity}", i + 1));
        let thin = Stack::in_air(&self.layers).map(|stack| stack.too_thin()).unwrap_or_default();
        weak.chain(thin.into_iter().map(|(layer, thin)| format!("{channel}layer {layer}: {thin}"))).collect()
    }
}
