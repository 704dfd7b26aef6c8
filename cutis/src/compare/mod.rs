//! `cutis compare`: a scene by every technique, each beside a reference, as one page to look at.
//!
//! The story of a run: words become a [`job::Job`]; each entry is [`drawn`], then [`judged`] by the reference; what was
//! found becomes a [`report`], a [`csv`] table and a [`html`] page.

mod csv;
pub mod drawn;
pub mod entry;
mod html;
mod job;
mod judged;
mod report;

use crate::cli::CompareArgs;
use crate::job::refused;
use crate::machine::choose_threads;
use crate::measure::Measured;
use crate::{Outcome, talk, whole_file};
use cutis_scene::Scene;
use drawn::Drawn;
use job::Job;
use judged::{Noise, Part, judge, luminance_scale};
use miette::{IntoDiagnostic, Result};
use report::Report;
use std::time::Instant;

/// Everything rendered and measured.
pub struct Compared {
    /// The scene's file, or what it is.
    scene_name: String,
    drawn: Vec<Drawn>,
    /// For each of them its parts against the reference's; none for the reference itself.
    judged: Vec<Vec<(Part, Measured)>>,
    /// What chance may have done to the reference.
    noise: Option<Noise>,
    /// End of the scale of the luminance maps, as a part of the reference.
    luminance_scale: f64,
}

/// Runs the command.
pub fn run(args: &CompareArgs, verbose: u8) -> Result<Outcome> {
    let start = Instant::now();
    let job = Job::new(args)?;
    choose_threads(job.threads)?;
    tracing::info!("read");
    let scene = job.source.load().map_err(refused)?;
    let compared = Compared::new(&job, &scene, verbose)?;
    let (figures, missing) = html::figures(&scene);
    let warnings = warnings(&job, &scene, &compared, missing);
    let report = Report::new(&job, &compared, warnings, start.elapsed());
    let page = html::page(&report, &compared, &figures)?;
    let table = csv::table(&report);
    let table = job.csv.as_deref().map(|path| (path, table.as_bytes()));
    let files: Vec<_> = [(job.output.as_path(), page.as_bytes())].into_iter().chain(table).collect();
    whole_file::write_all(&files)?;
    if job.json {
        talk::say(&serde_json::to_string_pretty(&report).into_diagnostic()?)?;
    } else {
        talk::say(report.text().trim_end())?;
    }
    report.warnings.iter().for_each(|warning| talk::tell(&format!("warning: {warning}")));
    Ok(Outcome::Done)
}

impl Compared {
    fn new(job: &Job, scene: &Scene, verbose: u8) -> Result<Self> {
        let drawn = (0..job.entries.len()).map(|i| Drawn::new(job, i, scene, verbose));
        let drawn = drawn.collect::<Result<Vec<_>>>()?;
        let reference = &drawn[job.reference];
        tracing::info!("measure");
        let judged = drawn.iter().enumerate().map(|(i, test)| {
            let is_reference = i == job.reference;
            if is_reference { Ok(Vec::new()) } else { judge(test, reference, job.pixels_per_degree) }
        });
        let judged = judged.collect::<Result<Vec<_>>>()?;
        let noise = Noise::of(reference);
        let luminance_scale = luminance_scale(judged.iter().flatten().map(|(_, measured)| measured));
        let file = job.source.file.as_ref();
        let scene_name = file.map_or_else(|| "built-in head".to_owned(), |path| path.display().to_string());
        Ok(Self { scene_name, drawn, judged, noise, luminance_scale })
    }
}

/// Everything worth knowing, each once.
fn warnings(job: &Job, scene: &Scene, compared: &Compared, missing: Vec<String>) -> Vec<String> {
    let alone = (compared.drawn.len() == 1).then(|| {
        format!("{} is alone: there is nothing to compare it with; see --techniques", job.entries[0])
    });
    let of_drawn = compared.drawn.iter().flat_map(|drawn| drawn.warnings.iter().cloned());
    let mut all: Vec<String> = Vec::new();
    let told = job.warnings.iter().chain(&scene.warnings).cloned().chain(of_drawn).chain(alone);
    for warning in told.chain(noisy(job, compared)).chain(missing) {
        if !all.contains(&warning) {
            all.push(warning);
        }
    }
    all
}

/// Entries that are nearer to the reference than its own noise allows to tell.
fn noisy(job: &Job, compared: &Compared) -> Vec<String> {
    let Some(noise) = &compared.noise else { return Vec::new() };
    let parts =
        job.entries.iter().zip(&compared.judged).flat_map(|(e, parts)| parts.iter().map(move |p| (e, p)));
    let close = parts
        .filter(|(_, (part, measured))| *part == Part::Picture && !noise.can_judge(measured.numbers.rmse));
    close
        .map(|(entry, (_, measured))| {
            format!(
                "{entry}: RMSE {:.5} is not far above the noise of the reference, {:.5} W/(m² sr); give it more samples \
                 with --reference-samples",
                measured.numbers.rmse, noise.rms_w_per_m2_sr
            )
        })
        .collect()
}
