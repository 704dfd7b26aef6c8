//! The exact solutions again, with so many packets that a bias of a few parts in 10,000 would show.
//! `cargo test --release -p cutis-optics -- --ignored --nocapture` prints every number.
#![allow(clippy::unwrap_used, reason = "tests")]

use super::tests::{EXACT_HALF_SPACES, layer};
use super::*;
use rayon::prelude::*;

/// Standard errors that are let pass. Of the eleven values below, honest ones lie farther out once in 1,400 runs.
const ERRORS: f64 = 4.0;

/// All batches, on all threads. Every case has a seed of its own: one stream would lead them all astray the same way.
fn run(layers: Vec<Layer>, packets: u64, seed: u64) -> Estimates {
    let grid =
        Grid { rings: Rings::even(0.1, 10).unwrap(), depth_step_mm: 1.0, depth_bins: 10, cosine_bins: 0 };
    let simulation = Simulation { slab: LayeredSlab::in_air(layers).unwrap(), grid, seed };
    let batches: Vec<Tally> =
        (0..packets / BATCH).into_par_iter().map(|b| simulation.batch(b * BATCH, BATCH)).collect();
    let mut estimates = Estimates::new(&simulation.grid, simulation.slab.layers().len());
    batches.iter().for_each(|batch| estimates.add(batch));
    estimates
}

/// Within four standard errors of ours and the table's own, which are independent.
fn meets(what: &str, got: Estimate, expected: f64, table_error: f64) {
    let error = got.standard_error.hypot(table_error);
    let errors = (got.value - expected) / error;
    eprintln!(
        "{what}: {:.6} ± {:.6}, expected {expected}, {errors:+.2} errors",
        got.value, got.standard_error
    );
    assert!(errors.abs() <= ERRORS, "{what}: {got:?} against {expected}");
}

#[test]
#[ignore = "11 million packets for each of seven half-spaces: minutes"]
fn half_spaces_meet_chandrasekhar_closely() {
    for (seed, (albedo, exact)) in (20..).zip(EXACT_HALF_SPACES) {
        let estimates = run(vec![layer(1.0 - albedo, albedo, 0.0, 1.0, f64::INFINITY)], 11_000_000, seed);
        meets(&format!("albedo {albedo}"), estimates.diffuse_reflectance(), exact, 1e-8);
    }
}

#[test]
#[ignore = "22 million packets for each of three slabs: minutes"]
fn slabs_meet_published_values_closely() {
    // reference/slab_cases.csv: van de Hulst's five decimals, and MCML with 2e7 packets, whose program prints no error:
    // ours stands for it. For the three layers its manual and another run of it differ by 0.00024 in R and 0.00017 in T,
    // more than chance allows: they are held to no more than that. (Adding-doubling with 32 streams gives T 0.09605.)
    let packets = 22_000_000;
    let van_de_hulst = run(vec![layer(1.0, 9.0, 0.75, 1.0, 0.2)], packets, 30);
    meets("van de Hulst R", van_de_hulst.diffuse_reflectance(), 0.09739, 5e-6);
    meets("van de Hulst T", van_de_hulst.transmittance(), 0.66096, 5e-6);
    let giovanelli = run(vec![layer(1.0, 9.0, 0.0, 1.5, f64::INFINITY)], packets, 31).diffuse_reflectance();
    meets("Giovanelli R", giovanelli, 0.219_984, giovanelli.standard_error);
    let gardner = run(
        vec![
            layer(0.1, 10.0, 0.9, 1.37, 1.0),
            layer(0.1, 1.0, 0.0, 1.37, 1.0),
            layer(0.2, 1.0, 0.7, 1.37, 2.0),
        ],
        packets,
        32,
    );
    meets("three layers R", gardner.diffuse_reflectance(), 0.237_743, 2.4e-4);
    meets("three layers T", gardner.transmittance(), 0.096_327_7, 1.7e-4);
}
