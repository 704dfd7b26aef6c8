//! The arguments of `cutis profile`, checked.

use super::channel::CHANNEL_NAMES;
use super::export::Export;
use super::material::{Material, Substance};
use super::plot::PlotFile;
use crate::cli::{METHODS, ProfileArgs};
use crate::job::in_range;
use crate::simulate::photons_in_range;
use crate::whole_file;
use cutis_optics::{FitMethod, FitSettings, ProfileSource, TissueLayer};
use miette::{Result, bail, miette};
use std::path::{Path, PathBuf};

/// What is to be done.
pub struct Job {
    pub material: Material,
    /// Which channel alone.
    pub channel: Option<usize>,
    /// Which model, unless the one that fits the layers.
    pub source: Option<ProfileSource>,
    pub gaussians: usize,
    pub gaussians_were_given: bool,
    pub method: FitMethod,
    pub seven_tap: bool,
    /// Standard deviation of the beam, unless the usual one.
    pub beam_mm: Option<f64>,
    /// Beckmann roughness of a surface that is not smooth.
    pub roughness: Option<f32>,
    pub photons: u64,
    pub seed: u64,
    pub verbose: u8,
    pub exports: Vec<Export>,
    pub plot: Option<PlotFile>,
    pub explain: bool,
    pub json: bool,
}

impl Job {
    /// Checks everything that can be checked before the work.
    pub fn new(args: &ProfileArgs, verbose: u8) -> Result<Self> {
        let material = Material::from_args(args)?;
        check_wavelength(args, &material)?;
        check_numbers(args)?;
        let gaussians =
            in_range("--gaussians", args.gaussians_or_default(), 1..=ProfileArgs::GAUSSIANS_MAX, "1 to 16")?;
        let source = args.source.as_ref().map(|name| name.parse::<ProfileSource>()).transpose();
        let source = source.map_err(|error| miette!("--source: {error}"))?;
        if matches!(material.substance, Substance::Kernel(_)) {
            refuse_for_kernel(args, &material)?;
        }
        let channel = args.channel.as_deref().and_then(|name| CHANNEL_NAMES.iter().position(|c| *c == name));
        let method =
            METHODS.iter().find(|(name, _)| *name == args.fit).map_or(FitMethod::Energy, |(_, m)| *m);
        if args.seven_tap && !matches!(method, FitMethod::Optimal | FitMethod::Energy) {
            bail!("--fit {} takes its variances from formulas: --seven-tap has nothing to bound", args.fit);
        }
        let exports = Export::all(args)?;
        let coloured = !matches!(material.substance, Substance::Grey(_));
        if coloured && channel.is_some() && exports.iter().any(Export::is_translation) {
            bail!("a material for another renderer needs all three channels: leave --channel out");
        }
        let plot = args.plot.as_deref().map(PlotFile::new).transpose()?;
        let outputs: Vec<&Path> = args.plot.iter().chain(&args.export).map(PathBuf::as_path).collect();
        outputs.iter().try_for_each(|path| whole_file::check(path))?;
        whole_file::check_distinct(&outputs)?;
        Ok(Self {
            material,
            channel,
            source,
            gaussians,
            gaussians_were_given: args.gaussians.is_some(),
            method,
            seven_tap: args.seven_tap,
            beam_mm: args.beam,
            roughness: args.roughness,
            photons: args.photons,
            seed: args.seed,
            verbose,
            exports,
            plot,
            explain: args.explain,
            json: args.json,
        })
    }

    /// What a fit for these layers is to be.
    pub fn fit_settings(&self, layers: &[TissueLayer]) -> FitSettings {
        let shortest =
            || layers.iter().map(|l| l.medium.transport_mean_free_path_mm()).fold(f64::INFINITY, f64::min);
        FitSettings {
            gaussians: self.gaussians,
            method: self.method,
            seven_tap_mm: self.seven_tap.then(shortest),
        }
    }
}

/// A finished kernel has no layers that these could be about.
fn refuse_for_kernel(args: &ProfileArgs, material: &Material) -> Result<()> {
    let given = [
        ("--source", args.source.is_some()),
        ("--beam", args.beam.is_some()),
        ("--roughness", args.roughness.is_some()),
        ("--seven-tap", args.seven_tap),
    ];
    match given.into_iter().find(|(_, given)| *given) {
        Some((flag, _)) => Err(miette!(
            "{} is a finished kernel without layers: {flag} has nothing to work on",
            material.name
        )),
        None => Ok(()),
    }
}

fn check_numbers(args: &ProfileArgs) -> Result<()> {
    photons_in_range(args.photons)?;
    if let Some(mm) = args.beam.filter(|mm| !(*mm > 0.0 && mm.is_finite())) {
        bail!("--beam must be above 0 mm, got {mm}");
    }
    if let Some(m) = args.roughness.filter(|m| !(0.0..=1.0).contains(m)) {
        bail!("--roughness must be 0 to 1, got {m}");
    }
    Ok(())
}

fn check_wavelength(args: &ProfileArgs, material: &Material) -> Result<()> {
    match args.wavelength {
        Some(nm) if !(nm > 0.0 && nm.is_finite()) => {
            Err(miette!("--wavelength must be above 0 nm, got {nm}"))
        }
        Some(_) => Err(miette!(
            help = "give --channel r, g or b, or coefficients of that wavelength by --layer",
            "{} has no spectra: it knows red, green and blue, or one channel, but no wavelengths",
            material.name
        )),
        None => Ok(()),
    }
}
