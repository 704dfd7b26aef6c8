//! A simulated half-space to hold formulas against: sigma_t' = 1/mm, so that a mean free path is a millimetre.

use cutis_optics::simulate::{BATCH, Estimates, Grid, Layer, LayeredSlab, Rings, Simulation};
use cutis_optics::{Medium, RingProfile};
use rayon::prelude::*;
use std::error::Error;
use std::f64::consts::TAU;

/// Width of a ring.
pub const RING_MM: f64 = 0.05;
const RINGS: usize = 400;
/// Steps of the integral over a ring.
const STEPS: usize = 16;

/// How far a profile is off, relative: its total, and its shape by rings, what chance adds taken off.
#[derive(Debug)]
pub struct Off {
    pub total: f64,
    pub shape: f64,
}

/// The rings are so many times `finer`.
pub fn simulate(medium: &Medium, packets: u64, seed: u64, finer: usize) -> Result<Estimates, Box<dyn Error>> {
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
pub struct Truth {
    rings: RingProfile,
    pub total: f64,
    pub standard_error: f64,
}

impl Truth {
    pub fn new(estimates: &Estimates) -> Self {
        let entered = 1.0 - estimates.specular_reflectance();
        let total = estimates.diffuse_reflectance();
        Self {
            rings: RingProfile::from_estimates(estimates),
            total: total.value / entered,
            standard_error: total.standard_error / entered,
        }
    }

    /// How far a profile is off.
    pub fn error_of(&self, total: f64, at_mm: &dyn Fn(f64) -> f64) -> Off {
        let off = |ring: usize| mean_over_ring(ring, at_mm) - self.rings.reflectance_per_mm2()[ring];
        let miss = self.power(&off) - self.power(&|ring| self.rings.standard_error_per_mm2()[ring]);
        Off { total: total / self.total - 1.0, shape: (miss.max(0.0) / self.norm()).sqrt() }
    }

    /// What chance alone would show as an error of the shape.
    pub fn noise(&self) -> f64 {
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
fn mean_over_ring(ring: usize, at_mm: &dyn Fn(f64) -> f64) -> f64 {
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
