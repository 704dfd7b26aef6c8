//! Whole frames on both backends: radiance, and the layers that add up to it.

mod common;

use common::tolerances::{self, Tolerance};
use common::{
    difference, head_in_the_studio, patch, patch_under_a_spot, renderer, scanned_head, small_frame,
};
use cutis_gpu::GpuRenderer;
use cutis_render::{Aov, CpuRenderer, Renderer, Settings, Silent};
use cutis_scene::{Light, Projector, Scene, Texels, Texture};
use glam::{Vec2, Vec3};
use std::sync::Arc;

fn settings() -> Settings {
    Settings { aovs: vec![Aov::Normal, Aov::Albedo, Aov::Diffuse, Aov::Specular], ..small_frame() }
}

/// Draws a scene on both and compares what is covered in both.
fn same_on_both(test: &str, scene: &Scene, settings: &Settings, allowed: Tolerance) {
    let Some(renderer) = renderer(test) else { return };
    let cpu = CpuRenderer.render(scene, settings, &Silent).expect("draws");
    let gpu = renderer.render(scene, settings, &Silent).expect("draws");
    let covered = |i: usize| cpu.pixels[i].w > 0.99 && gpu.pixels[i].w > 0.99;
    let coverage = |frame: &cutis_render::Frame| frame.pixels.iter().map(|p| p.w).sum::<f32>();
    let change = coverage(&gpu) / coverage(&cpu) - 1.0;
    assert!(change.abs() < 0.01, "{test}: coverage differs by {change}");
    difference(&gpu.pixels, &cpu.pixels, covered).check(test, allowed);
    for (g, c) in gpu.layers.iter().zip(&cpu.layers) {
        let drawn = |i: usize| covered(i) && c.pixels[i].w > 0.99 && g.pixels[i].w > 0.99;
        let allowed = match g.name.as_str() {
            "specular" => tolerances::SHINE,
            "diffuse" => tolerances::DIFFUSE,
            "irradiance" => tolerances::SHARP,
            _ => tolerances::SURFACE,
        };
        difference(&g.pixels, &c.pixels, drawn).check(&format!("{test}, {}", g.name), allowed);
    }
}

#[test]
fn the_built_in_head() {
    same_on_both("the_built_in_head", &head_in_the_studio(), &settings(), tolerances::HEAD);
}

#[test]
fn three_lights_and_the_environment() {
    let mut scene = head_in_the_studio();
    scene.lights.push(Light::Directional {
        dir_to_light: Vec3::new(-0.8, 0.3, -0.5).normalize(),
        irradiance_w_per_m2: Vec3::new(1.0, 1.5, 2.0),
        angular_radius_rad: 0.02,
    });
    same_on_both("three_lights_and_the_environment", &scene, &settings(), tolerances::THREE_LIGHTS);
}

#[test]
fn a_flat_patch() {
    let scene = patch_under_a_spot(patch(|u| 40.0 * u, |v| 40.0 * v));
    same_on_both("a_flat_patch", &scene, &settings(), tolerances::PATCH);
}

#[test]
fn a_stretched_patch() {
    let scene = patch_under_a_spot(patch(|u| 60.0 * u, |v| 20.0 * (v + 0.03 * (12.0 * v).sin())));
    same_on_both("a_stretched_patch", &scene, &settings(), tolerances::PATCH);
}

#[test]
fn the_scanned_head() {
    let Some(scene) = scanned_head("the_scanned_head") else { return };
    same_on_both("the_scanned_head", &scene, &settings(), tolerances::SCAN);
}

/// A projector that throws red, green, blue and white above a row of greys, from so far above the middle of a scene, aside
/// by a third of that.
fn projector(scene: &Scene, distance_mm: f32, tan_half_height: f32) -> Light {
    let [lo, hi] = scene.bounds_mm().expect("has points");
    let from_middle_mm = Vec3::new(0.3, 0.2, 1.0) * distance_mm;
    let colours = [[0.9, 0.1, 0.1, 1.0], [0.1, 0.8, 0.1, 1.0], [0.1, 0.2, 0.9, 1.0], [1.0; 4]];
    let greys = [0.2, 0.7, 0.4, 0.9].map(|grey| [grey, grey, grey, 1.0]);
    Light::Projector(Projector {
        position_mm: 0.5 * (lo + hi) + from_middle_mm,
        axes: Projector::axes(-from_middle_mm.normalize(), Vec3::new(0.2, 1.0, 0.0).normalize()),
        tan_half_height,
        image: Arc::new(Texture::new(4, 2, Texels::LinearF32(colours.into_iter().chain(greys).collect()))),
        intensity_w_per_sr: Vec3::new(1.0, 0.9, 0.8) * (1e-3 * distance_mm).powi(2),
        radius_mm: 0.0,
        // Across every border of the image.
        shift: Vec2::new(0.3, -0.15),
        drift_per_s: Vec2::ZERO,
    })
}

#[test]
fn a_patch_under_a_projector() {
    let mut scene = patch_under_a_spot(patch(|u| 40.0 * u, |v| 40.0 * v));
    // 28 mm by 14 mm of 40: its edges lie across the patch.
    scene.lights = vec![projector(&scene, 200.0, 0.035)];
    let wanted = Settings { aovs: vec![Aov::Irradiance, Aov::Specular, Aov::Diffuse], ..settings() };
    same_on_both("a_patch_under_a_projector", &scene, &wanted, tolerances::PROJECTED[0]);
}

#[test]
fn the_built_in_head_under_two_projectors() {
    let mut scene = head_in_the_studio();
    // The first one in the list throws another image than the second: each reads its own.
    scene.lights = vec![projector(&scene, 900.0, 0.08), projector(&scene, 500.0, 0.3)];
    if let Light::Projector(first) = &mut scene.lights[0] {
        first.image = Arc::new(Texture::new(1, 1, Texels::LinearF32(vec![[0.2, 0.4, 1.0, 1.0]])));
        first.position_mm.x -= 500.0;
        first.radius_mm = 10.0;
        first.axes = Projector::axes(-first.position_mm.normalize(), Vec3::Y);
    }
    same_on_both("the_built_in_head_under_two_projectors", &scene, &settings(), tolerances::PROJECTED[1]);
}

#[test]
fn more_than_a_device_takes_of_projectors_is_refused_in_words() {
    let mut scene = head_in_the_studio();
    let image = Arc::new(Texture::new(4096, 4097, Texels::Linear8(vec![[0; 4]; 4096 * 4097])));
    let mut lamp = projector(&scene, 500.0, 0.3);
    if let Light::Projector(projector) = &mut lamp {
        projector.image = image;
    }
    scene.lights = vec![lamp];
    let refused = GpuRenderer::check(&scene).expect_err("is too large").to_string();
    assert!(refused.contains("projectors throw is 16781312 texels"), "{refused}");
}

/// Share of the pixels that are dark in one frame and lit in the other.
fn only_lit_in(lit: &cutis_render::Frame, dark: &cutis_render::Frame, mean: f32) -> f32 {
    let light = |frame: &cutis_render::Frame, i: usize| frame.pixels[i].truncate().element_sum() / 3.0;
    let pixels = lit.pixels.len();
    let differs = |i: &usize| light(dark, *i) < 0.1 * mean && light(lit, *i) > 0.2 * mean;
    (0..pixels).filter(differs).count() as f32 / pixels as f32
}

/// A close view of the scan under one of its lamps alone: light where the processor's rays find shadow has leaked, shadow
/// where they find light has come loose from what casts it.
fn neither_leaks_nor_loose_shadows(test: &str, lamp: usize, [from_mm, at_mm]: [Vec3; 2], allowed: [f32; 2]) {
    let (Some(mut scene), Some(renderer)) = (scanned_head(test), renderer(test)) else { return };
    scene.lights = vec![scene.lights.swap_remove(lamp)];
    scene.environment = None;
    scene.camera.position_mm = from_mm;
    scene.camera.look_at_mm = at_mm;
    scene.camera.vertical_fov_rad = 0.17;
    let close = Settings { irradiance_size: 1024, aovs: Vec::new(), ..settings() };
    let cpu = CpuRenderer.render(&scene, &close, &Silent).expect("draws");
    let gpu = renderer.render(&scene, &close, &Silent).expect("draws");
    let sum = cpu.pixels.iter().map(|p| p.truncate().element_sum() / 3.0).sum::<f32>();
    let mean = sum / cpu.pixels.len() as f32;
    let [leaked, loose] = [only_lit_in(&gpu, &cpu, mean), only_lit_in(&cpu, &gpu, mean)];
    eprintln!("{test}: {leaked:.5} leaked, {loose:.5} loose");
    assert!(leaked <= allowed[0] && loose <= allowed[1], "{leaked}, {loose}");
}

/// The lamp behind the ear.
#[test]
fn no_light_leaks_past_the_scanned_ear() {
    let view = [Vec3::new(420.0, 0.0, 560.0), Vec3::new(70.0, -30.0, 0.0)];
    neither_leaks_nor_loose_shadows("no_light_leaks_past_the_scanned_ear", 1, view, tolerances::EAR);
}

/// The lamp before and above the face, from below.
#[test]
fn no_light_leaks_into_the_scanned_nostrils() {
    let view = [Vec3::new(40.0, -380.0, 520.0), Vec3::new(8.0, -40.0, 80.0)];
    neither_leaks_nor_loose_shadows(
        "no_light_leaks_into_the_scanned_nostrils",
        0,
        view,
        tolerances::NOSTRILS,
    );
}

#[test]
fn drawing_again_gives_the_same_and_a_moved_camera_another() {
    let Some(renderer) = renderer("drawing_again_gives_the_same_and_a_moved_camera_another") else { return };
    let scene = head_in_the_studio();
    let small = Settings { width: 48, height: 48, irradiance_size: 128, ..Settings::default() };
    let ready = renderer.scene(&scene, &small, &Silent).expect("is uploaded");
    let picture = || {
        ready.draw(&renderer.gpu).expect("is drawn");
        ready.picture(&renderer.gpu).expect("is drawn")
    };
    let first = picture();
    assert_eq!(first, picture(), "nothing is left of the frame before");
    let mut camera = scene.camera;
    camera.position_mm.x += 100.0;
    ready.set_camera(&renderer.gpu, &camera);
    assert_ne!(first, picture());
    ready.set_camera(&renderer.gpu, &scene.camera);
    assert_eq!(first, picture());
}

#[test]
fn a_look_from_elsewhere_or_at_another_size_needs_no_new_light() {
    let Some(renderer) = renderer("a_look_from_elsewhere_or_at_another_size_needs_no_new_light") else {
        return;
    };
    let GpuRenderer { gpu, passes, .. } = renderer;
    let scene = head_in_the_studio();
    let settings = |side| Settings { width: side, height: side, irradiance_size: 128, ..Settings::default() };
    let mut moved = scene.clone();
    moved.camera.position_mm.x += 100.0;
    let whole = |scene: &Scene, side| {
        let ready = renderer.scene(scene, &settings(side), &Silent).expect("is uploaded");
        ready.draw(gpu).expect("is drawn");
        ready.picture(gpu).expect("is read")
    };
    let mut ready = renderer.scene(&scene, &settings(48), &Silent).expect("is uploaded");
    let first = ready.look_timed(gpu).expect("is drawn");
    assert!(first.iter().any(|pass| pass.name == "irradiance"), "the first look needs light");
    assert_eq!(ready.picture(gpu).expect("is read"), whole(&scene, 48));
    let wide = Settings { width: 64, ..settings(32) };
    ready.set_picture(gpu, passes, &wide).expect("is no larger than before");
    ready.draw(gpu).expect("is drawn");
    let fresh = renderer.scene(&scene, &wide, &Silent).expect("is uploaded");
    fresh.draw(gpu).expect("is drawn");
    let [got, wanted] = [&ready, &fresh].map(|one| one.picture(gpu).expect("is read"));
    assert!(got == wanted, "a picture of other proportions is that of a scene made for them");
    ready.set_picture(gpu, passes, &settings(32)).expect("is no larger than before");
    ready.set_camera(gpu, &moved.camera);
    let second = ready.look_timed(gpu).expect("is drawn");
    assert!(second.iter().all(|pass| pass.name != "irradiance"), "{second:?}");
    assert_eq!(ready.picture(gpu).expect("is read"), whole(&moved, 32));
}
