//! Heat flow beside the separable blur on the scanned head: error against time. With a table for every size of the maps, of
//! which the documents quote; times are those of six Gaussians, errors those of three of them against the direct convolution.
#![allow(missing_docs, reason = "criterion's macros make public functions")]

mod common;
#[path = "../../cutis-render/tests/common/convolution.rs"]
#[allow(dead_code, reason = "tests use the rest")]
mod convolution;

use convolution::{Direct, Place, Spread, VARIANCES_MM2, compared, errors, pattern};
use criterion::{BenchmarkId, Criterion, SamplingMode, criterion_group, criterion_main};
use cutis_gpu::{Adapters, GpuRenderer};
use cutis_optics::presets;
use cutis_render::passes::atlas::Atlas;
use cutis_render::passes::blur::Fields;
use cutis_render::passes::diffusion::{Diffused, DiffusionOperator, Separable};
use cutis_render::passes::heat_flow::{HeatFlow, Level};
use cutis_render::passes::stretch::stretch_mm_per_texel;
use cutis_render::{CpuRenderer, Diffusion, Renderer, Settings, Silent};
use cutis_scene::{Object, Scene};
use glam::{Vec2, Vec4};
use rayon::prelude::*;
use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Sides of the maps, texels.
const SIZES: [usize; 7] = [256, 384, 512, 768, 1024, 1536, 2048];
/// Timed runs of which the quickest counts.
const RUNS: usize = 3;

/// The head under a pattern of light, on maps of one size.
struct Lit<'a> {
    object: &'a Object,
    atlas: Atlas,
    stretch_mm: Vec<Vec2>,
    light: Arc<Vec<Vec<Vec4>>>,
    variances_mm2: Vec<f32>,
}

impl<'a> Lit<'a> {
    fn new(object: &'a Object, size: usize) -> Self {
        let atlas = Atlas::new(object, size);
        let lit = |i: usize| {
            let point = atlas.surface_point(object, i);
            point.map_or(Vec4::ZERO, |p| Vec4::splat(pattern(p.position_mm)))
        };
        let light = Arc::new(vec![(0..size * size).map(lit).collect()]);
        let stretch_mm = stretch_mm_per_texel(object, &atlas);
        Self { object, atlas, stretch_mm, light, variances_mm2: skin_variances_mm2() }
    }

    fn flow(&self) -> HeatFlow {
        HeatFlow::new(self.object, &self.atlas, &self.stretch_mm, &self.variances_mm2)
    }

    fn diffuse(&self, operator: &dyn DiffusionOperator) -> Diffused {
        let fields = Fields { layers: Arc::clone(&self.light), stretch_mm: self.stretch_mm.clone() };
        operator.diffuse(Arc::clone(&self.atlas.charts), fields, &self.variances_mm2, &Silent)
    }
}

/// Those of three-layer skin; its three widest are those that are compared.
fn skin_variances_mm2() -> Vec<f32> {
    let preset = presets::find("three-layer-skin").expect("the skin kernel is a preset");
    let kernel = preset.kernel(6).expect("a finished kernel needs no fit");
    kernel.variances_mm2.iter().map(|&v| v as f32).collect()
}

/// What is compared, and what it should be.
struct Wanted<'a> {
    object: &'a Object,
    /// Everywhere and near seams: places, and the convolution by each variance there.
    sets: [(Vec<Place>, [Vec<f32>; 3]); 2],
}

impl<'a> Wanted<'a> {
    fn new(object: &'a Object) -> Self {
        let direct = Direct::new(object);
        let exact =
            |places: &[Place], v: f32| places.par_iter().map(|p| direct.at(p.position_mm, v)).collect();
        let set = |places: Vec<Place>| {
            let all = VARIANCES_MM2.map(|v| exact(&places, v));
            (places, all)
        };
        Self { object, sets: compared(object).map(set) }
    }

    /// Root mean square of the errors of all three Gaussians, percent of the mean: everywhere and near seams.
    fn errors(&self, spread: &Spread, first_level: usize) -> [f32; 2] {
        self.sets.each_ref().map(|(places, exact)| {
            let squares = exact.iter().enumerate().map(|(n, exact)| {
                let pairs = places.iter().map(|p| spread.at(self.object, first_level + n, p));
                let [rms, _] = errors(&pairs.zip(exact.iter().copied()).collect::<Vec<_>>());
                rms * rms
            });
            (squares.sum::<f32>() / exact.len() as f32).sqrt()
        })
    }
}

/// Of the quickest of a few runs, s.
fn quickest_s<T>(mut work: impl FnMut() -> T) -> f64 {
    let timed = |_| {
        let start = Instant::now();
        let result = black_box(work());
        let elapsed_s = start.elapsed().as_secs_f64();
        drop(result);
        elapsed_s
    };
    (0..RUNS).map(timed).fold(f64::INFINITY, f64::min)
}

fn operators(criterion: &mut Criterion) {
    let Some(scene) = common::real_head() else { return };
    let mut group = criterion.benchmark_group("heat flow");
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    group.warm_up_time(Duration::from_secs(1)).measurement_time(Duration::from_secs(5));
    for size in [512, 1024] {
        let lit = Lit::new(&scene.objects[0], size);
        let flow = lit.flow();
        group.bench_function(BenchmarkId::new("links", size), |b| b.iter(|| lit.flow()));
        group.bench_function(BenchmarkId::new("heat flow", size), |b| b.iter(|| lit.diffuse(&flow)));
        group.bench_function(BenchmarkId::new("separable", size), |b| b.iter(|| lit.diffuse(&Separable)));
    }
    group.finish();
}

/// Error and time of both, for every size.
fn table() {
    if !common::reports_wanted() {
        return;
    }
    let Some(scene) = common::real_head() else { return };
    let object = &scene.objects[0];
    let wanted = Wanted::new(object);
    let first = skin_variances_mm2().len() - VARIANCES_MM2.len() + 1;
    let adapter = GpuRenderer::new(Adapters::Any).ok();
    let name = adapter.as_ref().map_or("no adapter".to_owned(), GpuRenderer::adapter);
    eprintln!("\ncpu: {}; adapter: {name}; quickest of {RUNS} runs\n", CpuRenderer.adapter());
    eprintln!(
        "| operator | texels | polynomials | links, s | in a pose, s | light, s | adapter, s | error, % | near seams, % |\n|---|---|---|---|---|---|---|---|---|"
    );
    for size in SIZES {
        let lit = Lit::new(object, size);
        let links_s = quickest_s(|| lit.flow());
        let flow = lit.flow();
        let mut posed = flow.clone().for_all_poses();
        let pose_s = quickest_s(|| posed.set_pose(object));
        let both: [(Diffusion, &dyn DiffusionOperator, [f64; 2]); 2] =
            [(Diffusion::Separable, &Separable, [0.0; 2]), (Diffusion::HeatFlow, &flow, [links_s, pose_s])];
        for (diffusion, operator, [links_s, pose_s]) in both {
            let polynomials =
                if diffusion == Diffusion::HeatFlow { polynomials(&flow) } else { "–".to_owned() };
            let light_s = quickest_s(|| lit.diffuse(operator));
            let [error, near] = wanted.errors(&Spread { diffused: lit.diffuse(operator) }, first);
            let on_adapter_s = adapter.as_ref().map_or(f64::NAN, |a| adapter_s(a, &scene, diffusion, size));
            eprintln!(
                "| {diffusion} | {size}² | {polynomials} | {links_s:.3} | {pose_s:.3} | {light_s:.3} | {on_adapter_s:.3} | {error:.2} | {near:.2} |"
            );
        }
    }
}

/// Polynomials of every level, the finest first.
fn polynomials(flow: &HeatFlow) -> String {
    let most = |level: &Level| level.times.iter().map(Vec::len).max().unwrap_or(0).to_string();
    flow.levels.iter().map(most).collect::<Vec<_>>().join(" + ")
}

/// Time of one layer of light in a frame of a scene that is there, s; for the blur with the taps that it takes from the stretch.
fn adapter_s(renderer: &GpuRenderer, scene: &Scene, diffusion: Diffusion, size: usize) -> f64 {
    let settings =
        Settings { diffusion, irradiance_size: size as u32, width: 64, height: 64, ..Settings::default() };
    let ready = renderer.scene(scene, &settings, &Silent).expect("is uploaded");
    let timed_s = |_| -> f64 {
        // So that the stretch is new, and with it the taps.
        ready.set_pose(&renderer.gpu, scene, &scene.pose()).expect("is the pose that it has");
        let passes = ready.draw_timed(&renderer.gpu).expect("the device is there");
        let own = passes.iter().filter(|pass| ["taps", "blur", "heat flow"].contains(&pass.name.as_str()));
        own.map(|pass| pass.time.as_secs_f64()).sum()
    };
    // The first one meets shaders that were never run.
    (0..=RUNS).map(timed_s).skip(1).fold(f64::INFINITY, f64::min)
}

criterion_group!(benches, operators);
criterion_main!(benches, table);
