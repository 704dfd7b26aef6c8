//! `cutis simulate`: Monte Carlo of light in layered slabs.

use crate::cli::SimulateArgs;
use crate::job::{in_range, threads_in_range};
use crate::layer_words::parse_layer;
use crate::machine::choose_threads;
use crate::progress::Bar;
use crate::{Outcome, talk};
use cutis_optics::simulate::{BATCH, Estimate, Estimates, Grid, Layer, LayeredSlab, Rings, Simulation};
use cutis_render::Progress;
use miette::{IntoDiagnostic, bail, miette};
use rayon::prelude::*;
use serde::Serialize;
use std::fmt::Write;
use std::time::Instant;

/// Batches between two looks at the progress bar.
const BATCHES_PER_ROUND: u64 = 256;
/// Rings around the beam, unless told otherwise.
const RINGS: usize = 200;
/// Width of a ring, in transport mean free paths of the first layer that scatters, unless told otherwise.
const RING_MEAN_FREE_PATHS: f64 = 0.05;
/// Sheets of equal height that absorption is counted in.
const SHEETS: usize = 100;
/// Bins of the cosine.
const COSINES: usize = 20;

/// Everything, for `--json`.
#[derive(Serialize)]
struct Report {
    version: &'static str,
    layers: Vec<LayerReport>,
    photons: u64,
    seed: u64,
    threads: usize,
    specular_reflectance: f64,
    specular_reflectance_standard_error: f64,
    diffuse_reflectance: f64,
    diffuse_reflectance_standard_error: f64,
    transmittance: f64,
    transmittance_standard_error: f64,
    absorbed_fraction: f64,
    absorbed_fraction_standard_error: f64,
    absorbed_by_layer: Vec<Estimate>,
    radial_profile: Radial,
    reflectance_by_cosine: Vec<Estimate>,
    transmittance_by_cosine: Vec<Estimate>,
    depth_step_mm: f64,
    absorbed_by_depth: Vec<Estimate>,
    photons_per_second: f64,
    wall_seconds: f64,
}

/// A layer; infinite thickness is null.
#[derive(Serialize)]
struct LayerReport {
    sigma_a_per_mm: f64,
    sigma_s_per_mm: f64,
    g: f64,
    refractive_index: f64,
    thickness_mm: Option<f64>,
}

#[derive(Serialize)]
struct Radial {
    r_mm: Vec<f64>,
    reflectance_per_mm2: Vec<f64>,
    reflectance_per_mm2_standard_error: Vec<f64>,
    transmittance_per_mm2: Vec<f64>,
    transmittance_per_mm2_standard_error: Vec<f64>,
}

/// Simulates and prints.
pub fn run(args: &SimulateArgs, verbose: u8) -> miette::Result<Outcome> {
    let simulation = simulation(args)?;
    choose_threads(threads_in_range(args.threads)?)?;
    let start = Instant::now();
    let bar = Bar::new(verbose);
    let estimates = in_parallel(&simulation, args.photons, &bar);
    bar.finish();
    let seconds = start.elapsed().as_secs_f64();
    let report = Report::new(&simulation, &estimates, seconds, rayon::current_num_threads());
    if args.json {
        talk::say(&serde_json::to_string_pretty(&report).into_diagnostic()?)?;
    } else {
        talk::say(report.text().trim_end())?;
    }
    Ok(Outcome::Done)
}

/// The arguments, checked.
fn simulation(args: &SimulateArgs) -> miette::Result<Simulation> {
    photons_in_range(args.photons)?;
    in_range("--rings", args.rings, 1..=100_000, "1 to 100000")?;
    let layers = args.layer.iter().map(|words| parse_layer(words)).collect::<miette::Result<Vec<Layer>>>()?;
    let width_mm = ring_width_mm(&layers);
    let slab = LayeredSlab::in_air(layers).map_err(|error| miette!("{error}"))?;
    ends(&slab)?;
    let radial_step_mm = args.ring_width.unwrap_or(width_mm);
    if !(radial_step_mm > 0.0 && radial_step_mm.is_finite()) {
        bail!("--ring-width must be above 0 mm, got {radial_step_mm}");
    }
    let finite_mm: f64 = slab.layers().iter().map(|l| l.thickness_mm).filter(|d| d.is_finite()).sum();
    let endless = slab.layers().iter().any(|l| l.thickness_mm.is_infinite());
    // Below the finite layers of a half-space, as deep again as the rings reach.
    let depth_mm = finite_mm + if endless { radial_step_mm * args.rings as f64 } else { 0.0 };
    let grid = Grid {
        rings: Rings::even(radial_step_mm, args.rings)
            .map_err(|error| miette!("--ring-width, --rings: {error}"))?,
        depth_step_mm: depth_mm / SHEETS as f64,
        depth_bins: SHEETS,
        cosine_bins: COSINES,
    };
    Ok(Simulation { slab, grid, seed: args.seed })
}

/// Refuses layers in which light would walk for ever.
pub fn ends(slab: &LayeredSlab) -> miette::Result<()> {
    let number = slab.layers().len();
    let last = &slab.layers()[number - 1];
    if last.thickness_mm.is_infinite() && last.sigma_a_per_mm == 0.0 && last.sigma_s_per_mm > 0.0 {
        bail!(
            "layer {number} scatters without end and absorbs nothing: light would walk in it for ever; give it a thickness or some absorption"
        );
    }
    Ok(())
}

/// Checks `--photons`.
pub fn photons_in_range(photons: u64) -> miette::Result<()> {
    if !(2 * BATCH..=1_000_000_000_000).contains(&photons) {
        bail!("--photons must be {} to 10^12, got {photons}", 2 * BATCH);
    }
    Ok(())
}

/// Rings unless told otherwise.
pub fn default_rings() -> usize {
    RINGS
}

fn ring_width_mm(layers: &[Layer]) -> f64 {
    let scattering = layers.iter().find(|l| l.sigma_s_per_mm > 0.0);
    scattering.map_or(0.1, |l| RING_MEAN_FREE_PATHS / (l.sigma_a_per_mm + l.sigma_s_per_mm * (1.0 - l.g)))
}

/// Batches on all threads, added up in their order, so that the number of threads changes nothing.
pub fn in_parallel(simulation: &Simulation, photons: u64, bar: &Bar) -> Estimates {
    let mut estimates = Estimates::new(&simulation.grid, simulation.slab.layers().len());
    let batches = photons.div_ceil(BATCH);
    bar.begin("simulate", photons);
    for round in (0..batches).step_by(BATCHES_PER_ROUND as usize) {
        let numbers = round..(round + BATCHES_PER_ROUND).min(batches);
        let tallies: Vec<_> = numbers
            .into_par_iter()
            .map(|b| {
                let count = BATCH.min(photons - b * BATCH);
                let tally = simulation.batch(b * BATCH, count);
                bar.advance(count);
                tally
            })
            .collect();
        tallies.iter().for_each(|tally| estimates.add(tally));
    }
    estimates
}

impl Report {
    fn new(simulation: &Simulation, estimates: &Estimates, seconds: f64, threads: usize) -> Self {
        let split = |values: Vec<Estimate>| -> (Vec<f64>, Vec<f64>) {
            values.iter().map(|e| (e.value, e.standard_error)).unzip()
        };
        let (reflectance_per_mm2, reflectance_error) = split(estimates.reflectance_per_mm2());
        let (transmittance_per_mm2, transmittance_error) = split(estimates.transmittance_per_mm2());
        let (reflectance, transmittance) = (estimates.diffuse_reflectance(), estimates.transmittance());
        let absorbed = estimates.absorbed();
        Self {
            version: env!("CARGO_PKG_VERSION"),
            layers: simulation.slab.layers().iter().map(LayerReport::new).collect(),
            photons: estimates.packets(),
            seed: simulation.seed,
            threads,
            specular_reflectance: estimates.specular_reflectance(),
            specular_reflectance_standard_error: 0.0,
            diffuse_reflectance: reflectance.value,
            diffuse_reflectance_standard_error: reflectance.standard_error,
            transmittance: transmittance.value,
            transmittance_standard_error: transmittance.standard_error,
            absorbed_fraction: absorbed.value,
            absorbed_fraction_standard_error: absorbed.standard_error,
            absorbed_by_layer: estimates.absorbed_by_layer(),
            radial_profile: Radial {
                r_mm: estimates.ring_radii_mm(),
                reflectance_per_mm2,
                reflectance_per_mm2_standard_error: reflectance_error,
                transmittance_per_mm2,
                transmittance_per_mm2_standard_error: transmittance_error,
            },
            reflectance_by_cosine: estimates.reflectance_by_cosine(),
            transmittance_by_cosine: estimates.transmittance_by_cosine(),
            depth_step_mm: simulation.grid.depth_step_mm,
            absorbed_by_depth: estimates.absorbed_by_depth(),
            photons_per_second: estimates.packets() as f64 / seconds,
            wall_seconds: seconds,
        }
    }

    fn text(&self) -> String {
        let mut text = String::new();
        for (name, value, error) in [
            ("specular reflectance", self.specular_reflectance, self.specular_reflectance_standard_error),
            ("diffuse reflectance", self.diffuse_reflectance, self.diffuse_reflectance_standard_error),
            ("transmittance", self.transmittance, self.transmittance_standard_error),
            ("absorbed", self.absorbed_fraction, self.absorbed_fraction_standard_error),
        ] {
            let _ = writeln!(text, "{name:22} {value:.6} ± {error:.6}"); // writing to a String cannot fail
        }
        for (number, layer) in self.absorbed_by_layer.iter().enumerate() {
            let name = format!("  in layer {}", number + 1);
            let _ = writeln!(text, "{name:22} {:.6} ± {:.6}", layer.value, layer.standard_error);
        }
        let _ = writeln!(
            text,
            "{} photons in {:.2} s, {:.2} million a second",
            self.photons,
            self.wall_seconds,
            self.photons_per_second * 1e-6
        );
        text
    }
}

impl LayerReport {
    fn new(layer: &Layer) -> Self {
        Self {
            sigma_a_per_mm: layer.sigma_a_per_mm,
            sigma_s_per_mm: layer.sigma_s_per_mm,
            g: layer.g,
            refractive_index: layer.refractive_index,
            thickness_mm: layer.thickness_mm.is_finite().then_some(layer.thickness_mm),
        }
    }
}
