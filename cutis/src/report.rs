//! The result of `cutis render` as one JSON object.

use crate::job::Job;
use crate::machine::peak_memory_mib;
use crate::techniques::report::TechniqueReport;
use cutis_render::film::{LayerFile, Written};
use cutis_render::passes::seams::DiffusionReport;
use cutis_render::{PassTime, Renderer};
use serde::Serialize;
use std::time::Duration;

/// The object; units are in the names.
#[derive(Debug, Serialize)]
pub struct Report {
    version: &'static str,
    technique: String,
    /// Numbers that the technique has of its own; null if it has none.
    technique_settings: Option<TechniqueReport>,
    /// The paper whose numbers were the defaults.
    as_in: Option<String>,
    diffusion: String,
    backend: String,
    adapter: String,
    width: u32,
    height: u32,
    /// Preset in place of the materials of the scene.
    material: Option<String>,
    /// Length to which the scene was scaled.
    longest_side_mm: Option<f32>,
    /// How long moving light has moved.
    time_s: f32,
    samples_per_pixel: u32,
    seed: u64,
    passes: Vec<Pass>,
    wall_seconds: f64,
    output: String,
    format: String,
    layers: Vec<LayerReport>,
    diffusion_reports: Vec<DiffusionReport>,
    warnings: Vec<String>,
    peak_memory_mib: Option<f64>,
}

#[derive(Debug, Serialize)]
struct Pass {
    name: String,
    milliseconds: f64,
}

#[derive(Debug, Serialize)]
struct LayerReport {
    name: String,
    output: String,
    /// Values shown as black and as white; null where the file holds the values themselves.
    black_and_white: Option<[f32; 2]>,
}

impl Report {
    /// Puts together what is known at the end of a run.
    pub fn new(
        job: &Job,
        renderer: &dyn Renderer,
        written: &Written,
        diffusion_reports: &[DiffusionReport],
        passes: &[PassTime],
        warnings: &[String],
        wall_time: Duration,
    ) -> Self {
        let settings = &job.settings;
        Self {
            diffusion_reports: diffusion_reports.to_vec(),
            version: env!("CARGO_PKG_VERSION"),
            technique: settings.technique.to_string(),
            technique_settings: TechniqueReport::of(settings.technique, &settings.techniques),
            as_in: job.paper.map(|paper| paper.to_string()),
            diffusion: settings.diffusion.to_string(),
            backend: renderer.backend().to_owned(),
            adapter: renderer.adapter(),
            width: settings.width,
            height: settings.height,
            material: job.source.material.clone(),
            longest_side_mm: job.source.longest_side_mm,
            time_s: job.source.time_s,
            samples_per_pixel: settings.samples_per_pixel,
            seed: settings.seed,
            passes: passes.iter().map(Pass::new).collect(),
            wall_seconds: wall_time.as_secs_f64(),
            output: written.picture.display().to_string(),
            format: job.format.to_string(),
            layers: written.layers.iter().map(LayerReport::new).collect(),
            warnings: warnings.to_vec(),
            peak_memory_mib: peak_memory_mib(),
        }
    }
}

impl Pass {
    fn new(pass: &PassTime) -> Self {
        Self { name: pass.name.clone(), milliseconds: pass.time.as_secs_f64() * 1e3 }
    }
}

impl LayerReport {
    fn new(layer: &LayerFile) -> Self {
        let output = layer.path.display().to_string();
        Self { name: layer.name.clone(), output, black_and_white: layer.black_and_white }
    }
}
