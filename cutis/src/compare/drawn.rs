//! An entry, rendered.

use super::entry::Entry;
use super::job::Job;
use crate::backend::Backend;
use crate::machine::{forget_peak_memory, peak_memory_mib};
use crate::measure::Seen;
use crate::progress::Bar;
use cutis_render::settings::TechniqueSettings;
use cutis_render::{Aov, Layer, PassTime, Settings};
use cutis_scene::Scene;
use glam::Vec4;
use miette::{Result, miette};
use std::time::Instant;

/// Name of the layer that holds the standard error of each pixel of a simulated picture, W/(m² sr).
const STANDARD_ERROR: &str = "standard-error";

/// A picture with what it took.
pub struct Drawn {
    pub entry: Entry,
    /// What drew it.
    pub backend: String,
    /// The machine that did.
    pub adapter: String,
    /// Numbers of its technique.
    pub techniques: TechniqueSettings,
    pub samples_per_pixel: u32,
    /// The whole picture.
    pub picture: Seen,
    /// Without what the surface itself reflects, where the technique tells that apart.
    pub diffuse: Option<Seen>,
    /// Standard error of each pixel, W/(m² sr), where the technique knows it.
    pub standard_errors: Option<Vec<Vec4>>,
    /// All passes together.
    pub milliseconds: f64,
    pub passes: Vec<PassTime>,
    /// Most memory the program held meanwhile, MiB, where the system tells.
    pub peak_memory_mib: Option<f64>,
    pub warnings: Vec<String>,
}

impl Drawn {
    /// Renders an entry of the job.
    pub fn new(job: &Job, index: usize, scene: &Scene, verbose: u8) -> Result<Self> {
        let entry = job.entries[index].clone();
        let name = format!("{} of {}, {entry}: ", index + 1, job.entries.len());
        Self::by(job.backend, entry, &job.settings_of(index), scene, &name, verbose)
    }

    /// Renders a scene by an entry, whose technique and diffusion are in the settings; the name is for the progress.
    pub fn by(
        backend: Backend,
        entry: Entry,
        settings: &Settings,
        scene: &Scene,
        name: &str,
        verbose: u8,
    ) -> Result<Self> {
        tracing::info!("{}", name.trim_end_matches([':', ' ']));
        let renderer = backend.renderer_that_knows(settings.technique, scene)?;
        let counts_alone = forget_peak_memory();
        let (start, bar) = (Instant::now(), Bar::named(name, verbose));
        let frame = renderer.render(scene, settings, &bar);
        bar.finish();
        let milliseconds = start.elapsed().as_secs_f64() * 1e3;
        let frame = frame.map_err(|error| miette!("{entry}: {error}"))?;
        let (width, height, ev) = (frame.width, frame.height, scene.camera.exposure_ev);
        let layer = |name: &str| {
            let fits = |l: &&Layer| l.name == name && l.pixels.len() == frame.pixels.len();
            frame.layers.iter().find(fits)
        };
        let diffuse = layer(&Aov::Specular.to_string()).map(|specular| {
            let rest = frame.pixels.iter().zip(&specular.pixels).map(|(p, s)| without(*p, *s)).collect();
            Seen::developed(width, height, rest, ev)
        });
        let standard_errors = layer(STANDARD_ERROR).map(|layer| layer.pixels.clone());
        Ok(Self {
            entry,
            backend: renderer.backend().to_owned(),
            adapter: renderer.adapter(),
            techniques: settings.techniques.clone(),
            samples_per_pixel: settings.samples_per_pixel,
            diffuse,
            standard_errors,
            milliseconds,
            passes: frame.passes,
            peak_memory_mib: peak_memory_mib().filter(|_| counts_alone),
            warnings: frame.warnings,
            picture: Seen::developed(width, height, frame.pixels, ev),
        })
    }
}

/// The colour without a part of it; coverage stays.
fn without(pixel: Vec4, part: Vec4) -> Vec4 {
    (pixel.truncate() - part.truncate()).extend(pixel.w)
}
