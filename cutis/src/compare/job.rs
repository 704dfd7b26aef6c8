//! The arguments of `cutis compare`, checked.

use super::entry::{Entry, entries_of};
use crate::backend::Backend;
use crate::cli::CompareArgs;
use crate::job::{must_exist, named, refused, size, threads_in_range};
use crate::measure::pixels_per_degree_in_range;
use crate::scene_source::SceneSource;
use crate::techniques::{Wish, fulfilled, wishes};
use crate::whole_file;
use cutis_render::settings::TechniqueSettings;
use cutis_render::{Aov, Settings, TechniqueName};
use cutis_scene::ReadOptions;
use cutis_scene::head::HeadDetail;
use miette::{Result, bail, miette};
use std::path::{Path, PathBuf};

/// Samples per pixel of a reference that is estimated by chance, if nothing else is asked.
const ESTIMATED_SAMPLES: u32 = 256;

/// The technique that is the reference wherever there is one of that name.
const TRUTH: &str = "truth";

/// What is to be done.
pub struct Job {
    pub source: SceneSource,
    /// What is rendered; each once.
    pub entries: Vec<Entry>,
    /// Which of them the others are judged by.
    pub reference: usize,
    /// Settings of all entries; technique and diffusion come from the entry.
    pub settings: Settings,
    /// Numbers of the technique of each entry.
    pub techniques: Vec<TechniqueSettings>,
    /// Where it is computed.
    pub backend: Backend,
    /// Wishes that have no effect, in words.
    pub warnings: Vec<String>,
    /// Samples per pixel of the reference.
    pub reference_samples: u32,
    pub pixels_per_degree: f64,
    pub threads: Option<usize>,
    pub output: PathBuf,
    pub csv: Option<PathBuf>,
    pub json: bool,
}

impl Job {
    /// Checks everything that can be checked before the work.
    pub fn new(args: &CompareArgs) -> Result<Self> {
        let (entries, reference) = entries(args)?;
        check_output(&args.output, &["html", "htm"])?;
        args.csv.as_deref().map_or(Ok(()), |csv| check_output(csv, &["csv"]))?;
        let outputs: Vec<&Path> = [args.output.as_path()].into_iter().chain(args.csv.as_deref()).collect();
        whole_file::check_distinct(&outputs)?;
        args.scene.as_deref().map_or(Ok(()), must_exist)?;
        let settings = settings(args)?;
        let mut warnings = Vec::new();
        let techniques = techniques(args, &entries, &mut warnings)?;
        let backend = named("--backend", &args.backend, Backend::ALL.map(|b| (b.to_string(), b)))?;
        let reference_samples = args.reference_samples.unwrap_or_else(|| {
            let is_estimated = entries[reference].technique.is_estimated();
            if is_estimated { ESTIMATED_SAMPLES } else { args.samples }
        });
        Settings { samples_per_pixel: reference_samples, ..settings.clone() }.check().map_err(refused)?;
        Ok(Self {
            source: SceneSource {
                file: args.scene.clone(),
                options: ReadOptions::default(),
                environment: None,
                detail: HeadDetail::default(),
                material: None,
                longest_side_mm: None,
                time_s: 0.0,
            },
            entries,
            reference,
            settings,
            techniques,
            backend,
            warnings,
            reference_samples,
            pixels_per_degree: pixels_per_degree_in_range(args.pixels_per_degree)?,
            threads: threads_in_range(args.threads)?,
            output: args.output.clone(),
            csv: args.csv.clone(),
            json: args.json,
        })
    }

    /// Settings of one entry.
    pub fn settings_of(&self, index: usize) -> Settings {
        let Entry { technique, diffusion, .. } = self.entries[index];
        let techniques = self.techniques[index].clone();
        let is_reference = index == self.reference;
        let samples_per_pixel =
            if is_reference { self.reference_samples } else { self.settings.samples_per_pixel };
        let mut settings =
            Settings { technique, techniques, diffusion, samples_per_pixel, ..self.settings.clone() };
        if is_reference && technique.is_estimated() {
            settings.aovs.push(Aov::StandardError);
        }
        settings
    }
}

/// What is rendered, each once, and which of them is the reference.
fn entries(args: &CompareArgs) -> Result<(Vec<Entry>, usize)> {
    let mut entries: Vec<Entry> = Vec::new();
    for words in args.techniques.iter().flat_map(|list| entries_of(list)) {
        let entry = words.parse().map_err(|reason: String| miette!("--techniques: {reason}"))?;
        if !entries.contains(&entry) {
            entries.push(entry);
        }
    }
    if entries.is_empty() {
        entries = TechniqueName::ALL.iter().copied().map(Entry::usual).collect();
    }
    let reference = reference(args)?.unwrap_or_else(|| entries[0].clone());
    let index = entries.iter().position(|entry| *entry == reference).unwrap_or_else(|| {
        entries.push(reference);
        entries.len() - 1
    });
    Ok((entries, index))
}

/// The reference that was named, or the truth where it is known.
fn reference(args: &CompareArgs) -> Result<Option<Entry>> {
    match &args.reference {
        Some(words) => words.parse().map(Some).map_err(|reason: String| miette!("--reference: {reason}")),
        None => Ok(TRUTH.parse().ok()),
    }
}

/// Numbers of the technique of each entry: its own, else those of the flags.
fn techniques(
    args: &CompareArgs,
    entries: &[Entry],
    warnings: &mut Vec<String>,
) -> Result<Vec<TechniqueSettings>> {
    let wishes = wishes(&args.own, warnings)?;
    let is_idle = |wish: &&Wish| entries.iter().all(|entry| entry.technique != wish.technique);
    for Wish { flag, technique, .. } in wishes.iter().filter(is_idle) {
        warnings.push(format!("{flag} has no effect: {technique} is not among the techniques"));
    }
    let of_flags = fulfilled(TechniqueSettings::default(), wishes)?;
    let of_entry =
        |entry: &Entry| entry.techniques(of_flags.clone()).map_err(|why| miette!("{entry}: {why}"));
    entries.iter().map(of_entry).collect()
}

fn settings(args: &CompareArgs) -> Result<Settings> {
    let (width, height) = size(&args.size)?;
    let settings = Settings {
        width,
        height,
        samples_per_pixel: args.samples,
        irradiance_size: args.irradiance_size,
        seed: args.seed,
        close_holes: args.close_holes,
        // Without the light that the surface itself reflects, what is left came from below it.
        aovs: vec![Aov::Specular],
        ..Settings::default()
    };
    settings.check().map_err(refused)?;
    Ok(settings)
}

/// Refuses an extension that says something else, so that no scene is overwritten by its own report.
fn check_output(path: &Path, extensions: &[&str]) -> Result<()> {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    if !extensions.contains(&extension.as_str()) {
        bail!("{}: this file is written as .{}", path.display(), extensions[0]);
    }
    whole_file::check(path)
}
