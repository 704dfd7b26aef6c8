//! What was found, as one JSON object and as a table.

use super::Compared;
use super::drawn::Drawn;
use super::job::Job;
use super::judged::{Noise, Part};
use crate::measure::{Measured, MeasuredReport};
use crate::techniques::report::TechniqueReport;
use serde::Serialize;
use std::fmt::Write;
use std::time::Duration;

/// The object; units are in the names.
#[derive(Debug, Serialize)]
pub struct Report {
    pub version: &'static str,
    pub scene: String,
    pub width: u32,
    pub height: u32,
    pub seed: u64,
    pub irradiance_size: u32,
    pub pixels_per_degree: f64,
    pub threads: usize,
    pub reference: String,
    pub reference_noise: Option<Noise>,
    /// End of the scale of the luminance maps, as a part of the reference.
    pub luminance_scale: f64,
    pub techniques: Vec<Row>,
    pub output: String,
    pub csv: Option<String>,
    pub warnings: Vec<String>,
    pub wall_seconds: f64,
}

/// One technique.
#[derive(Debug, Serialize)]
pub struct Row {
    pub name: String,
    pub technique: String,
    pub diffusion: String,
    /// Numbers that the technique has of its own; null if it has none.
    pub technique_settings: Option<TechniqueReport>,
    pub backend: String,
    pub adapter: String,
    pub is_reference: bool,
    pub samples_per_pixel: u32,
    pub milliseconds: f64,
    pub passes: Vec<Pass>,
    pub peak_memory_mib: Option<f64>,
    /// Nothing for the reference itself.
    pub parts: Vec<PartReport>,
}

#[derive(Debug, Serialize)]
pub struct Pass {
    pub name: String,
    pub milliseconds: f64,
}

/// The numbers of a part of the light.
#[derive(Debug, Serialize)]
pub struct PartReport {
    pub part: Part,
    #[serde(flatten)]
    pub measured: MeasuredReport,
}

impl Report {
    pub fn new(job: &Job, compared: &Compared, warnings: Vec<String>, wall_time: Duration) -> Self {
        let rows = compared.drawn.iter().zip(&compared.judged).enumerate();
        let is_reference = |i| i == job.reference;
        Self {
            version: env!("CARGO_PKG_VERSION"),
            scene: compared.scene_name.clone(),
            width: job.settings.width,
            height: job.settings.height,
            seed: job.settings.seed,
            irradiance_size: job.settings.irradiance_size,
            pixels_per_degree: job.pixels_per_degree,
            threads: rayon::current_num_threads(),
            reference: job.entries[job.reference].to_string(),
            reference_noise: compared.noise.clone(),
            luminance_scale: compared.luminance_scale,
            techniques: rows.map(|(i, (drawn, judged))| Row::new(drawn, judged, is_reference(i))).collect(),
            output: job.output.display().to_string(),
            csv: job.csv.as_ref().map(|path| path.display().to_string()),
            warnings,
            wall_seconds: wall_time.as_secs_f64(),
        }
    }

    /// For people, on stdout.
    pub fn text(&self) -> String {
        let mut text = format!("{}\n{:<28}{:<14}", self.output, "technique", "part");
        text.push_str("      RMSE  relative MSE  FLIP LDR  FLIP HDR  milliseconds\n");
        for row in &self.techniques {
            if row.is_reference {
                // Writing to a String cannot fail.
                let _ = writeln!(text, "{:<28}{:<56}{:>12.0}", row.name, "reference", row.milliseconds);
            }
            for PartReport { part, measured } in &row.parts {
                let hdr = measured.flip_hdr.as_ref().map_or(f64::NAN, |hdr| hdr.mean);
                let _ = writeln!(
                    text,
                    "{:<28}{:<14}{:>10.5}{:>14.5}{:>10.4}{:>10.4}{:>14.0}",
                    row.name,
                    part.words(),
                    measured.rmse,
                    measured.relative_mse,
                    measured.flip_ldr.mean,
                    hdr,
                    row.milliseconds,
                );
            }
        }
        text
    }
}

impl Row {
    fn new(drawn: &Drawn, judged: &[(Part, Measured)], is_reference: bool) -> Self {
        let pass = |pass: &cutis_render::PassTime| Pass {
            name: pass.name.clone(),
            milliseconds: pass.time.as_secs_f64() * 1e3,
        };
        let part = |(part, measured): &(Part, Measured)| PartReport {
            part: *part,
            measured: MeasuredReport::new(measured),
        };
        Self {
            name: drawn.entry.to_string(),
            technique: drawn.entry.technique.to_string(),
            diffusion: drawn.entry.diffusion.to_string(),
            technique_settings: TechniqueReport::of(drawn.entry.technique, &drawn.techniques),
            backend: drawn.backend.clone(),
            adapter: drawn.adapter.clone(),
            is_reference,
            samples_per_pixel: drawn.samples_per_pixel,
            milliseconds: drawn.milliseconds,
            passes: drawn.passes.iter().map(pass).collect(),
            peak_memory_mib: drawn.peak_memory_mib,
            parts: judged.iter().map(part).collect(),
        }
    }
}
