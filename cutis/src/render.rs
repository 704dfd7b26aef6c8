//! `cutis render`: reads the scene, draws it, develops it, writes it and says where it is.

use crate::cli::RenderArgs;
use crate::job::Job;
use crate::machine::choose_threads;
use crate::progress::Bar;
use crate::report::Report;
use crate::{Outcome, talk};
use cutis_render::film::{self, Film, Written};
use cutis_render::passes::seams::DiffusionReport;
use cutis_render::{Aov, Frame, PassTime, Renderer};
use cutis_scene::Scene;
use miette::{IntoDiagnostic, Result, miette};
use std::time::Instant;

/// Runs the command.
pub fn run(args: &RenderArgs, verbose: u8) -> Result<Outcome> {
    let start = Instant::now();
    let job = Job::new(args)?;
    choose_threads(job.threads)?;
    let (scene, reading) = timed("read", || job.source.load().map_err(|error| miette!("{error}")))?;
    let (renderer, frame) = draw(&scene, &job, verbose)?;
    let film = Film { exposure_ev: job.film.exposure_ev + scene.camera.exposure_ev, ..job.film };
    let (written, writing) = timed("write", || {
        film::write(&job.output, job.format, &frame, &film).map_err(|error| miette!("{error}"))
    })?;

    let warnings = warnings(&job, &scene, &frame, &written);
    let passes = passes(reading, &frame, &written, writing);
    if job.json {
        let report = Report::new(
            &job,
            renderer.as_ref(),
            &written,
            &frame.diffusion_reports,
            &passes,
            &warnings,
            start.elapsed(),
        );
        talk::say(&serde_json::to_string_pretty(&report).into_diagnostic()?)?;
    } else {
        talk::say(&written.picture.display().to_string())?;
        frame.diffusion_reports.iter().try_for_each(say_report)?;
    }
    warnings.iter().for_each(|warning| talk::tell(&format!("warning: {warning}")));
    tell_layers(&written);
    Ok(if written.broken_pixels == 0 { Outcome::Done } else { Outcome::CheckFailed })
}

/// What the diffusion did to energy and seams, and what texels it had.
fn say_report(report: &DiffusionReport) -> Result<()> {
    talk::say(&format!(
        "{}: energy {:.0} -> {:.0} W/m² mm² ({:+.3} %), {} seam edges, mismatch mean {:.2} %, 99th percentile {:.2} %; \
         texels are {:.2} to {:.2} mm wide under all but 1 % of the surface at either end, alike they would be {:.2} mm",
        report.object,
        report.energy_before_w_per_m2_mm2,
        report.energy_after_w_per_m2_mm2,
        100.0 * report.energy_change,
        report.seam_edges,
        100.0 * report.seam_error_mean,
        100.0 * report.seam_error_p99,
        report.texels.narrowest_mm,
        report.texels.widest_mm,
        report.texels.even_mm,
    ))
}

/// The picture, and who has drawn it in the end.
fn draw(scene: &Scene, job: &Job, verbose: u8) -> Result<(Box<dyn Renderer>, Frame)> {
    let mut renderer = job.backend.renderer(job.settings.technique, scene)?;
    loop {
        tracing::info!("backend {}, {}", renderer.backend(), renderer.adapter());
        let bar = Bar::new(verbose);
        let frame = renderer.render(scene, &job.settings, &bar);
        bar.finish();
        match frame {
            Ok(frame) => return Ok((renderer, frame)),
            Err(error) => {
                let instead = job.backend.instead(renderer.as_ref(), &error);
                renderer = instead.ok_or_else(|| miette!("{error}"))?;
            }
        }
    }
}

fn timed<T>(name: &str, work: impl FnOnce() -> Result<T>) -> Result<(T, PassTime)> {
    let start = Instant::now();
    let value = work()?;
    Ok((value, PassTime { name: name.to_owned(), time: start.elapsed() }))
}

/// All passes of the run. The film's are part of the writing, which is told without them.
fn passes(reading: PassTime, frame: &Frame, written: &Written, mut writing: PassTime) -> Vec<PassTime> {
    let film = written.passes.iter().map(|pass| pass.time).sum();
    writing.time = writing.time.saturating_sub(film);
    let drawn = frame.passes.iter().chain(&written.passes).cloned();
    std::iter::once(reading).chain(drawn).chain([writing]).collect()
}

/// Everything worth knowing, each once.
fn warnings(job: &Job, scene: &Scene, frame: &Frame, written: &Written) -> Vec<String> {
    let broken = (written.broken_pixels > 0).then(|| {
        format!("{} pixels hold no finite number: a fault of cutis worth reporting", written.broken_pixels)
    });
    let missing = missing_layers(job, frame);
    let mut all: Vec<String> = Vec::new();
    let told = job.warnings.iter().chain(&scene.warnings).chain(&frame.warnings);
    for warning in told.chain(&missing).chain(&broken) {
        if !all.contains(warning) {
            all.push(warning.clone());
        }
    }
    all
}

/// Layers that were wished for and are not there: some exist only in the picture, some only with enough Gaussians.
fn missing_layers(job: &Job, frame: &Frame) -> Vec<String> {
    let names = job.settings.aovs.iter().map(Aov::to_string);
    let missing = names.filter(|name| frame.layers.iter().all(|layer| layer.name != *name));
    missing.map(|name| format!("there is no layer '{name}' of this material in this --aov-space")).collect()
}

/// Says where layers beside the picture went, and what their black and white mean.
fn tell_layers(written: &Written) {
    for layer in &written.layers {
        if let Some([black, white]) = layer.black_and_white {
            talk::tell(&format!("{}: black is {black}, white is {white}", layer.path.display()));
        }
    }
}
