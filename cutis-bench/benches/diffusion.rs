//! The separable blur against what memory alone costs: as many plain copies of the texture as a kernel of six
//! Gaussians has blurs, two for each Gaussian.
//!
//! The surface is a flat patch, one chart over the whole texture but for a margin. Texels measure the same at every
//! size, so that the blur takes the same steps and the trend shows the memory.
#![allow(missing_docs, reason = "criterion's macros make public functions")]

mod common;

use criterion::{
    BatchSize, BenchmarkId, Criterion, SamplingMode, Throughput, criterion_group, criterion_main,
};
use cutis_optics::presets;
use cutis_render::passes::atlas::{Atlas, ChartMap, NO_CHART};
use cutis_render::passes::blur::Fields;
use cutis_render::passes::diffusion::{Diffused, DiffusionOperator, Separable};
use cutis_render::passes::stretch::stretch_mm_per_texel;
use cutis_render::{CpuRenderer, Renderer, Silent};
use cutis_scene::{Material, Mesh, Object};
use glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;
use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Sides of the texture, texels.
const SIZES: [usize; 3] = [512, 1024, 2048];
/// One copy for each of the six Gaussians and each axis.
const COPIES: usize = 12;
/// A texel of a head's 2048² texture.
const TEXEL_MM: f32 = 0.3;
/// Free texels around the chart.
const MARGIN_TEXELS: f32 = 4.0;
/// Quads along a side of the patch; in one quad alone the diagonal would suffer from rounding.
const CELLS: u32 = 64;
/// Timed runs of which the report takes the median; odd, so that there is a middle one.
const RUNS: usize = 7;

/// A lit patch, ready to be blurred.
struct Patch {
    size: usize,
    charts: Arc<ChartMap>,
    fields: Fields,
    variances_mm2: Vec<f32>,
}

impl Patch {
    fn new(size: usize) -> Self {
        let object = Object::new("patch", mesh(size), Material::default());
        let atlas = Atlas::new(&object, size);
        let stretch_mm = stretch_mm_per_texel(&object, &atlas);
        let fields = Fields::new(vec![irradiance(&atlas.charts)], stretch_mm);
        Self { size, charts: atlas.charts, fields, variances_mm2: skin_variances_mm2() }
    }

    fn diffuse(&self, fields: Fields) -> Diffused {
        Separable.diffuse(Arc::clone(&self.charts), fields, &self.variances_mm2, &Silent)
    }

    /// The plain copies, row by row as the blur writes.
    fn copy_to(&self, target: &mut [Vec4]) {
        for _ in 0..COPIES {
            let rows = target.par_chunks_mut(self.size).zip(self.fields.layers[0].par_chunks(self.size));
            rows.for_each(|(to, from)| to.copy_from_slice(from));
            black_box(&mut *target);
        }
    }
}

/// A square in the plane z = 0, facing +Z, over the whole texture but for the margin.
fn mesh(size: usize) -> Mesh {
    let size = size as f32;
    let texel = |i: u32| MARGIN_TEXELS + (size - 2.0 * MARGIN_TEXELS) * i as f32 / CELLS as f32;
    let mut mesh = Mesh::default();
    for (j, i) in (0..=CELLS).flat_map(|j| (0..=CELLS).map(move |i| (j, i))) {
        let place = Vec2::new(texel(i), texel(j));
        mesh.positions_mm.push(Vec3::new(place.x, -place.y, 0.0) * TEXEL_MM);
        mesh.uvs.push(place / size);
    }
    let row = CELLS + 1;
    for a in (0..CELLS).flat_map(|j| (0..CELLS).map(move |i| j * row + i)) {
        mesh.triangles.extend([[a, a + row, a + 1], [a + 1, a + row, a + row + 1]]);
    }
    mesh
}

/// Irradiance with a thickness in alpha, striped so that no two neighbours need be alike; black off the chart.
fn irradiance(charts: &ChartMap) -> Vec<Vec4> {
    let lit = |(i, &chart): (usize, &u32)| {
        let stripe = 0.5 + 0.1 * (i % 5) as f32;
        if chart == NO_CHART { Vec4::ZERO } else { Vec4::new(stripe, 0.8 * stripe, 0.6 * stripe, 20.0) }
    };
    charts.chart.iter().enumerate().map(lit).collect()
}

fn skin_variances_mm2() -> Vec<f32> {
    let preset = presets::find("three-layer-skin").expect("the skin kernel is a preset");
    let kernel = preset.kernel(COPIES / 2).expect("a finished kernel needs no fit");
    assert_eq!(2 * kernel.len(), COPIES, "two blurs for each Gaussian");
    kernel.variances_mm2.iter().map(|&v| v as f32).collect()
}

fn diffusion(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("diffusion");
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    group.warm_up_time(Duration::from_secs(1)).measurement_time(Duration::from_secs(5));
    for size in SIZES {
        let patch = Patch::new(size);
        let mut target = patch.fields.layers[0].clone();
        group.throughput(Throughput::Elements((size * size) as u64));
        group.bench_function(BenchmarkId::new("copies", size), |b| b.iter(|| patch.copy_to(&mut target)));
        group.bench_function(BenchmarkId::new("separable", size), |b| {
            b.iter_batched(
                || patch.fields.clone(),
                |fields| patch.diffuse(fields),
                BatchSize::LargeInput, // one input per batch below a thousand iterations
            );
        });
    }
    group.finish();
}

/// Medians of both, s.
struct Medians {
    copies_s: f64,
    separable_s: f64,
}

impl Medians {
    /// Both in turn, so that a machine that grows slower is so for both. The first of each goes untimed: it meets
    /// memory that was never touched.
    fn measure(patch: &Patch) -> Self {
        let mut target = patch.fields.layers[0].clone();
        let (mut copies_s, mut separable_s) = (Vec::new(), Vec::new());
        for _ in 0..=RUNS {
            copies_s.push(seconds(|| patch.copy_to(&mut target)));
            let fields = patch.fields.clone();
            separable_s.push(seconds(|| patch.diffuse(fields)));
        }
        Self { copies_s: median(&mut copies_s[1..]), separable_s: median(&mut separable_s[1..]) }
    }

    fn ratio(&self) -> f64 {
        self.separable_s / self.copies_s
    }
}

/// Time of one call; its result is thrown away afterwards.
fn seconds<T>(work: impl FnOnce() -> T) -> f64 {
    let start = Instant::now();
    let result = black_box(work());
    let elapsed_s = start.elapsed().as_secs_f64();
    drop(result);
    elapsed_s
}

fn median(times_s: &mut [f64]) -> f64 {
    times_s.sort_by(f64::total_cmp);
    times_s[times_s.len() / 2]
}

/// The ratio at every size as a table, and that of the largest as the last line.
fn ratios() {
    if !common::reports_wanted() {
        return;
    }
    eprintln!("\ncpu: {}, median of {RUNS} runs", CpuRenderer.adapter());
    eprintln!("\n| texels | {COPIES} copies, s | separable, s | ratio |\n|---|---|---|---|");
    let mut largest = 0.0;
    for size in SIZES {
        let medians = Medians::measure(&Patch::new(size));
        let Medians { copies_s, separable_s } = medians;
        largest = medians.ratio();
        eprintln!("| {size}² | {copies_s:.4} | {separable_s:.4} | {largest:.2} |");
    }
    eprintln!("\nseparable / {COPIES} copies = {largest:.2}");
}

criterion_group!(benches, diffusion);
criterion_main!(benches, ratios);
