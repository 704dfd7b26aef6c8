//! From layers to a kernel, on one thread: fits of one wavelength, layers as powers of one Gaussian, and the spectrum that
//! both start from, in closed form and by a discretised Hankel transform.
#![allow(missing_docs, reason = "criterion's macros make public functions")]

use criterion::{Criterion, criterion_group, criterion_main};
use cutis_optics::powers::PowersSettings;
use cutis_optics::{
    Boundary, Dipole, FitMethod, Medium, Multipole, Profile, Stack, TissueLayer, fit, presets,
};
use std::f64::consts::TAU;
use std::hint::black_box;

fn layer(sigma_a: f64, sigma_s_reduced: f64, index: f64, thickness_mm: f64) -> TissueLayer {
    let medium = Medium::new(sigma_a, sigma_s_reduced, index).expect("the medium is possible");
    TissueLayer { medium, thickness_mm }
}

/// Epidermis, papillary and reticular dermis, about.
fn three_layers() -> [TissueLayer; 3] {
    [layer(0.3, 6.0, 1.4, 0.25), layer(0.1, 3.0, 1.38, 1.0), layer(0.05, 3.0, 1.38, f64::INFINITY)]
}

/// Epidermis and dermis near 500 nm.
fn two_layers() -> [TissueLayer; 2] {
    [layer(0.48, 7.28, 1.4, 0.25), layer(0.29, 3.64, 1.38, f64::INFINITY)]
}

fn fits(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("profiles");
    let marble = presets::find("marble").expect("marble is a preset").media().expect("it is measured")[0];
    group.bench_function("dipole, 4 Gaussians, energy", |b| {
        b.iter(|| {
            let dipole = Dipole::new(black_box(&marble)).expect("marble is possible");
            fit(&dipole, 4, FitMethod::Energy).expect("marble can be fitted")
        });
    });
    group.bench_function("dipole, fast", |b| {
        b.iter(|| {
            let dipole = Dipole::new(black_box(&marble)).expect("marble is possible");
            fit(&dipole, 8, FitMethod::Fast).expect("marble has poles")
        });
    });
    group.bench_function("three layers, 6 Gaussians, energy", |b| {
        b.iter(|| {
            let stack = Stack::in_air(black_box(&three_layers())).expect("the layers are possible");
            fit(&stack, 6, FitMethod::Energy).expect("the layers can be fitted")
        });
    });
    group.bench_function("two layers, powers", |b| {
        b.iter(|| {
            let stack = Stack::in_air(black_box(&two_layers())).expect("the layers are possible");
            stack.as_powers(&PowersSettings::for_stack(&stack)).expect("the settings are possible")
        });
    });
    group.finish();
}

/// Frequencies and radii of the discretised transform.
const FREQUENCIES: usize = 256;
const RADII: usize = 1024;

fn spectra(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("profiles");
    let k_per_mm = |i: usize| 0.1 * 1.03_f64.powi(i as i32);
    let frequencies: Vec<f64> = (0..FREQUENCIES).map(k_per_mm).collect();
    group.bench_function("spectrum of two layers, closed", |b| {
        b.iter(|| {
            let stack = Stack::in_air(black_box(&two_layers())).expect("the layers are possible");
            frequencies.iter().map(|&k| stack.spectrum(k)).collect::<Vec<_>>()
        });
    });
    group.sample_size(10);
    group.bench_function("spectrum of two layers, by Hankel transforms", |b| {
        b.iter(|| by_hankel_transforms(black_box(&two_layers()), &frequencies));
    });
    group.finish();
}

/// As one would without the closed form: poles summed at many radii, each profile transformed by quadrature, combined per
/// frequency.
fn by_hankel_transforms([upper, lower]: &[TissueLayer; 2], frequencies: &[f64]) -> Vec<f64> {
    let between = upper.medium.refractive_index / lower.medium.refractive_index;
    let (above, below) = (Boundary::smooth(upper.medium.refractive_index), Boundary::smooth(between));
    let slab = Multipole::new(&upper.medium, upper.thickness_mm, above, below).expect("the slab is possible");
    let upside_down = Multipole::new(&upper.medium, upper.thickness_mm, below, above).expect("as is this");
    let dipole = Dipole::with_boundary(&lower.medium, Boundary::smooth(between.recip()));
    let dipole = dipole.expect("the half-space is possible");
    let rows: Vec<[f64; 6]> = (0..RADII)
        .map(|i| {
            let (from, to) = (1e-3_f64.ln(), 20_f64.ln());
            let step = (to - from) / RADII as f64;
            let r = (from + step * (i as f64 + 0.5)).exp();
            let [r1, r1_up] = [&slab, &upside_down].map(|slab| slab.at_mm(r));
            let [t1, t1_up] = [&slab, &upside_down].map(|slab| slab.transmittance_at_mm(r));
            let area = TAU * r * r * step;
            [area * r1, area * t1, area * r1_up, area * t1_up, area * dipole.at_mm(r), r]
        })
        .collect();
    let combined = |&k: &f64| {
        let mut sums = [0.0; 5];
        for row in &rows {
            let wave = libm::j0(k * row[5]);
            sums.iter_mut().zip(row).for_each(|(sum, f)| *sum += wave * f);
        }
        let [r1, t1, r1_up, t1_up, r2] = sums;
        r1 + t1 * r2 * t1_up / (1.0 - r2 * r1_up)
    };
    frequencies.iter().map(combined).collect()
}

criterion_group!(benches, fits, spectra);
criterion_main!(benches);
