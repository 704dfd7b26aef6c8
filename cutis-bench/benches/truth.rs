//! Light transport in a mesh: paths from the eye and packets from a lamp, in the built-in head of the medium skin1, on one
//! thread and on two.
#![allow(missing_docs, reason = "criterion's macros make public functions")]

use criterion::{BenchmarkId, Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use cutis_render::transport::exitance::Entrances;
use cutis_render::transport::path::Transport;
use cutis_render::{CpuRenderer, Renderer, Settings, Silent, TechniqueName};
use cutis_scene::head::{HeadDetail, built_in};
use cutis_scene::{Camera, ColourMap, Light, Scattering, Scene};
use glam::Vec3;

/// Side of the picture, pixels, and paths of each pixel.
const SIZE: u32 = 96;
const SAMPLES: u32 = 4;
/// Packets from the lamp.
const PACKETS: u64 = 20_000;

/// The head in the light of one lamp, in front of a camera.
fn scene() -> Scene {
    let mut head = built_in(HeadDetail { triangles: 100_000, map_size: 0 });
    head.material.scattering = Scattering::Preset("skin1".to_owned());
    head.material.albedo = ColourMap { factor: Vec3::ONE, texture: None };
    let bounds_mm = head.mesh.bounds_mm().expect("the head has vertices");
    let lamp = Light::Point {
        position_mm: Vec3::new(-300.0, 250.0, 600.0),
        intensity_w_per_sr: Vec3::ONE,
        radius_mm: 40.0,
    };
    Scene {
        camera: Camera::framing(bounds_mm, Vec3::Z, 0.44),
        objects: vec![head],
        lights: vec![lamp],
        environment: None,
        background: None,
        warnings: Vec::new(),
    }
}

fn truth(criterion: &mut Criterion) {
    let scene = scene();
    let settings = Settings {
        technique: TechniqueName::Truth,
        width: SIZE,
        height: SIZE,
        samples_per_pixel: SAMPLES,
        ..Settings::default()
    };
    let transport = Transport::new(&scene, 1).expect("the head can be simulated");
    let entrances = Entrances::new(&transport);
    let mut group = criterion.benchmark_group("truth");
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads are at hand");
        group.throughput(Throughput::Elements(u64::from(SIZE * SIZE * SAMPLES)));
        group.bench_function(BenchmarkId::new("picture, camera rays", threads), |b| {
            b.iter(|| {
                pool.install(|| CpuRenderer.render(&scene, &settings, &Silent).expect("it can be drawn"))
            });
        });
        group.throughput(Throughput::Elements(PACKETS));
        group.bench_function(BenchmarkId::new("exitance, packets", threads), |b| {
            b.iter(|| {
                let mut exits = 0u64;
                pool.install(|| entrances.walk(1, 0, PACKETS, |_| exits += 1));
                exits
            });
        });
    }
    group.finish();
}

criterion_group!(benches, truth);
criterion_main!(benches);
