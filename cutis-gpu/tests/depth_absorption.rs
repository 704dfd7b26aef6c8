//! Absorption over distances through bodies on both backends, and against closed forms.

mod common;

use common::tolerances::{self, Tolerance};
use common::{difference, head_in_the_studio, renderer, small_frame};
use cutis_gpu::GpuRenderer;
use cutis_optics::RgbGaussianSum;
use cutis_render::prepare::ColourRamp;
use cutis_render::settings::TechniqueSettings;
use cutis_render::technique::depth_absorption::{DepthAbsorptionSettings, EntryPoint, FallOff};
use cutis_render::{Aov, CpuRenderer, Frame, Renderer, Settings, Silent, TechniqueName};
use cutis_scene::validation::shapes::{capsule, cuboid};
use cutis_scene::{Camera, Light, Material, Object, Pose, ScalarMap, Scattering, Scene, Wave};
use glam::Vec3;
use std::sync::Arc;

const SIGMA_T: Vec3 = Vec3::new(0.05, 0.2, 1.0);

/// White through and through, without shine: what leaves is what entered and was not absorbed.
fn white() -> Material {
    let kernel = RgbGaussianSum { variances_mm2: vec![1.0], weights: vec![[1.0; 3]] };
    let mut material = Material {
        scattering: Scattering::Kernel(kernel),
        rho_s: ScalarMap::constant(0.0),
        ..Material::default()
    };
    material.albedo.factor = Vec3::ONE;
    material
}

/// Bodies in light along a direction, seen from +z, so many millimetres of them.
fn backlit(objects: Vec<Object>, dir_to_light: Vec3, height_mm: f32) -> Scene {
    let light = Light::Directional {
        dir_to_light: dir_to_light.normalize(),
        irradiance_w_per_m2: Vec3::ONE,
        angular_radius_rad: 0.0,
    };
    let camera = Camera {
        position_mm: Vec3::Z * 500.0,
        look_at_mm: Vec3::ZERO,
        up: Vec3::Y,
        vertical_fov_rad: height_mm / 500.0,
        exposure_ev: 0.0,
    };
    let (environment, background, warnings) = (None, None, Vec::new());
    Scene { objects, lights: vec![light], environment, camera, background, warnings }
}

fn plate(thickness_mm: f32) -> Object {
    Object::new("plate", cuboid(Vec3::ZERO, Vec3::new(40.0, 40.0, 0.5 * thickness_mm)), white())
}

fn finger(x_mm: f32) -> Object {
    Object::new("finger", capsule(Vec3::new(x_mm, 0.0, 0.0), 8.0, 14.0, 128), white())
}

fn plain() -> DepthAbsorptionSettings {
    DepthAbsorptionSettings {
        fall_off: FallOff::Exponential(SIGMA_T),
        growth_mm: 0.0,
        entry: EntryPoint::Surface,
        samples: 1,
        filter_radius_mm: 0.0,
        layers: 1,
    }
}

fn settings(depth_absorption: DepthAbsorptionSettings) -> Settings {
    Settings {
        technique: TechniqueName::DepthAbsorption,
        techniques: TechniqueSettings { depth_absorption, ..TechniqueSettings::default() },
        aovs: vec![Aov::Exitance, Aov::Thickness, Aov::Transmission],
        width: 96,
        height: 96,
        samples_per_pixel: 4,
        ..small_frame()
    }
}

fn draw(renderer: &GpuRenderer, scene: &Scene, depth: DepthAbsorptionSettings) -> Frame {
    let settings = Settings { width: 8, height: 8, samples_per_pixel: 1, ..settings(depth) };
    renderer.render(scene, &settings, &Silent).expect("draws")
}

#[test]
fn a_plate_absorbs_by_its_thickness() {
    let Some(renderer) = renderer("a_plate_absorbs_by_its_thickness") else { return };
    for (thickness_mm, growth_mm, entry) in [
        (0.3f32, 0.0, EntryPoint::Surface),
        (8.0, 0.0, EntryPoint::Distance),
        (2.0, 0.5, EntryPoint::Surface),
    ] {
        // Straight through, growth moves the face along the light, and its distance stays.
        let dir = if growth_mm > 0.0 { -Vec3::Z } else { Vec3::new(0.6, 0.0, -0.8) };
        let lit = backlit(vec![plate(thickness_mm)], dir, 8.0);
        let frame = draw(renderer, &lit, DepthAbsorptionSettings { entry, growth_mm, ..plain() });
        let s_mm = thickness_mm / -dir.z;
        let what = format!("{entry}, {thickness_mm} mm, grown by {growth_mm} mm");
        // The plane between four texels is exact, but that corners are moved by up to 1/512 of a texel of 0.25 mm before
        // it is drawn, to either side on both axes, at a slope of 0.75.
        let got_mm = frame.layers[1].pixels[27].x;
        assert!((got_mm - s_mm).abs() < 1e-3, "{what}: {got_mm} mm");
        // A texel is 0.2 mm wide; over it the exponential bends by (sigma 0.2 mm 0.75)²/8; 16-bit floats round off 1/2048.
        let expected = (-SIGMA_T * s_mm).exp() * -dir.z;
        let got = frame.layers[0].pixels[27].truncate();
        assert!(
            (got - expected).abs().max_element() < 4e-3 * expected.max_element(),
            "{what}: {got}, {expected}"
        );
    }
}

#[test]
fn a_ball_is_as_thick_as_its_chord() {
    let Some(renderer) = renderer("a_ball_is_as_thick_as_its_chord") else { return };
    let ball = Object::new("ball", capsule(Vec3::ZERO, 10.0, 0.0, 128), white());
    let lit = backlit(vec![ball], -Vec3::Z, 19.0);
    let settings = Settings { width: 64, height: 64, samples_per_pixel: 1, ..settings(plain()) };
    let frame = renderer.render(&lit, &settings, &Silent).expect("draws");
    let texel_mm = 2.0 * 10.0 * 1.02 / 512.0;
    for (i, seen) in frame.layers[1].pixels.iter().enumerate() {
        let at = |j: usize| ((j as f32 + 0.5) / 64.0 - 0.5) * 19.0;
        // The place is nearer to the eye than the middle, by up to 10 mm of 500.
        let flat = glam::Vec2::new(at(i % 64), at(i / 64));
        let aside_mm = (flat * (1.0 - (100.0 - flat.length_squared()).max(0.0).sqrt() / 500.0)).length();
        if aside_mm < 8.5 {
            let half_mm = (100.0 - aside_mm * aside_mm).sqrt();
            // The ball's slope times a texel, and what its facets lie below it.
            let slack_mm = texel_mm * aside_mm / half_mm + 0.012 * 10.0 / half_mm;
            assert!(
                (seen.x - 2.0 * half_mm).abs() < slack_mm,
                "{aside_mm} mm: {} for {}",
                seen.x,
                2.0 * half_mm
            );
        }
    }
}

#[test]
fn layers_tell_gaps_from_flesh() {
    let Some(renderer) = renderer("layers_tell_gaps_from_flesh") else { return };
    // Seen along the fingers' light, the far one of them before the eye.
    let fingers = || {
        [-8.5, 8.5].map(|z| Object::new("finger", capsule(Vec3::new(0.0, 0.0, z), 8.0, 14.0, 128), white()))
    };
    for (layers, expected_mm) in [(1, 33.0), (2, 33.0), (3, 32.0)] {
        let lit = backlit(fingers().to_vec(), -Vec3::Z, 0.2);
        let frame = draw(renderer, &lit, DepthAbsorptionSettings { layers, ..plain() });
        let got_mm = frame.layers[1].pixels[27].x;
        // Facets lie 0.005 mm below each of up to four surfaces.
        assert!((got_mm - expected_mm).abs() < 0.02, "{layers} layers: {got_mm} mm for {expected_mm}");
    }
}

fn same_on_both(test: &str, scene: &Scene, depth: DepthAbsorptionSettings, allowed: [Tolerance; 2]) {
    let Some(renderer) = renderer(test) else { return };
    let settings = settings(depth);
    let cpu = CpuRenderer.render(scene, &settings, &Silent).expect("draws");
    let gpu = renderer.render(scene, &settings, &Silent).expect("draws");
    let covered = |i: usize| cpu.pixels[i].w > 0.99 && gpu.pixels[i].w > 0.99;
    difference(&gpu.pixels, &cpu.pixels, covered).check(test, allowed[0]);
    let came_through = |frame: &Frame| frame.layers[2].pixels.clone();
    difference(&came_through(&gpu), &came_through(&cpu), covered)
        .check(&format!("{test}, through"), allowed[1]);
    for pass in gpu.passes.iter().filter(|pass| pass.name == "depth map" || pass.name == "resolve") {
        eprintln!("{test}: {} {:?}", pass.name, pass.time);
    }
}

#[test]
fn a_head_before_a_lamp() {
    let mut scene = head_in_the_studio();
    scene.lights = vec![Light::Point {
        position_mm: Vec3::new(250.0, 60.0, -180.0),
        intensity_w_per_sr: Vec3::splat(0.5),
        radius_mm: 0.0,
    }];
    // Through skin little would come: the edges of shadows would be all that is compared.
    let fall_off = FallOff::Exponential(Vec3::new(0.01, 0.03, 0.1));
    let wax = DepthAbsorptionSettings { fall_off, ..DepthAbsorptionSettings::default() };
    same_on_both("a_head_before_a_lamp", &scene, wax, tolerances::BACKLIT_HEAD);
}

/// Every number other than usual, so that each is missed where it is not handed on.
#[test]
fn every_number_counts() {
    let stops = vec![
        (0.0, Vec3::ONE),
        (6.0, Vec3::new(0.9, 0.4, 0.2)),
        (20.0, Vec3::new(0.3, 0.0, 0.1)),
        (34.0, Vec3::ZERO),
    ];
    let depth = DepthAbsorptionSettings {
        fall_off: FallOff::Ramp(Arc::new(ColourRamp::new(stops).expect("is sound"))),
        growth_mm: 0.2,
        entry: EntryPoint::Distance,
        samples: 16,
        filter_radius_mm: 3.0,
        layers: 4,
    };
    let mut fingers = vec![finger(-8.5), finger(8.5)];
    fingers[1].material.thickness_scale = 0.7;
    fingers[1].material.albedo.factor = Vec3::new(0.9, 0.6, 0.5);
    let mut lit = backlit(fingers, Vec3::new(-1.0, 0.3, -0.4), 46.0);
    lit.lights.push(Light::Point {
        position_mm: Vec3::new(120.0, 40.0, -60.0),
        intensity_w_per_sr: Vec3::splat(0.02),
        radius_mm: 0.0,
    });
    same_on_both("every_number_counts", &lit, depth, tolerances::PEELED_FINGERS);
}

#[test]
fn it_follows_a_pose_and_other_lights() {
    let Some(renderer) = renderer("it_follows_a_pose_and_other_lights") else { return };
    let settings = Settings { width: 32, height: 32, samples_per_pixel: 1, ..settings(plain()) };
    let scene = backlit(vec![finger(0.0)], Vec3::new(0.3, 0.2, -1.0), 46.0);
    let pose = Pose { wave: Some(Wave::sideways(3.0, 20.0, 0.3)), ..Pose::default() };
    let mut waved = scene.clone();
    waved.set_pose(&pose).expect("can be waved");
    let relit = backlit(vec![finger(0.0)], Vec3::new(-0.7, 0.1, -1.0), 46.0);
    let mut ready = renderer.scene(&scene, &settings, &Silent).expect("is uploaded");
    let picture = |ready: &cutis_gpu::GpuScene| {
        ready.look_timed(&renderer.gpu).expect("is drawn");
        ready.picture(&renderer.gpu).expect("is read")
    };
    let whole = |scene: &Scene| picture(&renderer.scene(scene, &settings, &Silent).expect("is uploaded"));
    let before = picture(&ready);
    ready.set_pose(&renderer.gpu, &scene, &pose).expect("can be waved");
    let posed = picture(&ready);
    assert!(posed != before, "the pose changes something");
    // The lights' maps are laid over boxes in a pose: another texel of the map for the same place.
    difference(&posed, &whole(&waved), |i| posed[i].w > 0.99).check("posed", tolerances::POSED_FINGER);
    ready.set_pose(&renderer.gpu, &scene, &Pose::default()).expect("can stand still");
    assert!(picture(&ready) == before, "not as it was");
    assert!(ready.set_lights(&renderer.gpu, &relit), "the lamp is of the same kind");
    assert!(picture(&ready) == whole(&relit), "other light");
}
