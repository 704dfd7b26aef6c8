//! What the technique refuses, and what it goes on from: the same samples give the same bits.
#![allow(clippy::unwrap_used, reason = "tests")]

use super::render;
use crate::film::Checkpoint;
use crate::settings::{Aov, AovSpace, Settings};
use crate::transport::tests::{ball, even_environment, material, scene_of};
use crate::{Frame, RenderError, Silent};
use cutis_scene::{Light, NormalMap, NormalSpace, ScalarMap, Scene, Texels, Texture};
use glam::Vec3;
use std::sync::Arc;

fn lamp(radius_mm: f32) -> Light {
    Light::Point {
        position_mm: Vec3::new(40.0, 60.0, 70.0),
        intensity_w_per_sr: Vec3::new(0.03, 0.02, 0.01),
        radius_mm,
    }
}

fn ball_in_light(roughness: f32, radius_mm: f32) -> Scene {
    let object = ball(10.0, 12, material(0.1, 1.0, 1.4, roughness));
    scene_of(vec![object], vec![lamp(radius_mm)], Some(even_environment()))
}

fn small(samples_per_pixel: u32) -> Settings {
    Settings { width: 16, height: 12, samples_per_pixel, seed: 5, ..Settings::default() }
}

fn drawn(scene: &Scene, settings: &Settings) -> Frame {
    render(scene, settings, &Silent).unwrap()
}

/// Why the technique refuses to draw.
fn refusal(scene: &Scene, settings: &Settings) -> String {
    render(scene, settings, &Silent).unwrap_err().to_string()
}

fn assert_same_bits(a: &Frame, b: &Frame) {
    let bits = |frame: &Frame| -> Vec<[u32; 4]> {
        let layers = frame.layers.iter().flat_map(|layer| &layer.pixels);
        frame.pixels.iter().chain(layers).map(|p| p.to_array().map(f32::to_bits)).collect()
    };
    assert!(a.pixels.iter().any(|p| p.x > 0.0), "there is something to be seen");
    assert_eq!(bits(a), bits(b));
}

#[test]
fn going_on_gives_what_doing_it_at_once_gives() {
    let folder = tempfile::tempdir().unwrap();
    let scene = ball_in_light(0.4, 8.0);
    let checkpoint = Some(Checkpoint { path: folder.path().join("ball.paths") });
    let aovs = vec![Aov::Diffuse, Aov::Specular, Aov::StandardError];
    let settings = |samples, checkpoint: &Option<Checkpoint>| Settings {
        aovs: aovs.clone(),
        checkpoint: checkpoint.clone(),
        ..small(samples)
    };
    let half = drawn(&scene, &settings(8, &checkpoint));
    let whole = drawn(&scene, &settings(16, &checkpoint));
    assert_same_bits(&whole, &drawn(&scene, &settings(16, &None)));
    assert_ne!(half.pixels, whole.pixels, "the second half of the samples adds something");
    // Once there are enough, nothing is added.
    assert_same_bits(&whole, &drawn(&scene, &settings(16, &checkpoint)));
}

#[test]
fn a_thickness_scale_is_not_known_and_that_is_told() {
    let scene = ball_in_light(0.4, 8.0);
    let plain = drawn(&scene, &small(2));
    assert!(plain.warnings.is_empty(), "{:?}", plain.warnings);
    let mut scaled = scene.clone();
    scaled.objects[0].material.thickness_scale = 2.5;
    let scaled = drawn(&scaled, &small(2));
    assert_same_bits(&plain, &scaled);
    assert!(scaled.warnings[0].contains("does not know the thickness scale of 2.5"), "{:?}", scaled.warnings);
}

#[test]
fn a_scaled_mean_free_path_is_not_known_and_that_is_told() {
    let scene = ball_in_light(0.4, 8.0);
    let mut scaled = scene.clone();
    scaled.objects[0].material.mean_free_path_scale = ScalarMap::constant(2.0);
    let (plain, scaled) = (drawn(&scene, &small(2)), drawn(&scaled, &small(2)));
    assert_same_bits(&plain, &scaled);
    assert!(scaled.warnings[0].contains("only the diffusion heat-flow"), "{:?}", scaled.warnings);
}

#[test]
fn the_samples_that_were_taken_are_told() {
    let scene = ball_in_light(0.4, 8.0);
    let frame = drawn(&scene, &Settings { aovs: vec![Aov::Samples], ..small(3) });
    let pixels = &frame.layers[0].pixels;
    assert!(pixels.iter().all(|p| p.y == 3.0 && p.x <= 3.0 && p.x.fract() == 0.0), "{pixels:?}");
    assert!(pixels.iter().any(|p| p.x == 3.0), "the ball is met");
}

#[test]
fn exitance_goes_on_where_it_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let scene = ball_in_light(0.4, 8.0);
    let transport = crate::transport::path::Transport::new(&scene, 1).unwrap();
    for start in [super::Start::Light, super::Start::Texel] {
        let path = folder.path().join(format!("{start:?}.paths"));
        let settings = |samples, checkpoint: Option<Checkpoint>| Settings {
            irradiance_size: 64,
            checkpoint,
            ..small(samples)
        };
        let map = |settings: &Settings| super::ExitanceMap::starting(start, &transport, settings, &Silent);
        let kept = Some(Checkpoint { path: path.clone() });
        let half = map(&settings(3, kept.clone())).unwrap();
        let whole = map(&settings(6, kept.clone())).unwrap();
        let at_once = map(&settings(6, None)).unwrap();
        assert_ne!(half.exitance_w_per_m2, whole.exitance_w_per_m2);
        assert_eq!(whole.exitance_w_per_m2, at_once.exitance_w_per_m2, "{start:?}");
        assert_eq!(whole.standard_error_w_per_m2, at_once.standard_error_w_per_m2, "{start:?}");
        let other = Settings { irradiance_size: 32, ..settings(6, kept) };
        assert!(matches!(map(&other), Err(RenderError::Checkpoint { .. })));
    }
}

#[test]
fn a_checkpoint_of_something_else_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ball.paths");
    let settings = Settings { checkpoint: Some(Checkpoint { path: path.clone() }), ..small(2) };
    let scene = ball_in_light(0.4, 8.0);
    drawn(&scene, &settings);
    let kept = std::fs::read(&path).unwrap();
    let mut reliefed = scene.clone();
    let texels = Texels::LinearF32(vec![[0.5, 0.5, 1.0, 1.0]; 4]);
    let texture = Arc::new(Texture::new(2, 2, texels));
    reliefed.objects[0].material.normal =
        Some(NormalMap { texture, space: NormalSpace::Tangent, strength: 1.0 });
    let mut flipped = scene.clone();
    flipped.objects[0].mesh.uvs.iter_mut().for_each(|uv| uv.y = 1.0 - uv.y);
    let others = [
        ("relief", reliefed, settings.clone()),
        ("mapping", flipped, settings.clone()),
        ("seed", scene.clone(), Settings { seed: 6, ..settings.clone() }),
        ("size", scene.clone(), Settings { width: 12, height: 16, ..settings.clone() }),
        ("light", ball_in_light(0.4, 9.0), settings.clone()),
        ("material", ball_in_light(0.5, 8.0), settings.clone()),
    ];
    for (what, scene, settings) in others {
        let refused = render(&scene, &settings, &Silent).unwrap_err();
        assert!(matches!(refused, RenderError::Checkpoint { .. }), "another {what}: {refused}");
        let words = refused.to_string();
        assert!(words.contains("another scene, size or seed") && words.contains("ball.paths"), "{words}");
    }
    assert_eq!(std::fs::read(&path).unwrap(), kept, "it is left as it was");
}

#[test]
fn an_open_body_is_refused_or_closed() {
    let mut scene = ball_in_light(0.4, 8.0);
    // A hole at the top.
    scene.objects[0].mesh.triangles.drain(0..24);
    let words = refusal(&scene, &small(4));
    assert!(["'ball'", "open", "--close-holes"].iter().all(|word| words.contains(word)), "{words}");
    let frame = drawn(&scene, &Settings { close_holes: true, ..small(4) });
    assert!(frame.pixels.iter().any(|p| p.x > 0.0));
    // Turned around one triangle has no inside to be closed.
    let mut scene = ball_in_light(0.4, 8.0);
    scene.objects[0].mesh.triangles[40].swap(1, 2);
    let words = refusal(&scene, &Settings { close_holes: true, ..small(4) });
    assert!(words.contains("outside is not clear"), "{words}");
}

#[test]
fn light_that_no_path_finds_is_refused() {
    let words = refusal(&ball_in_light(0.0, 0.0), &small(4));
    assert!(
        ["'ball'", "too smooth", "radius", "roughness"].iter().all(|word| words.contains(word)),
        "{words}"
    );
    // Either helps.
    drawn(&ball_in_light(0.3, 0.0), &small(1));
    drawn(&ball_in_light(0.0, 8.0), &small(1));
    // Roughness shows nothing where light passes straight.
    let mut matched = ball_in_light(0.3, 0.0);
    matched.objects[0].material = material(0.1, 1.0, 1.0, 0.3);
    assert!(refusal(&matched, &small(4)).contains("too smooth"));
}

#[test]
fn layers_that_are_not_known_are_refused_by_name() {
    let scene = ball_in_light(0.4, 8.0);
    for (space, aov) in [
        (AovSpace::Picture, Aov::Thickness),
        (AovSpace::Picture, Aov::Exitance),
        (AovSpace::Texture, Aov::Diffuse),
    ] {
        let words = refusal(&scene, &Settings { aovs: vec![aov], aov_space: space, ..small(4) });
        assert!(words.contains(&aov.to_string()) && words.contains("standard-error"), "{words}");
    }
}

#[test]
fn a_kernel_without_a_medium_is_refused() {
    let mut scene = ball_in_light(0.4, 8.0);
    let kernel = cutis_optics::presets::find("three-layer-skin").unwrap().kernel(6).unwrap();
    scene.objects[0].material.scattering = cutis_scene::Scattering::Kernel(kernel);
    assert!(refusal(&scene, &small(4)).contains("needs the medium behind it"));
}

#[test]
fn threads_change_no_bit() {
    let scene = ball_in_light(0.4, 8.0);
    let of_threads = |threads: usize, settings: &Settings| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| drawn(&scene, settings))
    };
    let picture = Settings { aovs: vec![Aov::StandardError], ..small(8) };
    assert_same_bits(&of_threads(1, &picture), &of_threads(2, &picture));
    // Where exitance starts is told by counted work, not by a clock.
    let map = Settings {
        irradiance_size: 64,
        aov_space: AovSpace::Texture,
        aovs: vec![Aov::Exitance, Aov::StandardError],
        ..small(2)
    };
    let [one, two] = [1, 2].map(|threads| of_threads(threads, &map).layers);
    assert!(one[0].pixels.iter().any(|e| e.x > 0.0));
    one.iter().zip(&two).for_each(|(one, two)| assert_eq!(one.pixels, two.pixels, "{}", one.name));
    // Packets that the threads count into one map, and paths at its texels.
    let transport = crate::transport::path::Transport::new(&scene, 1).unwrap();
    let settings = Settings { irradiance_size: 128, ..small(2) };
    for start in [super::Start::Light, super::Start::Texel] {
        let [one, two] = [1, 2].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| super::ExitanceMap::starting(start, &transport, &settings, &Silent).unwrap())
        });
        assert!(one.exitance_w_per_m2.iter().any(|e| e.x > 0.0));
        assert_eq!(one.exitance_w_per_m2, two.exitance_w_per_m2, "{start:?}");
        assert_eq!(one.standard_error_w_per_m2, two.standard_error_w_per_m2, "{start:?}");
    }
}
