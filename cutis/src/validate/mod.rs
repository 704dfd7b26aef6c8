//! `cutis validate`: every technique in small scenes, judged by the truth that is kept of them.
//!
//! The story of a run: words become a [`job::Job`]; each scene is made, its truth [`stored`] read (or rendered anew), each
//! entry drawn as `cutis compare` does, its [`errors`] measured and held to their [`bounds`]; all of it is a [`report`].

mod bounds;
mod errors;
mod job;
mod pictures;
mod report;
mod stored;

use crate::backend::Backend;
use crate::cli::ValidateArgs;
use crate::compare::drawn::Drawn;
use crate::compare::entry::Entry;
use crate::job::refused;
use crate::{Outcome, talk, whole_file};
use bounds::{Bounds, worse};
use cutis_scene::Scene;
use cutis_scene::validation::ValidationScene;
use errors::Errors;
use job::{Job, SIZE};
use miette::{IntoDiagnostic, Result, miette};
use report::{EntryReport, Report, SceneReport};
use std::time::Instant;
use stored::Truth;

/// Runs the command.
pub fn run(args: &ValidateArgs, verbose: u8) -> Result<Outcome> {
    let start = Instant::now();
    let job = Job::new(args)?;
    let mut bounds = Bounds::read(&job.folder)?;
    let mut report = empty_report(&job);
    let (there, missing): (Vec<_>, Vec<_>) =
        job.scenes.iter().map(|scene| (scene, scene.missing())).partition(|(_, why)| why.is_none());
    report.skipped =
        missing.into_iter().map(|(s, why)| format!("{}: {}", s.name, why.unwrap_or_default())).collect();
    for (scene, _) in there {
        let judged = judge(&job, *scene, &mut bounds, &mut report.warnings, verbose)?;
        report.scenes.push(judged);
    }
    let complaints = report.complaints();
    report.passed = complaints.is_empty();
    report.wall_seconds = start.elapsed().as_secs_f64();
    if args.json {
        talk::say(&serde_json::to_string_pretty(&report).into_diagnostic()?)?;
    } else {
        let text = if args.table { report.table() } else { report.text() };
        talk::say(text.trim_end())?;
    }
    report.warnings.iter().for_each(|warning| talk::tell(&format!("warning: {warning}")));
    report.skipped.iter().for_each(|why| talk::tell(&format!("skipped: {why}")));
    complaints.iter().for_each(|words| talk::tell(&format!("worse than its bound: {words}")));
    Ok(if report.passed { Outcome::Done } else { Outcome::CheckFailed })
}

fn empty_report(job: &Job) -> Report {
    Report {
        version: env!("CARGO_PKG_VERSION"),
        truth: job.folder.display().to_string(),
        width: SIZE,
        height: SIZE,
        scenes: Vec::new(),
        skipped: Vec::new(),
        passed: true,
        warnings: Vec::new(),
        wall_seconds: 0.0,
    }
}

/// A scene by all entries; its truth and its bounds are made anew where that is asked for.
fn judge(
    job: &Job,
    validation: ValidationScene,
    bounds: &mut Bounds,
    warnings: &mut Vec<String>,
    verbose: u8,
) -> Result<SceneReport> {
    let name = validation.name;
    let make = || validation.make().map_err(refused);
    let (scene, truth) = if job.update {
        let scene = make()?;
        Truth::render(job, name, &scene, verbose)?;
        (scene, Truth::read(&job.folder, name)?)
    } else {
        // Read before the scene is made: what is damaged is told at once.
        let truth = Truth::read(&job.folder, name)?;
        (make()?, truth)
    };
    let unmeasured = |error| miette!("{name}: {error}");
    let truth_noise = truth.noise().map_err(unmeasured)?;
    let mut entries = Vec::new();
    for entry in &job.entries {
        let mut judged = judge_entry(job, name, entry, &scene, &truth, warnings, verbose)?;
        // Bounds are for the usual numbers.
        if job.accept && entry.flags.is_empty() {
            bounds.accept(name, &judged.name, &judged.errors);
        }
        judged.bound = bounds.get(name, &judged.name).copied();
        judged.worse = judged.bound.map_or(Vec::new(), |b| worse(&judged.errors, &b, &judged.spread));
        entries.push(judged);
    }
    if job.accept {
        let text = bounds.text()?;
        whole_file::write_all(&[(Bounds::path(&job.folder).as_path(), text.as_bytes())])?;
    }
    Ok(SceneReport { name, question: validation.question, truth_noise, entries })
}

fn judge_entry(
    job: &Job,
    name: &str,
    entry: &Entry,
    scene: &Scene,
    truth: &Truth,
    warnings: &mut Vec<String>,
    verbose: u8,
) -> Result<EntryReport> {
    let words = format!("{name}, {entry}: ");
    let drawn = Drawn::by(Backend::Cpu, entry.clone(), &job.settings(entry), scene, &words, verbose)?;
    // Scenes share their medium, and with it most of what is worth knowing.
    for warning in &drawn.warnings {
        if !warnings.contains(warning) {
            warnings.push(warning.clone());
        }
    }
    // A technique that does not tell its specular part apart is judged as if it drew none.
    let seen = drawn.diffuse.as_ref().unwrap_or(&drawn.picture);
    if let Some(folder) = &job.pictures {
        pictures::write(folder, name, &entry.to_string(), seen, truth)?;
    }
    let failed = |error| miette!("{name}, {entry}: {error}");
    Ok(EntryReport {
        name: entry.to_string(),
        errors: Errors::of(seen, truth).map_err(failed)?,
        spread: Errors::spread(seen, truth).map_err(failed)?,
        bound: None,
        worse: Vec::new(),
        milliseconds: drawn.milliseconds,
    })
}
