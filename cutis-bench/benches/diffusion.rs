//! The separable blur and heat flow against what memory alone costs: as many plain copies of the texture as a kernel of
//! six Gaussians has blurs, two for each Gaussian.
//!
//! The surface is a flat patch, one chart over the whole texture but for a margin. Texels measure the same at every
//! size, so that the blur takes the same steps and the trend shows the memory. Links of heat flow are made beforehand.
#![allow(missing_docs, reason = "criterion's macros make public functions")]

mod common;

use criterion::{
    BatchSize, BenchmarkId, Criterion, SamplingMode, Throughput, criterion_group, criterion_main,
};
use cutis_optics::presets;
use cutis_render::passes::atlas::{Atlas, ChartMap, NO_CHART};
use cutis_render::passes::blur::Fields;
use cutis_render::passes::diffusion::{Diffused, DiffusionOperator, Separable};
use cutis_render::passes::heat_flow::{HeatFlow, Level};
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
/// Bytes of a texel of light.
const LIGHT_BYTES: usize = size_of::<Vec4>();
/// Bytes of a texel's links and area.
const LINK_BYTES: usize = size_of::<[f32; 4]>() + size_of::<f32>();
/// Timed runs of which the report takes the median; odd, so that there is a middle one.
const RUNS: usize = 7;

/// A lit patch, ready to be blurred.
struct Patch {
    size: usize,
    charts: Arc<ChartMap>,
    fields: Fields,
    variances_mm2: Vec<f32>,
    heat_flow: HeatFlow,
}

impl Patch {
    fn new(size: usize) -> Self {
        let object = Object::new("patch", mesh(size), Material::default());
        let atlas = Atlas::new(&object, size);
        let stretch_mm = stretch_mm_per_texel(&object, &atlas);
        let variances_mm2 = skin_variances_mm2();
        let heat_flow = HeatFlow::new(&object, &atlas, &stretch_mm, &variances_mm2);
        let fields = Fields::new(vec![irradiance(&atlas.charts)], stretch_mm);
        Self { size, charts: atlas.charts, fields, variances_mm2, heat_flow }
    }

    fn diffuse(&self, operator: &dyn DiffusionOperator, fields: Fields) -> Diffused {
        operator.diffuse(Arc::clone(&self.charts), fields, &self.variances_mm2, &Silent)
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
        let operators: [(&str, &dyn DiffusionOperator); 2] =
            [("separable", &Separable), ("heat flow", &patch.heat_flow)];
        for (name, operator) in operators {
            group.bench_function(BenchmarkId::new(name, size), |b| {
                b.iter_batched(
                    || patch.fields.clone(),
                    |fields| patch.diffuse(operator, fields),
                    BatchSize::LargeInput, // one input per batch below a thousand iterations
                );
            });
        }
    }
    group.finish();
}

/// Bytes that the rows of polynomials of a level must read and write: links of covered texels once, and maps of light, two
/// polynomials at a time. Those two are read, two others are written, and sums are read and written, but for the
/// first time. Edges of charts, halvings and copies are not counted.
fn moved_bytes(level: &Level) -> usize {
    let exchange = &level.exchange;
    let covered: usize = exchange.runs.iter().flatten().map(ExactSizeIterator::len).sum();
    let most = level.times.iter().map(Vec::len).max().unwrap_or(0);
    let of_sweep = |k: usize| {
        let sums = level.times.iter().filter(|time| k < time.len()).count();
        let sum_maps = if k == 0 { level.times.len() } else { 2 * sums };
        match most - k {
            1 => (1 + sum_maps) * LIGHT_BYTES,
            2 => (3 + sum_maps) * LIGHT_BYTES + LINK_BYTES,
            _ => (4 + sum_maps) * LIGHT_BYTES + LINK_BYTES,
        }
    };
    covered * (0..most).step_by(2).map(of_sweep).sum::<usize>()
}

/// Medians of all, s.
struct Medians {
    copies_s: f64,
    separable_s: f64,
    heat_flow_s: f64,
}

impl Medians {
    /// All in turn, so that a machine that grows slower is so for all. The first of each goes untimed: it meets
    /// memory that was never touched.
    fn measure(patch: &Patch) -> Self {
        let mut target = patch.fields.layers[0].clone();
        let (mut copies_s, mut separable_s, mut heat_flow_s) = (Vec::new(), Vec::new(), Vec::new());
        for _ in 0..=RUNS {
            copies_s.push(seconds(|| patch.copy_to(&mut target)));
            let fields = patch.fields.clone();
            separable_s.push(seconds(|| patch.diffuse(&Separable, fields)));
            let fields = patch.fields.clone();
            heat_flow_s.push(seconds(|| patch.diffuse(&patch.heat_flow, fields)));
        }
        let of = |times_s: &mut [f64]| median(&mut times_s[1..]);
        Self {
            copies_s: of(&mut copies_s),
            separable_s: of(&mut separable_s),
            heat_flow_s: of(&mut heat_flow_s),
        }
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

/// The ratios at every size as tables, and those of the largest as the last lines.
fn ratios() {
    if !common::reports_wanted() {
        return;
    }
    eprintln!("\ncpu: {}, median of {RUNS} runs", CpuRenderer.adapter());
    eprintln!("\n| texels | {COPIES} copies, s | separable, s | ratio |\n|---|---|---|---|");
    let mut flows = Vec::new();
    let mut largest = 0.0;
    for size in SIZES {
        let patch = Patch::new(size);
        let medians = Medians::measure(&patch);
        largest = medians.ratio();
        eprintln!("| {size}² | {:.4} | {:.4} | {largest:.2} |", medians.copies_s, medians.separable_s);
        flows.push(FlowReport::new(&patch, &medians));
    }
    eprintln!(
        "\n| texels | polynomials | heat flow, s | by separable | GB/s | copies, GB/s |\n|---|---|---|---|---|---|"
    );
    flows.iter().for_each(|flow| eprintln!("{}", flow.line()));
    eprintln!("\nseparable / {COPIES} copies = {largest:.2}");
}

/// What is told of heat flow.
struct FlowReport {
    size: usize,
    /// Polynomials of each level, the finest first.
    polynomials: Vec<usize>,
    heat_flow_s: f64,
    by_separable: f64,
    gb_per_s: f64,
    copies_gb_per_s: f64,
}

impl FlowReport {
    fn new(patch: &Patch, medians: &Medians) -> Self {
        let levels = &patch.heat_flow.levels;
        let most = |level: &Level| level.times.iter().map(Vec::len).max().unwrap_or(0);
        let moved_bytes: usize = levels.iter().map(moved_bytes).sum();
        let copied_bytes = 2 * COPIES * patch.size * patch.size * LIGHT_BYTES;
        Self {
            size: patch.size,
            polynomials: levels.iter().map(most).collect(),
            heat_flow_s: medians.heat_flow_s,
            by_separable: medians.heat_flow_s / medians.separable_s,
            gb_per_s: moved_bytes as f64 / medians.heat_flow_s * 1e-9,
            copies_gb_per_s: copied_bytes as f64 / medians.copies_s * 1e-9,
        }
    }

    fn line(&self) -> String {
        let polynomials: Vec<String> = self.polynomials.iter().map(usize::to_string).collect();
        format!(
            "| {}² | {} | {:.4} | {:.2} | {:.1} | {:.1} |",
            self.size,
            polynomials.join(" + "),
            self.heat_flow_s,
            self.by_separable,
            self.gb_per_s,
            self.copies_gb_per_s
        )
    }
}

criterion_group!(benches, diffusion);
criterion_main!(benches, ratios);
