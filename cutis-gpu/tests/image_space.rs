//! Image-space sampling on both backends.

mod common;

use common::tolerances::{self, Tolerance};
use common::{difference, head_in_the_studio, patch, patch_under_a_spot, renderer, small_frame};
use cutis_render::settings::TechniqueSettings;
use cutis_render::technique::image_space::{ImageSpaceProfile, ImageSpaceSettings, SampleCount};
use cutis_render::{Aov, CpuRenderer, Frame, Renderer, Settings, Silent, TechniqueName};
use cutis_scene::validation::shapes;
use cutis_scene::{Camera, Light, Object, ScalarMap, Scattering, Scene, SecondMedium, Texels, Texture};
use glam::Vec3;
use std::sync::Arc;

fn settings(image_space: ImageSpaceSettings) -> Settings {
    Settings {
        technique: TechniqueName::ImageSpace,
        techniques: TechniqueSettings { image_space, ..TechniqueSettings::default() },
        // One sample a pixel: both look from the same places.
        samples_per_pixel: 1,
        aovs: vec![Aov::Diffuse, Aov::Transmission],
        ..small_frame()
    }
}

fn on_both(test: &str, scene: &Scene, settings: &Settings) -> Option<[Frame; 2]> {
    let renderer = renderer(test)?;
    let cpu = CpuRenderer.render(scene, settings, &Silent).expect("draws");
    let gpu = renderer.render(scene, settings, &Silent).expect("draws");
    Some([cpu, gpu])
}

/// Compares a layer of both frames where both show a body.
fn same_layer(test: &str, [cpu, gpu]: &[Frame; 2], layer: usize, allowed: Tolerance) {
    let covered = |i: usize| cpu.pixels[i].w > 0.99 && gpu.pixels[i].w > 0.99;
    difference(&gpu.layers[layer].pixels, &cpu.layers[layer].pixels, covered).check(test, allowed);
}

#[test]
fn a_patch_under_a_spot() {
    let test = "image-space: a patch under a spot";
    let scene = patch_under_a_spot(patch(|u| 40.0 * u, |v| 40.0 * v));
    if let Some(frames) = on_both(test, &scene, &settings(ImageSpaceSettings::default())) {
        same_layer(test, &frames, 0, tolerances::SAMPLED_PATCH);
    }
}

/// Every number other than usual, so that each is missed where it is not handed on.
#[test]
fn the_built_in_head_by_other_numbers() {
    let test = "image-space: the built-in head";
    let mut scene = head_in_the_studio();
    scene.objects[0].material.scattering = Scattering::Preset("skin1".to_owned());
    let other = ImageSpaceSettings {
        samples: 90,
        uniform_samples: 45,
        uniform_radius_mm: Some(9.0),
        jacobian: false,
        count: SampleCount::All,
        light_views: true,
        profile: ImageSpaceProfile::Gaussians,
        round: 3,
    };
    // Colour and relief of the head are finer than a pixel.
    let settings = Settings { samples_per_pixel: 9, ..settings(other) };
    if let Some(frames) = on_both(test, &scene, &settings) {
        same_layer(test, &frames, 0, tolerances::SAMPLED_HEAD);
    }
}

/// Two media, mixed by another channel of a map of few texels, in another round: every pixel takes the mixture that it takes on
/// the processor.
#[test]
fn a_patch_of_two_media() {
    let test = "image-space: a patch of two media";
    let mut scene = patch_under_a_spot(patch(|u| 40.0 * u, |v| 40.0 * v));
    let texels = [0.0, 0.4, 0.9, 0.2, 1.0, 0.6, 0.3, 0.7, 0.1].map(|share| [0.0, 0.3, share, 1.0]).to_vec();
    let map = Arc::new(Texture::new(3, 3, Texels::LinearF32(texels)));
    let material = &mut scene.objects[0].material;
    material.scattering = Scattering::Preset("marble".to_owned());
    material.mixed_with = Some(SecondMedium {
        scattering: Scattering::Preset("ketchup".to_owned()),
        share: ScalarMap { offset: 0.1, gain: 0.8, texture: Some((map, 2)) },
    });
    // No neighbours, whose mixtures differ, are in the mean.
    let alone = ImageSpaceSettings { round: 3, ..ImageSpaceSettings::default() };
    let Some(frames) = on_both(test, &scene, &settings(alone)) else { return };
    same_layer(test, &frames, 0, tolerances::SAMPLED_MIXTURE);
    scene.objects[0].material.mixed_with = None;
    let plain = on_both(test, &scene, &settings(alone)).expect("there was an adapter");
    let apart = difference(&frames[0].layers[0].pixels, &plain[0].layers[0].pixels, |_| true);
    assert!(apart.mean > 0.05, "the second medium is seen: {apart:?}");
}

/// A thin plate between the camera and the only lamp: all light comes from what the lamp sees.
#[test]
fn a_plate_with_the_lamp_behind_it() {
    let test = "image-space: a plate before a lamp";
    let mut scene = plate_before_a_lamp();
    scene.objects[0].material.scattering = Scattering::Preset("whole-milk".to_owned());
    let Some(frames) = on_both(test, &scene, &settings(ImageSpaceSettings::default())) else { return };
    let middle = 80 * 160 + 80;
    assert!(frames[0].layers[1].pixels[middle].x > 1e-5, "{}", frames[0].layers[1].pixels[middle]);
    same_layer(test, &frames, 1, tolerances::SAMPLED_PLATE);
    let dark = ImageSpaceSettings { light_views: false, ..ImageSpaceSettings::default() };
    let frames = on_both(test, &scene, &settings(dark)).expect("there was an adapter");
    for frame in &frames {
        assert_eq!(frame.layers[1].pixels[middle].truncate(), Vec3::ZERO, "nothing is seen of the lit side");
    }
}

fn plate_before_a_lamp() -> Scene {
    let object = Object::new(
        "plate",
        shapes::cuboid(Vec3::ZERO, Vec3::new(30.0, 30.0, 0.5)),
        cutis_scene::Material::default(),
    );
    let [lo, hi] = object.mesh.bounds_mm().expect("has points");
    Scene {
        camera: Camera::framing([lo, hi], Vec3::Z, 0.4),
        lights: vec![Light::Directional {
            dir_to_light: Vec3::new(0.3, 0.2, -1.0).normalize(),
            irradiance_w_per_m2: Vec3::splat(3.0),
            angular_radius_rad: 0.0,
        }],
        objects: vec![object],
        environment: None,
        background: None,
        warnings: Vec::new(),
    }
}

/// A scene that takes another round draws what one made for that round draws.
#[test]
fn another_round_takes_other_places() {
    let test = "image-space: rounds";
    let Some(renderer) = renderer(test) else { return };
    let scene = patch_under_a_spot(patch(|u| 40.0 * u, |v| 40.0 * v));
    let in_round = |round| settings(ImageSpaceSettings { round, ..ImageSpaceSettings::default() });
    let (gpu, passes) = common::parts(renderer);
    let drawn = |ready: &cutis_gpu::GpuScene| {
        ready.draw(gpu).expect("draws");
        ready.picture(gpu).expect("is read")
    };
    let mut ready = renderer.scene(&scene, &in_round(0), &Silent).expect("is uploaded");
    let first = drawn(&ready);
    ready.set_sampling(gpu, &in_round(5)).expect("is sampled");
    let fresh = renderer.scene(&scene, &in_round(5), &Silent).expect("is uploaded");
    assert_eq!(drawn(&ready), drawn(&fresh));
    assert_ne!(drawn(&ready), first);
    // More samples of a pixel share its places.
    let finer = Settings { samples_per_pixel: 4, ..in_round(5) };
    ready.set_picture(gpu, passes, &finer).expect("is small");
    ready.set_sampling(gpu, &finer).expect("is sampled");
    let fresh = renderer.scene(&scene, &finer, &Silent).expect("is uploaded");
    assert_eq!(drawn(&ready), drawn(&fresh));
}
