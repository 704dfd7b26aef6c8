//! Frames on a graphics adapter beside the processor: the scanned head under one light and the environment, at the size
//! *low* (maps of 1024² texels). With a table of the passes.
#![allow(missing_docs, reason = "criterion's macros make public functions")]

mod common;

use criterion::{Criterion, SamplingMode, criterion_group, criterion_main};
use cutis_gpu::{Adapters, GpuRenderer};
use cutis_render::{CpuRenderer, PassTime, Renderer, Settings, Silent};
use cutis_scene::{Light, ReadOptions, Scene, read_scene};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Frames of which the quickest is told: the first ones meet shaders that were never run.
const FRAMES: usize = 5;

/// The size *low*: maps of 1024² texels, one sample a pixel.
fn low() -> Settings {
    Settings { width: 1024, height: 1024, samples_per_pixel: 1, irradiance_size: 1024, ..Settings::default() }
}

/// The scan under one point light without extent and the environment; none without the assets.
fn real_head() -> Option<Scene> {
    let given = std::env::var_os("CUTIS_ASSETS").filter(|value| !value.is_empty()).map(PathBuf::from);
    let usual = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/assets");
    let folder = given.unwrap_or_else(usual);
    if !folder.join("lee_perry_smith").is_dir() {
        eprintln!("no lee_perry_smith/ in CUTIS_ASSETS: nothing is measured");
        return None;
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/lee_perry_smith.toml");
    let options = ReadOptions { assets_folder: Some(folder), ..ReadOptions::default() };
    let mut scene = read_scene(&path, &options).expect("the scene of the scan is valid");
    scene.lights.truncate(1);
    if let Some(Light::Point { radius_mm, .. }) = scene.lights.first_mut() {
        *radius_mm = 0.0;
    }
    Some(scene)
}

fn frames(criterion: &mut Criterion) {
    let Some(scene) = real_head() else { return };
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
    let Some(scene) = real_head() else { return };
    let start = Instant::now();
    let frame = CpuRenderer.render(&scene, &low(), &Silent).expect("draws");
    table(&format!("cpu, {}", CpuRenderer.adapter()), start.elapsed(), &frame.passes);
    match GpuRenderer::new(Adapters::Any) {
        Ok(renderer) => gpu_tables(&renderer, &scene),
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

fn table(what: &str, total: Duration, passes: &[PassTime]) {
    eprintln!("\n{what}\n\n| pass | milliseconds |\n|---|---|");
    for pass in passes {
        eprintln!("| {} | {:.1} |", pass.name, pass.time.as_secs_f64() * 1e3);
    }
    eprintln!("| total | {:.1} |", total.as_secs_f64() * 1e3);
}

criterion_group!(benches, frames);
criterion_main!(benches, tables);
