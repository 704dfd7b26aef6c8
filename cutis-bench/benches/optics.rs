//! Fits of sums of Gaussians to the dipole of marble: one channel with four and eight, all three together with six.
//! The spectrum of a stack of three layers; Monte Carlo of two published slabs on one thread.
//! One choice of absorption for a million packets of skin that were simulated without any.
//! Radii drawn from the dipole of marble: by Newton's steps, from its Gaussians, from a table; and making that table.
#![allow(missing_docs, reason = "criterion's macros make public functions")]

use criterion::{BenchmarkId, Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use cutis_optics::sample::{DipoleSampler, GaussianSampler, RadialSampler, TabulatedSampler};
use cutis_optics::simulate::{Grid, Layer, LayeredSlab, PathLengths, PathSimulation, Rings, Simulation};
use cutis_optics::{Dipole, FitMethod, Medium, Profile, Stack, TissueLayer, fit, presets, rgb_kernel};
use std::hint::black_box;
use std::time::Duration;

/// Red, green and blue of marble.
fn marble() -> [Medium; 3] {
    let preset = presets::find("marble").expect("marble is a preset");
    *preset.media().expect("marble is a measured medium")
}

fn optics(criterion: &mut Criterion) {
    let media = marble();
    let red = Dipole::new(&media[0]).expect("measured media are possible");
    let mut group = criterion.benchmark_group("optics");
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    group.warm_up_time(Duration::from_secs(1)).measurement_time(Duration::from_secs(3));
    for (name, method) in [("fit optimal", FitMethod::Optimal), ("fit energy", FitMethod::Energy)] {
        for gaussians in [4, 8] {
            group.bench_function(BenchmarkId::new(name, gaussians), |b| {
                b.iter(|| fit(black_box(&red), gaussians, method).expect("marble can be fitted"));
            });
        }
    }
    group.bench_function(BenchmarkId::new("fit rgb", 6), |b| {
        b.iter(|| rgb_kernel(black_box(&media), 6).expect("marble can be fitted"));
    });
    group.finish();
}

/// Epidermis, papillary and reticular dermis, about.
fn three_layers() -> Stack {
    let layer = |sigma_a_per_mm, sigma_s_reduced_per_mm, refractive_index, thickness_mm| TissueLayer {
        medium: Medium { sigma_a_per_mm, sigma_s_reduced_per_mm, refractive_index },
        thickness_mm,
    };
    let layers =
        [layer(0.3, 6.0, 1.4, 0.25), layer(0.1, 3.0, 1.38, 1.0), layer(0.05, 3.0, 1.38, f64::INFINITY)];
    Stack::in_air(&layers).expect("the layers are possible")
}

/// Packets of one run.
const PACKETS: u64 = 20_480;

/// One layer of 1/mm coefficients in air.
fn simulation(g: f64, refractive_index: f64, thickness_mm: f64) -> Simulation {
    let layer = Layer { sigma_a_per_mm: 1.0, sigma_s_per_mm: 9.0, g, refractive_index, thickness_mm };
    Simulation {
        slab: LayeredSlab::in_air(vec![layer]).expect("the layer is possible"),
        grid: Grid {
            rings: Rings::even(0.01, 200).expect("the numbers are in their ranges"),
            depth_step_mm: 0.01,
            depth_bins: 100,
            cosine_bins: 20,
        },
        seed: 1,
    }
}

/// A million packets through epidermis and dermis, absorption left for afterwards.
fn skin_paths() -> PathLengths {
    let layer = |sigma_s_per_mm, refractive_index, thickness_mm| Layer {
        sigma_a_per_mm: 0.0,
        sigma_s_per_mm,
        g: 0.0,
        refractive_index,
        thickness_mm,
    };
    let layers = [layer(7.3, 1.4, 0.25), layer(3.65, 1.38, f64::INFINITY)];
    let simulation = PathSimulation::in_air(&layers, &[0.03, 0.03], Rings::of_skin(), 1);
    simulation.expect("the layers are possible").run(1_000_000)
}

fn layers(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("layers");
    let stack = three_layers();
    group.bench_function("spectrum of three layers", |b| b.iter(|| stack.spectrum(black_box(1.3))));
    group.sample_size(10).throughput(Throughput::Elements(PACKETS));
    for (name, simulation) in [
        ("van de Hulst slab", simulation(0.75, 1.0, 0.2)),
        ("half-space of index 1.5, albedo 0.9", simulation(0.0, 1.5, f64::INFINITY)),
    ] {
        group.bench_function(BenchmarkId::new("simulate", name), |b| b.iter(|| simulation.run(PACKETS)));
    }
    group.finish();
}

fn absorption_afterwards(criterion: &mut Criterion) {
    let paths = skin_paths();
    let mut group = criterion.benchmark_group("layers");
    group.bench_function("absorption afterwards", |b| {
        b.iter(|| paths.with_absorption(black_box(&[1.0, 0.5])).expect("skin absorbs so"));
    });
    group.finish();
}

/// Radii of one run: numbers and radii stay in the cache.
const RADII: usize = 4096;

fn samplers(criterion: &mut Criterion) {
    let dipole = Dipole::new(&marble()[0]).expect("measured media are possible");
    let sum = fit(&dipole, 6, FitMethod::Energy).expect("marble can be fitted").sum;
    let newton = DipoleSampler::new(&dipole);
    let gaussians = GaussianSampler::new(&sum).expect("energy fits have no negative weights");
    let table = TabulatedSampler::new(&dipole, dipole.depth_real_mm()).expect("the dipole has light");
    let named: [(&str, &dyn RadialSampler); 3] =
        [("dipole, Newton", &newton), ("gaussians", &gaussians), ("table", &table)];
    // A multiple of the golden ratio: even, and no neighbour in the same piece of the table.
    let xi: Vec<f32> = (0..RADII).map(|i| (i as f64 * 0.618_033_988_749_894_9).fract() as f32).collect();
    let mut radii_mm = vec![0.0; RADII];
    let mut group = criterion.benchmark_group("samplers");
    group.throughput(Throughput::Elements(RADII as u64));
    for (name, sampler) in named {
        group.bench_function(BenchmarkId::new("many at once", name), |b| {
            b.iter(|| sampler.radii_mm(black_box(&xi), &mut radii_mm));
        });
        group.bench_function(BenchmarkId::new("one by one", name), |b| {
            b.iter(|| {
                radii_mm.iter_mut().zip(black_box(&xi)).for_each(|(r, &xi)| *r = sampler.radius_mm(xi));
            });
        });
    }
    group.throughput(Throughput::Elements(1));
    group.bench_function(format!("a table of {} pieces", table.pieces()), |b| {
        b.iter(|| TabulatedSampler::new(black_box(&dipole), dipole.depth_real_mm()));
    });
    group.finish();
}

criterion_group!(benches, optics, layers, absorption_afterwards, samplers);
criterion_main!(benches);
