//! How far each source is off, against a simulation of the same half-space: `cargo run --release -p cutis-optics --example
//! sources_against_monte_carlo [packets]`.
//!
//! Isotropic scattering, normal beam, sigma_t' = 1/mm, so that a mean free path is a millimetre. Shape: relative RMS power
//! error of the means over rings of 0.05 mean free paths out to 20, what chance adds to it taken off. Under `fitted` stands a
//! sum of twelve Gaussians (method energy) fitted to another run of the simulation.

use cutis_optics::simulate::{BATCH, Estimates, Grid, Layer, LayeredSlab, Rings, Simulation};
use cutis_optics::{
    Dipole, FitMethod, Medium, Profile, ProfileSource, RingProfile, SingleScattering, TissueLayer, WideBeam,
    fit,
};
use rayon::prelude::*;
use std::error::Error;
use std::f64::consts::TAU;
use std::io::{Write, stdout};

const ALBEDOS: [f64; 7] = [0.2, 0.5, 0.8, 0.9, 0.95, 0.99, 0.999];
const INDICES: [f64; 2] = [1.0, 1.4];
const RING_MM: f64 = 0.05;
const RINGS: usize = 400;
/// Deviation of the beam that the fitted profile is seen under, taken off its Gaussians again.
const BEAM_MM: f64 = 0.1 * RING_MM;
/// Its rings are so many times as fine.
const FINER: usize = 5;
const GAUSSIANS: usize = 12;
/// Steps of the integral over a ring.
const STEPS: usize = 16;

fn main() -> Result<(), Box<dyn Error>> {
    let packets = std::env::args().nth(1).map_or(Ok(400_000), |words| words.parse())?;
    let mut out = stdout().lock();
    writeln!(out, "| n | alpha' | R_d simulated | dipole | + single | better | beam | fitted | noise |")?;
    writeln!(out, "|---|---|---|---|---|---|---|---|---|")?;
    for index in INDICES {
        for albedo in ALBEDOS {
            writeln!(out, "{}", row(index, albedo, packets)?)?;
            out.flush()?;
        }
    }
    Ok(())
}

fn row(index: f64, albedo: f64, packets: u64) -> Result<String, Box<dyn Error>> {
    let medium = Medium::new(1.0 - albedo, albedo, index)?;
    let layers = [TissueLayer { medium, thickness_mm: f64::INFINITY }];
    let truth = Truth::new(&simulate(&medium, packets, 1, 1)?);
    let (dipole, single) = (Dipole::new(&medium)?, SingleScattering::new(&medium)?);
    let sum = |r: f64| dipole.at_mm(r) + single.at_mm(r);
    let mut row = format!("| {index} | {albedo} | {:.5} ± {:.5} |", truth.total, truth.standard_error);
    row += &truth.cell(dipole.total(), |r| dipole.at_mm(r));
    row += &truth.cell(dipole.total() + single.total(), sum);
    for source in [ProfileSource::BetterDipole, ProfileSource::Beam] {
        let profile = source.profile(&layers)?;
        row += &truth.cell(profile.total(), |r| profile.at_mm(r));
    }
    let other = RingProfile::from_estimates(&simulate(&medium, packets, 2, FINER)?);
    let total = other.total() + other.beyond().value;
    let mut fitted = fit(&WideBeam::new(other, BEAM_MM), GAUSSIANS, FitMethod::Energy)?.sum;
    fitted.terms.iter_mut().for_each(|g| g.variance_mm2 = (g.variance_mm2 - BEAM_MM * BEAM_MM).max(1e-6));
    row += &truth.cell(total, |r| fitted.at_mm(r));
    Ok(row + &format!(" {:.2} % |", 100.0 * truth.noise()))
}

fn simulate(medium: &Medium, packets: u64, seed: u64, finer: usize) -> Result<Estimates, Box<dyn Error>> {
    let layer = Layer {
        sigma_a_per_mm: medium.sigma_a_per_mm,
        sigma_s_per_mm: medium.sigma_s_reduced_per_mm,
        g: 0.0,
        refractive_index: medium.refractive_index,
        thickness_mm: f64::INFINITY,
    };
    let slab = LayeredSlab::in_air(vec![layer])?;
    let grid = Grid {
        rings: Rings::even(RING_MM / finer as f64, RINGS * finer)?,
        depth_step_mm: 1.0,
        depth_bins: 1,
        cosine_bins: 1,
    };
    let simulation = Simulation { slab, grid: grid.clone(), seed };
    let batches: Vec<_> =
        (0..packets / BATCH).into_par_iter().map(|b| simulation.batch(b * BATCH, BATCH)).collect();
    let mut estimates = Estimates::new(&grid, 1);
    batches.iter().for_each(|batch| estimates.add(batch));
    Ok(estimates)
}

/// Rings of a simulation, per flux that entered.
struct Truth {
    rings: RingProfile,
    total: f64,
    standard_error: f64,
}

impl Truth {
    fn new(estimates: &Estimates) -> Self {
        let entered = 1.0 - estimates.specular_reflectance();
        let total = estimates.diffuse_reflectance();
        Self {
            rings: RingProfile::from_estimates(estimates),
            total: total.value / entered,
            standard_error: total.standard_error / entered,
        }
    }

    /// Error of the total in percent, and of the shape.
    fn cell(&self, total: f64, at_mm: impl Fn(f64) -> f64) -> String {
        let off = |ring: usize| mean_over_ring(ring, &at_mm) - self.rings.reflectance_per_mm2()[ring];
        let miss = self.power(&off) - self.power(&|ring| self.rings.standard_error_per_mm2()[ring]);
        let shape = (miss.max(0.0) / self.norm()).sqrt();
        format!(" {:+.1} [{:.1}] |", 100.0 * (total / self.total - 1.0), 100.0 * shape)
    }

    /// What chance alone would show as an error of the shape.
    fn noise(&self) -> f64 {
        (self.power(&|ring| self.rings.standard_error_per_mm2()[ring]) / self.norm()).sqrt()
    }

    fn norm(&self) -> f64 {
        self.power(&|ring| self.rings.reflectance_per_mm2()[ring])
    }

    /// ∫ r f² dr.
    fn power(&self, f: &dyn Fn(usize) -> f64) -> f64 {
        (0..RINGS).map(|ring| (ring as f64 + 0.5) * f(ring).powi(2)).sum()
    }
}

/// By the midpoint rule in the square root of the way across the ring, which takes the peak of the innermost one.
fn mean_over_ring(ring: usize, at_mm: &impl Fn(f64) -> f64) -> f64 {
    let (from, to) = (RING_MM * ring as f64, RING_MM * (ring + 1) as f64);
    let light: f64 = (0..STEPS)
        .map(|i| {
            let part = (i as f64 + 0.5) / STEPS as f64;
            let r = from + part * part * RING_MM;
            TAU * r * at_mm(r) * 2.0 * part * RING_MM / STEPS as f64
        })
        .sum();
    light / (0.5 * TAU * (to * to - from * from))
}
