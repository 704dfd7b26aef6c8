//! One simulation of skin without absorption, weighted for every absorption, against direct simulations: a table.
//! `cargo run --release -p cutis-optics --example absorption_afterwards [packets]` (a million unless told otherwise).
#![allow(clippy::print_stdout, reason = "the table is what it is for")]

use cutis_optics::RingProfile;
use cutis_optics::simulate::{
    Absorbed, BATCH, Estimate, Estimates, Grid, Layer, LayeredSlab, PathLengths, PathSimulation, Rings,
    Simulation,
};
use rayon::prelude::*;
use std::time::Instant;

/// Least absorption of both layers of skin, 1/mm: little melanin or blood at 645 nm.
const LEAST_PER_MM: [f64; 2] = [0.03, 0.03];
/// Rings in which a ring's error is looked at must have this many packets' worth of light.
const LIGHT: f64 = 2e-4;
/// Width of the rings of direct simulation, mm: that of the even rings of skin.
const WIDTH_MM: f64 = 0.005;

/// Epidermis and dermis near 500 nm: reduced scattering 7.3 and 3.65 1/mm, at this mean cosine.
fn skin(sigma_a_per_mm: [f64; 2], g: f64) -> Vec<Layer> {
    let layer = |sigma_a_per_mm, sigma_s_reduced_per_mm: f64, refractive_index, thickness_mm| Layer {
        sigma_a_per_mm,
        sigma_s_per_mm: sigma_s_reduced_per_mm / (1.0 - g),
        g,
        refractive_index,
        thickness_mm,
    };
    let [epidermis, dermis] = sigma_a_per_mm;
    vec![layer(epidermis, 7.3, 1.4, 0.25), layer(dermis, 3.65, 1.38, f64::INFINITY)]
}

fn main() {
    let packets = std::env::args().nth(1).and_then(|word| word.parse().ok()).unwrap_or(1_000_000u64);
    for g in [0.0, 0.8] {
        let start = Instant::now();
        let lengths = walk(g, packets);
        println!(
            "\ng {g}: {packets} packets without absorption in {:.1} s, {} kB of cells\n",
            start.elapsed().as_secs_f64(),
            lengths.bytes() / 1000
        );
        println!(
            "| epidermis 1/mm | dermis 1/mm | R direct | R afterwards | errors | % | worst ring, errors |"
        );
        println!("|---|---|---|---|---|---|---|");
        for epidermis in [0.03, 1.0, 40.0] {
            for dermis in [0.03, 0.8, 20.0] {
                row(&lengths, [epidermis, dermis], g, packets);
            }
        }
    }
}

/// All batches, on all threads.
fn walk(g: f64, packets: u64) -> PathLengths {
    let simulation = PathSimulation::in_air(&skin([0.0; 2], g), &LEAST_PER_MM, Rings::of_skin(), 1)
        .expect("skin is possible");
    let batches: Vec<_> =
        (0..packets.div_ceil(BATCH)).into_par_iter().map(|b| simulation.batch(b * BATCH, BATCH)).collect();
    let mut counter = simulation.counter();
    batches.iter().for_each(|batch| counter.add(batch));
    counter.path_lengths()
}

/// The same with absorption, in even rings as fine as the finest of skin.
fn direct(absorption: [f64; 2], g: f64, packets: u64) -> Estimates {
    let grid = Grid {
        rings: Rings::even(WIDTH_MM, 800).expect("the numbers are in their ranges"),
        depth_step_mm: 1.0,
        depth_bins: 1,
        cosine_bins: 0,
    };
    let slab = LayeredSlab::in_air(skin(absorption, g)).expect("skin is possible");
    let simulation = Simulation { slab, grid: grid.clone(), seed: 2 };
    let tallies: Vec<_> =
        (0..packets.div_ceil(BATCH)).into_par_iter().map(|b| simulation.batch(b * BATCH, BATCH)).collect();
    let mut estimates = Estimates::new(&grid, 2);
    tallies.iter().for_each(|tally| estimates.add(tally));
    estimates
}

fn row(lengths: &PathLengths, absorption: [f64; 2], g: f64, packets: u64) {
    let estimates = direct(absorption, g, packets);
    let afterwards = lengths.with_absorption(&absorption).expect("skin absorbs so");
    let entered = 1.0 - estimates.specular_reflectance();
    let total = estimates.diffuse_reflectance();
    let total = Estimate { value: total.value / entered, standard_error: total.standard_error / entered };
    let weighted = afterwards.total_reflectance;
    println!(
        "| {} | {} | {:.6} ± {:.6} | {:.6} ± {:.6} | {:+.1} | {:+.2} | {} |",
        absorption[0],
        absorption[1],
        total.value,
        total.standard_error,
        weighted.value,
        weighted.standard_error,
        errors(weighted, total),
        100.0 * (weighted.value / total.value - 1.0),
        worst_ring(&afterwards, &RingProfile::from_estimates(&estimates), packets)
    );
}

fn errors(a: Estimate, b: Estimate) -> f64 {
    (a.value - b.value) / a.standard_error.hypot(b.standard_error)
}

/// The ring whose two means lie farthest apart, in standard errors, of those near the beam that hold enough light, and
/// how many these are.
fn worst_ring(afterwards: &Absorbed, direct: &RingProfile, packets: u64) -> String {
    let ring = |profile: &RingProfile, i: usize| Estimate {
        value: profile.reflectance_per_mm2()[i],
        standard_error: profile.standard_error_per_mm2()[i],
    };
    let even =
        afterwards.reflectance.edges_mm().windows(2).take_while(|e| e[1] - e[0] < 1.01 * WIDTH_MM).count();
    let area_mm2 = |i: usize| core::f64::consts::PI * WIDTH_MM * WIDTH_MM * (2 * i + 1) as f64;
    let (mut worst, mut at, mut looked_at) = (0.0f64, 0, 0);
    for i in 0..even {
        let (a, b) = (ring(&afterwards.reflectance, i), ring(direct, i));
        if b.value * area_mm2(i) * packets as f64 >= LIGHT * packets as f64 {
            looked_at += 1;
            let off = errors(a, b);
            if off.abs() > worst.abs() {
                (worst, at) = (off, i);
            }
        }
    }
    format!("{worst:+.1} at {:.4} mm, of {looked_at}", (at as f64 + 0.5) * WIDTH_MM)
}
