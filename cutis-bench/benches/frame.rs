//! Whole pictures: the built-in head in the studio, one setting varied at a time, and where the shelf of assets is at
//! hand the scanned head with the time of each pass.
//!
//! A kernel that has to be fitted is fitted beforehand: the bench `optics` times that.
#![allow(missing_docs, reason = "criterion's macros make public functions")]

mod common;

use criterion::{BenchmarkId, Criterion, SamplingMode, criterion_group, criterion_main};
use cutis_optics::{RgbGaussianSum, presets};
use cutis_render::{CpuRenderer, Frame, Renderer, Settings, Silent};
use cutis_scene::head::{HeadDetail, built_in};
use cutis_scene::studio::{studio_environment, studio_lights};
use cutis_scene::{Camera, Light, ReadOptions, Scattering, Scene, read_scene};
use glam::Vec3;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::time::{Duration, Instant};

/// Angle between the upper and the lower edge of the picture, rad: 25°, as the program takes for its head.
const HEAD_FOV_RAD: f32 = 0.436_332_3;
/// Triangles of the head where something else is varied.
const TRIANGLES: usize = 100_000;
/// Side of the head's maps, texels.
const MAP_SIZE: u32 = 1024;
/// Side of the picture of the built-in head, pixels.
const PICTURE_SIZE: u32 = 512;
/// Side of the irradiance texture where something else is varied, texels.
const IRRADIANCE_SIZE: u32 = 1024;

/// One picture to be timed.
struct Case {
    /// What is varied.
    what: &'static str,
    /// Its value here.
    value: String,
    scene: Scene,
    settings: Settings,
}

/// Made once: heads of half a million triangles take a while.
static CASES: LazyLock<Vec<Case>> = LazyLock::new(cases);

impl Case {
    fn new(what: &'static str, value: impl ToString, scene: Scene) -> Self {
        let settings = Settings {
            width: PICTURE_SIZE,
            height: PICTURE_SIZE,
            irradiance_size: IRRADIANCE_SIZE,
            ..Settings::default()
        };
        Self { what, value: value.to_string(), scene, settings }
    }

    fn render(&self) -> Frame {
        CpuRenderer.render(&self.scene, &self.settings, &Silent).expect("scene and settings are valid")
    }
}

fn cases() -> Vec<Case> {
    let studio = studio(TRIANGLES);
    let groups = [by_irradiance_size(&studio), by_lights(&studio), by_gaussians(&studio), by_triangles()];
    groups.into_iter().flatten().collect()
}

fn by_irradiance_size(studio: &Scene) -> Vec<Case> {
    let case = |size: u32| {
        let mut case = Case::new("irradiance size", size, studio.clone());
        case.settings.irradiance_size = size;
        case
    };
    [512, 1024, 2048].map(case).into()
}

/// Key; key and rim; both and their mirror images.
fn by_lights(studio: &Scene) -> Vec<Case> {
    let mirrored = studio.lights.iter().map(mirror_image);
    let lights: Vec<Light> = studio.lights.iter().cloned().chain(mirrored).collect();
    assert_eq!(lights.len(), 4, "the studio has two lights");
    let case = |count: usize| {
        Case::new("lights", count, Scene { lights: lights[..count].to_vec(), ..studio.clone() })
    };
    [1, 2, 4].map(case).into()
}

/// Marble, whose kernel gets as many Gaussians as asked for; skin has six once and for all.
fn by_gaussians(studio: &Scene) -> Vec<Case> {
    let case = |gaussians: usize| {
        let kernel = marble(gaussians);
        let value = match kernel.len() {
            kept if kept == gaussians => gaussians.to_string(),
            kept => format!("{gaussians}, {kept} kept"),
        };
        let mut scene = studio.clone();
        for object in &mut scene.objects {
            object.material.scattering = Scattering::Kernel(kernel.clone());
        }
        Case::new("gaussians", value, scene)
    };
    [2, 4, 6, 8].map(case).into()
}

fn by_triangles() -> Vec<Case> {
    let case = |triangles: usize| Case::new("triangles", triangles, studio(triangles));
    [10_000, 100_000, 500_000].map(case).into()
}

/// The built-in head as the program shows it when no scene is given.
fn studio(triangles: usize) -> Scene {
    let head = built_in(HeadDetail { triangles, map_size: MAP_SIZE });
    let bounds_mm = head.mesh.bounds_mm().expect("the head is not empty");
    Scene {
        background: None,
        objects: vec![head],
        lights: studio_lights(bounds_mm),
        environment: Some(studio_environment()),
        camera: Camera::framing(bounds_mm, Vec3::Z, HEAD_FOV_RAD),
        warnings: Vec::new(),
    }
}

/// The same light on the other side of the face.
fn mirror_image(light: &Light) -> Light {
    let mut light = light.clone();
    match &mut light {
        Light::Directional { dir_to_light, .. } => dir_to_light.x = -dir_to_light.x,
        Light::Point { position_mm, .. } => position_mm.x = -position_mm.x,
        Light::Spot { position_mm, dir_travel, .. } => {
            position_mm.x = -position_mm.x;
            dir_travel.x = -dir_travel.x;
        }
        Light::Projector(projector) => {
            projector.position_mm.x = -projector.position_mm.x;
            projector.axes.iter_mut().for_each(|axis| axis.x = -axis.x);
        }
    }
    light
}

fn marble(gaussians: usize) -> RgbGaussianSum {
    let preset = presets::find("marble").expect("marble is a preset");
    preset.kernel(gaussians).expect("marble can be fitted")
}

fn frames(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("frame");
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    group.warm_up_time(Duration::from_secs(1)).measurement_time(Duration::from_secs(5));
    for case in CASES.iter() {
        group.bench_function(BenchmarkId::new(case.what, &case.value), |b| b.iter(|| case.render()));
    }
    group.finish();
}

/// What the README quotes: one run each.
fn tables() {
    if !common::reports_wanted() {
        return;
    }
    eprintln!("\ncpu: {}, one run each", CpuRenderer.adapter());
    built_in_head_table();
    match assets_with_real_head() {
        Some(assets) => real_head_table(assets),
        None => eprintln!("\nno lee_perry_smith/ in CUTIS_ASSETS: the scanned head is left out"),
    }
}

fn built_in_head_table() {
    head_of_table();
    // Untimed: the first picture meets memory that was never touched.
    CASES.first().expect("there are cases").render();
    for case in CASES.iter() {
        row(case.what, &case.value, timed(case).1);
    }
}

fn real_head_table(assets: PathBuf) {
    let case = real_head(assets);
    head_of_table();
    let (frame, total) = timed(&case);
    for pass in &frame.passes {
        row(case.what, &pass.name, pass.time);
    }
    row(case.what, "total", total);
}

/// The scan under one point light without extent and the environment, drawn at full size.
fn real_head(assets: PathBuf) -> Case {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/lee_perry_smith.toml");
    let options = ReadOptions { assets_folder: Some(assets), ..ReadOptions::default() };
    let mut scene = read_scene(&path, &options).expect("the scene of the scan is valid");
    scene.lights.truncate(1);
    let Some(Light::Point { radius_mm, .. }) = scene.lights.first_mut() else {
        panic!("the first light of the scene is its key, a point light");
    };
    *radius_mm = 0.0;
    assert!(scene.environment.is_some(), "the scene has an environment");
    let settings = Settings {
        width: 1024,
        height: 1024,
        samples_per_pixel: 4,
        irradiance_size: 2048,
        ..Settings::default()
    };
    Case { what: "Lee Perry-Smith", value: "one light".to_owned(), scene, settings }
}

/// The shelf of assets, if the scan lies on it.
fn assets_with_real_head() -> Option<PathBuf> {
    let given = std::env::var_os("CUTIS_ASSETS").filter(|value| !value.is_empty()).map(PathBuf::from);
    let usual = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/assets");
    let folder = given.unwrap_or_else(usual);
    folder.join("lee_perry_smith").is_dir().then_some(folder)
}

fn timed(case: &Case) -> (Frame, Duration) {
    let start = Instant::now();
    let frame = case.render();
    (frame, start.elapsed())
}

fn head_of_table() {
    eprintln!("\n| what | value | seconds |\n|---|---|---|");
}

fn row(what: &str, value: &str, time: Duration) {
    eprintln!("| {what} | {value} | {:.3} |", time.as_secs_f64());
}

criterion_group!(benches, frames);
criterion_main!(benches, tables);
