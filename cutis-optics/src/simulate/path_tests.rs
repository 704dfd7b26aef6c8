//! Absorption applied afterwards against direct simulation, against Beer and Lambert's law, and against its own books.
#![allow(clippy::unwrap_used, reason = "tests")]

use super::paths::PathExit;
use super::tests::layer;
use super::*;
use crate::profile::Profile;

/// Packets of a test: standard errors near 2e-3 for the lightest absorption.
const PACKETS: u64 = 60_000;
/// Standard errors that are let pass. Of about 300 comparisons here, one honest one in 16,000 lies farther out.
const ERRORS: f64 = 4.0;

/// Epidermis and dermis near 500 nm, scattering reduced and isotropic; absorption as asked.
fn skin(sigma_a_per_mm: [f64; 2]) -> Vec<Layer> {
    let [epidermis, dermis] = sigma_a_per_mm;
    vec![layer(epidermis, 7.3, 0.0, 1.4, 0.25), layer(dermis, 3.65, 0.0, 1.38, f64::INFINITY)]
}

fn paths(layers: &[Layer], least_per_mm: &[f64], packets: u64) -> PathLengths {
    PathSimulation::in_air(layers, least_per_mm, Rings::of_skin(), 7).unwrap().run(packets)
}

fn agree(what: &str, a: Estimate, b: Estimate) {
    let error = a.standard_error.hypot(b.standard_error);
    assert!((a.value - b.value).abs() <= ERRORS * error, "{what}: {a:?} against {b:?}");
}

#[test]
fn one_walk_without_absorption_serves_every_absorption_of_skin() {
    let lengths = paths(&skin([0.0; 2]), &[0.03, 0.03], PACKETS);
    for absorption in [[0.03, 0.03], [0.03, 20.0], [40.0, 0.03], [40.0, 20.0], [1.0, 0.5]] {
        let grid =
            Grid { rings: Rings::even(0.1, 20).unwrap(), depth_step_mm: 1.0, depth_bins: 1, cosine_bins: 0 };
        let slab = LayeredSlab::in_air(skin(absorption)).unwrap();
        let direct = Simulation { slab, grid, seed: 3 }.run(PACKETS);
        let entered = 1.0 - direct.specular_reflectance();
        let scaled =
            |e: Estimate| Estimate { value: e.value / entered, standard_error: e.standard_error / entered };
        let afterwards = lengths.with_absorption(&absorption).unwrap();
        let what = format!("{absorption:?}");
        agree(&what, scaled(direct.diffuse_reflectance()), afterwards.total_reflectance);
        // The even rings of skin are a twentieth of a ring here: 20 of them are one.
        let inner = (0..20).map(|ring| ring_share(&afterwards.reflectance, ring)).sum::<f64>();
        let first = scaled(direct.reflectance_by_ring()[0]);
        let error = (first.value / PACKETS as f64).sqrt().hypot(first.standard_error);
        assert!((inner - first.value).abs() <= ERRORS * error, "{what}: {inner} against {first:?}");
    }
}

fn ring_share(profile: &crate::RingProfile, ring: usize) -> f64 {
    let [a, b] = [profile.edges_mm()[ring], profile.edges_mm()[ring + 1]];
    core::f64::consts::PI * (b * b - a * a) * profile.reflectance_per_mm2()[ring]
}

#[test]
fn without_scattering_it_is_beer_and_lambert_s_law() {
    let clear = layer(0.0, 0.0, 0.0, 1.0, 0.25);
    let lengths = paths(&[clear, layer(0.0, 0.0, 0.0, 1.0, 0.5)], &[0.01, 0.01], 2000);
    for [a, b] in [[0.0, 0.0], [0.3, 0.7], [8.0, 2.0], [40.0, 20.0]] {
        let through = lengths.with_absorption(&[a, b]).unwrap().total_transmittance;
        // No chance is left: nothing but rounding and the cells' moments.
        let expected = (-0.25 * a - 0.5 * b).exp();
        assert!((through.value / expected - 1.0).abs() < 1e-12, "{a} {b}: {through:?} against {expected}");
    }
}

#[test]
fn nothing_is_lost_where_nothing_absorbs() {
    let slab = layer(0.0, 5.0, 0.5, 1.4, 1.0);
    let lengths = paths(&[slab], &[0.2], PACKETS);
    let all = lengths.with_absorption(&[0.0]).unwrap();
    let sum = all.total_reflectance.value + all.total_transmittance.value;
    // Roulette moves weight between packets: the two errors may add.
    let error = all.total_reflectance.standard_error + all.total_transmittance.standard_error;
    assert!((sum - 1.0).abs() <= ERRORS * error, "{sum} ± {error}");
    let rings = all.reflectance.total() + all.reflectance.beyond().value;
    assert!((rings - all.total_reflectance.value).abs() < 1e-12);
}

#[test]
fn roulette_s_threshold_changes_nothing_but_chance() {
    let half_space = [layer(0.0, 5.0, 0.0, 1.4, f64::INFINITY)];
    let [short, long] = [1.0, 0.05].map(|least| paths(&half_space, &[least], PACKETS));
    for sigma_a in [0.5, 1.0, 5.0] {
        let [a, b] = [&short, &long].map(|p| p.with_absorption(&[sigma_a]).unwrap().total_reflectance);
        agree(&format!("{sigma_a}"), a, b);
    }
}

#[test]
fn cells_cost_less_than_they_say() {
    // The same exits, summed one by one.
    let simulation = PathSimulation::in_air(&skin([0.0; 2]), &[0.03, 0.03], Rings::of_skin(), 7).unwrap();
    let batches: Vec<PathBatch> = (0..20).map(|b| simulation.batch(b * BATCH, BATCH)).collect();
    let mut counter = simulation.counter();
    batches.iter().for_each(|batch| counter.add(batch));
    let lengths = counter.path_lengths();
    for absorption in [[0.03, 0.03], [0.3, 0.1], [1.0, 20.0], [5.0, 0.5], [40.0, 0.03], [40.0, 20.0]] {
        let got = lengths.with_absorption(&absorption).unwrap().total_reflectance;
        let exits = batches.iter().flat_map(|b| &b.exits).filter(|exit| !exit.downwards);
        let left =
            exits.map(|e| e.weight * (-absorption[0] * e.path_mm[0] - absorption[1] * e.path_mm[1]).exp());
        let (sum, squares) = left.fold((0.0, 0.0), |(s, q), w| (s + w, q + w * w));
        let packets = (20 * BATCH) as f64;
        assert!((got.value * packets / sum - 1.0).abs() < 1e-4, "{absorption:?}: {got:?} against {sum}");
        let error = ((squares / packets - (sum / packets).powi(2)) / packets).sqrt();
        assert!((got.standard_error / error - 1.0).abs() < 2e-3, "{absorption:?}: {got:?} against {error}");
    }
}

#[test]
fn a_cell_knows_how_paths_in_two_layers_go_together() {
    let simulation = PathSimulation::in_air(&skin([0.0; 2]), &[0.03, 0.03], Rings::of_skin(), 7).unwrap();
    let exit = |path_mm| PathExit {
        downwards: false,
        r_mm: 0.1,
        weight: 1.0,
        path_mm: [path_mm, path_mm, 0.0, 0.0],
    };
    let mut counter = simulation.counter();
    counter.add(&PathBatch { packets: 2, exits: vec![exit(0.100), exit(0.104)] });
    let got = counter.path_lengths().with_absorption(&[40.0, 20.0]).unwrap().total_reflectance.value;
    // Optical depths 6 ± 0.12 about the mean: cosh(0.12), of which the cell leaves out 0.12⁴/24 = 9e-6.
    let expected = 0.5 * ((-6.0f64).exp() + (-6.24f64).exp());
    assert!((got / expected - 1.0).abs() < 1e-5, "{got} against {expected}");
}

#[test]
fn impossible_requests_are_refused_with_the_number_at_fault() {
    let one = layer(0.0, 5.0, 0.0, 1.4, 1.0);
    let refuse = |layers: &[Layer], least: &[f64]| {
        PathSimulation::in_air(layers, least, Rings::of_skin(), 1).unwrap_err()
    };
    assert_eq!(refuse(&[one; 5], &[1.0; 5]), PathError::TooManyLayers(5));
    assert_eq!(refuse(&[one; 2], &[1.0; 1]), PathError::WrongCount { layers: 2, got: 1 });
    assert_eq!(refuse(&[one; 2], &[1.0, 0.0]), PathError::Least { layer: 2, value: 0.0 });
    assert!(refuse(&[one], &[f64::NAN]).to_string().contains("layer 1"));
    assert!(refuse(&[], &[]).to_string().contains("at least one layer"));
    let lengths = paths(&[one], &[1.0], 10);
    assert_eq!(
        lengths.with_absorption(&[-1.0]).unwrap_err(),
        PathError::Absorption { layer: 1, value: -1.0 }
    );
    assert_eq!(lengths.with_absorption(&[]).unwrap_err(), PathError::WrongCount { layers: 1, got: 0 });
}
