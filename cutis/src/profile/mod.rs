//! `cutis profile`: diffusion profiles, their sums of Gaussians, plots of them, and files for others.

mod channel;
mod explain;
mod export;
mod job;
mod layer_file;
mod material;
mod of_scene;
mod plot;
mod radial;
mod report;
mod source;
mod text;

use crate::cli::ProfileArgs;
use crate::job::threads_in_range;
use crate::machine::choose_threads;
use crate::{Outcome, talk, whole_file};
use channel::{Channel, ChannelFit};
use cutis_optics::export::KernelTable;
use cutis_optics::translate::Translation;
use cutis_optics::{RgbFit, RgbGaussianSum, fit_joint};
pub use export::format_names;
use job::Job;
use material::Material;
use miette::{IntoDiagnostic, Result, miette};
pub use of_scene::figure_svg;
use report::Report;
use std::time::Instant;

/// Everything computed.
pub struct Profiled<'a> {
    material: &'a Material,
    /// One, or red, green and blue.
    channels: Vec<Channel>,
    /// One kernel for the three channels, where there are three that had to be fitted.
    joint: Option<RgbFit>,
}

/// Computes, writes, prints.
pub fn run(args: &ProfileArgs, verbose: u8) -> Result<Outcome> {
    let start = Instant::now();
    let job = Job::new(args, verbose)?;
    choose_threads(threads_in_range(args.threads)?)?;
    let profiled = Profiled::new(&job)?;
    profiled.channels.iter().flat_map(Channel::warnings).for_each(|warning| tracing::warn!("{warning}"));
    let translations = write_files(&profiled, &job)?;
    let explanations = if job.explain { Some(explain::all(&profiled, &job)?) } else { None };
    let report = Report::new(&profiled, explanations, translations, start.elapsed().as_secs_f64());
    if job.json {
        talk::say(&report.json().into_diagnostic()?)?;
    } else {
        talk::say(text::text(&report).trim_end())?;
    }
    Ok(Outcome::Done)
}

/// Plot and exports, all or none; what was translated is given back.
fn write_files(profiled: &Profiled, job: &Job) -> Result<Vec<Translation>> {
    let exports = job.exports.iter().map(|e| e.render(profiled)).collect::<Result<Vec<_>>>()?;
    let plot = match &job.plot {
        Some(plot) => Some((plot.path.as_path(), plot.render(profiled)?)),
        None => None,
    };
    let plot = plot.iter().map(|(path, bytes)| (*path, bytes.as_slice()));
    let texts = job.exports.iter().zip(&exports).map(|(e, (text, _))| (e.path.as_path(), text.as_bytes()));
    whole_file::write_all(&plot.chain(texts).collect::<Vec<_>>())?;
    Ok(exports.into_iter().filter_map(|(_, translation)| translation).collect())
}

impl<'a> Profiled<'a> {
    fn new(job: &'a Job) -> Result<Self> {
        let channels = channel::compute(job)?;
        let joint = joint_fit(&channels, job)?;
        Ok(Self { material: &job.material, channels, joint })
    }

    /// The kernel of three channels; a single one stands for all.
    fn kernel(&self) -> RgbGaussianSum {
        if let Some(fit) = &self.joint {
            return fit.kernel.clone();
        }
        let of = |c: usize| self.channels[c.min(self.channels.len() - 1)].sum.sum().clone();
        RgbGaussianSum::from_channels(&[of(0), of(1), of(2)])
    }

    /// The kernel as a table, with its energy and error.
    fn table(&self) -> KernelTable {
        let source = format!("{}, {}", self.channels[0].source_name(), self.material.origin);
        let name = &self.material.name;
        match (&self.joint, self.channels.as_slice()) {
            (Some(fit), _) => KernelTable::from_rgb_fit(name, &source, fit),
            (None, [only]) => {
                let name = only.name.map_or_else(|| name.clone(), |c| format!("{name}, channel {c}"));
                match &only.sum {
                    ChannelFit::Fitted(fit) => KernelTable::from_fit(&name, &source, fit),
                    ChannelFit::Given(sum) => KernelTable::single(&name, &source, sum),
                }
            }
            (None, _) => KernelTable::rgb(name, &source, &self.kernel()),
        }
    }
}

/// Three channels over shared variances, unless they are a kernel that shares them already.
fn joint_fit(channels: &[Channel], job: &Job) -> Result<Option<RgbFit>> {
    let [red, green, blue] = channels else { return Ok(None) };
    if channels.iter().all(|channel| matches!(channel.sum, ChannelFit::Given(_))) {
        return Ok(None);
    }
    let profiles = [&*red.profile as _, &*green.profile as _, &*blue.profile as _];
    let layers = channels.iter().flat_map(|channel| channel.layers.iter().copied()).collect::<Vec<_>>();
    let seven_tap_mm = job.fit_settings(&layers).seven_tap_mm;
    let joint = fit_joint(&profiles, job.gaussians, seven_tap_mm);
    joint.map(|fit| Some(RgbFit::from_joint(&fit))).map_err(|error| miette!("joint kernel: {error}"))
}
