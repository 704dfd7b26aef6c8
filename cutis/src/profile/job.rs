//! The arguments of `cutis profile`, checked.

use super::channel::CHANNEL_NAMES;
use super::export::Export;
use super::material::{Material, Substance};
use super::plot::PlotFile;
use crate::cli::ProfileArgs;
use crate::job::in_range;
use crate::whole_file;
use cutis_optics::{FitMethod, ProfileSource};
use miette::{Result, bail, miette};

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
    pub exports: Vec<Export>,
    pub plot: Option<PlotFile>,
    pub explain: bool,
    pub json: bool,
}

impl Job {
    /// Checks everything that can be checked before the work.
    pub fn new(args: &ProfileArgs) -> Result<Self> {
        let material = Material::from_args(args)?;
        check_wavelength(args, &material)?;
        let gaussians =
            in_range("--gaussians", args.gaussians_or_default(), 1..=ProfileArgs::GAUSSIANS_MAX, "1 to 16")?;
        let source = args.source.as_ref().map(|name| name.parse::<ProfileSource>()).transpose();
        let source = source.map_err(|error| miette!("--source: {error}"))?;
        if source.is_some() && matches!(material.substance, Substance::Kernel(_)) {
            bail!(
                "{} is a finished kernel without layers: --source has nothing to compute it from",
                material.name
            );
        }
        let channel = args.channel.as_deref().and_then(|name| CHANNEL_NAMES.iter().position(|c| *c == name));
        let exports = Export::all(args)?;
        let coloured = !matches!(material.substance, Substance::Grey(_));
        if coloured && channel.is_some() && exports.iter().any(Export::is_translation) {
            bail!("a material for another renderer needs all three channels: leave --channel out");
        }
        let plot = args.plot.as_deref().map(PlotFile::new).transpose()?;
        args.plot.iter().chain(&args.export).try_for_each(|path| whole_file::check(path))?;
        Ok(Self {
            material,
            channel,
            source,
            gaussians,
            gaussians_were_given: args.gaussians.is_some(),
            method: if args.fit == "optimal" { FitMethod::Optimal } else { FitMethod::Energy },
            exports,
            plot,
            explain: args.explain,
            json: args.json,
        })
    }
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
