//! Frames on a graphics adapter beside the processor: the scanned head under one light and the environment, at the size
//! *low* (maps of 1024² texels). With a table of the passes, and of what the sizes *low* and *full* move through memory.
#![allow(missing_docs, reason = "criterion's macros make public functions")]

mod common;

use criterion::{Criterion, SamplingMode, criterion_group, criterion_main};
use cutis_gpu::cost::{by_pass, total};
use cutis_gpu::{Adapters, GpuRenderer};
use cutis_render::settings::Quality;
use cutis_render::{CpuRenderer, PassTime, Renderer, Settings, Silent};
use cutis_scene::Scene;
use std::time::{Duration, Instant};

/// Frames of which the quickest is told: the first ones meet shaders that were never run.
const FRAMES: usize = 5;

/// The size *low*: maps of 1024² texels, one sample a pixel.
fn low() -> Settings {
    Settings::default().with_quality(Quality::Low)
}

/// Graphics cards and what their memories move, in 10⁹ bytes a second, as comparisons of cards list it (alldbin.com).
const CARDS: [(&str, f64); 3] =
    [("GeForce RTX 4090", 1008.0), ("GeForce RTX 3080", 760.0), ("GeForce RTX 3060", 360.0)];

fn frames(criterion: &mut Criterion) {
    let Some(scene) = common::real_head() else { return };
    let mut group = criterion.benchmark_group("gpu");
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    group.warm_up_time(Duration::from_secs(1)).measurement_time(Duration::from_secs(5));
    group.bench_function("cpu frame, low", |b| {
        b.iter(|| CpuRenderer.render(&scene, &low(), &Silent).expect("draws"));
    });
    if let Ok(renderer) = GpuRenderer::new(Adapters::Any) {
        let ready = renderer.scene(&scene, &low(), &Silent).expect("is uploaded");
        group.bench_function(format!("{} frame, low", renderer.adapter()), |b| {
            b.iter(|| {
                ready.draw(&renderer.gpu).expect("is drawn");
                renderer.gpu.wait().expect("the device is there");
            });
        });
    }
    group.finish();
}

/// What the documents quote.
fn tables() {
    if !common::reports_wanted() {
        return;
    }
    let Some(scene) = common::real_head() else { return };
    let start = Instant::now();
    let frame = CpuRenderer.render(&scene, &low(), &Silent).expect("draws");
    table(&format!("cpu, {}", CpuRenderer.adapter()), start.elapsed(), &frame.passes);
    match GpuRenderer::new(Adapters::Any) {
        Ok(renderer) => {
            gpu_tables(&renderer, &scene);
            [Quality::Low, Quality::Full].iter().for_each(|&quality| cost_table(&renderer, &scene, quality));
        }
        Err(error) => eprintln!("\n{error}"),
    }
}

fn gpu_tables(renderer: &GpuRenderer, scene: &Scene) {
    let start = Instant::now();
    let ready = renderer.scene(scene, &low(), &Silent).expect("is uploaded");
    let first = ready.draw_timed(&renderer.gpu).expect("the device is there");
    table(&format!("{}, from nothing to the first frame", renderer.adapter()), start.elapsed(), &first);
    let timed = || {
        let start = Instant::now();
        let passes = ready.draw_timed(&renderer.gpu).expect("the device is there");
        (start.elapsed(), passes)
    };
    let quickest = (0..FRAMES).map(|_| timed()).min_by_key(|(time, _)| *time);
    if let Some((time, passes)) = quickest {
        table(&format!("{}, quickest of {FRAMES} frames", renderer.adapter()), time, &passes);
    }
}

/// What a steady frame moves, and how long that takes at least.
fn cost_table(renderer: &GpuRenderer, scene: &Scene, quality: Quality) {
    let settings = Settings { ambient_samples: 1, ..Settings::default().with_quality(quality) };
    let ready = renderer.scene(scene, &settings, &Silent).expect("is uploaded");
    let costs = ready.costs();
    eprintln!("\nquality {quality}, {:.0} MB kept\n", ready.memory_bytes() as f64 * 1e-6);
    eprint!("| pass | MB read | MB written | million taps |");
    CARDS.iter().for_each(|(card, gigabytes_per_s)| eprint!(" ms, {card} ({gigabytes_per_s} GB/s) |"));
    eprintln!("\n|---|---|---|---|{}", "---|".repeat(CARDS.len()));
    for cost in by_pass(&costs).into_iter().chain([total(&costs)]) {
        let megabytes = [cost.read_bytes, cost.written_bytes].map(|bytes| bytes as f64 * 1e-6);
        eprint!("| {} | {:.1} | {:.1} |", cost.pass, megabytes[0], megabytes[1]);
        eprint!(" {:.1} |", cost.taps as f64 * 1e-6);
        CARDS.iter().for_each(|(_, memory)| eprint!(" {:.3} |", cost.milliseconds(*memory)));
        eprintln!();
    }
}

fn table(what: &str, total: Duration, passes: &[PassTime]) {
    eprintln!("\n{what}\n\n| pass | milliseconds |\n|---|---|");
    for pass in passes {
        eprintln!("| {} | {:.1} |", pass.name, pass.time.as_secs_f64() * 1e3);
    }
    eprintln!("| total | {:.1} |", total.as_secs_f64() * 1e3);
}

criterion_group!(benches, frames);
criterion_main!(benches, tables);
