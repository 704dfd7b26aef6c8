//! Fits of sums of Gaussians to the dipole of marble: one channel with four and eight, all three together with six.
#![allow(missing_docs, reason = "criterion's macros make public functions")]

use criterion::{BenchmarkId, Criterion, SamplingMode, criterion_group, criterion_main};
use cutis_optics::{Dipole, FitMethod, Medium, fit, presets, rgb_kernel};
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

criterion_group!(benches, optics);
criterion_main!(benches);
