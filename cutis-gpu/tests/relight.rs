//! A scene with other lights is the scene that is made with them, to the bit.

mod common;

use common::{head_in_the_studio, renderer};
use cutis_gpu::{GpuRenderer, GpuScene};
use cutis_render::{Settings, Silent};
use cutis_scene::{Light, Pose, Projector, Scene, Texels, Texture, Wave};
use glam::{Vec2, Vec3, Vec4};
use std::sync::{Arc, LazyLock};

fn settings() -> Settings {
    Settings { width: 32, height: 32, samples_per_pixel: 1, irradiance_size: 64, ..Settings::default() }
}

fn picture(renderer: &GpuRenderer, ready: &GpuScene) -> Vec<Vec4> {
    ready.look_timed(&renderer.gpu).expect("is drawn");
    ready.picture(&renderer.gpu).expect("is read")
}

fn whole(renderer: &GpuRenderer, scene: &Scene) -> Vec<Vec4> {
    picture(renderer, &renderer.scene(scene, &settings(), &Silent).expect("is uploaded"))
}

/// What the projector throws: red and green above blue and white.
static SLIDE: LazyLock<Arc<Texture>> = LazyLock::new(|| {
    let texels = vec![[1.0, 0.1, 0.1, 1.0], [0.1, 1.0, 0.1, 1.0], [0.1, 0.1, 1.0, 1.0], [1.0; 4]];
    Arc::new(Texture::new(2, 2, Texels::LinearF32(texels)))
});

/// The head under a lamp of each kind.
fn head() -> Scene {
    let mut scene = head_in_the_studio();
    scene.lights = vec![
        Light::Directional {
            dir_to_light: Vec3::new(-0.8, 0.3, 0.5).normalize(),
            irradiance_w_per_m2: Vec3::new(1.0, 1.5, 2.0),
            angular_radius_rad: 0.02,
        },
        Light::Point {
            position_mm: Vec3::new(400.0, 300.0, 500.0),
            intensity_w_per_sr: Vec3::splat(0.5),
            radius_mm: 10.0,
        },
        Light::Spot {
            position_mm: Vec3::new(-300.0, 100.0, -600.0),
            dir_travel: Vec3::new(0.3, -0.1, 0.6).normalize(),
            intensity_w_per_sr: Vec3::new(1.0, 0.7, 0.4),
            inner_cone_rad: 0.2,
            outer_cone_rad: 0.4,
            radius_mm: 0.0,
        },
        Light::Projector(Projector {
            position_mm: Vec3::new(100.0, 50.0, 700.0),
            axes: Projector::axes(Vec3::new(-0.14, -0.07, -1.0).normalize(), Vec3::Y),
            tan_half_height: 0.15,
            image: Arc::clone(&SLIDE),
            intensity_w_per_sr: Vec3::splat(0.6),
            radius_mm: 5.0,
            shift: Vec2::ZERO,
            drift_per_s: Vec2::ZERO,
        }),
    ];
    scene
}

/// The same lamps elsewhere, of another strength, in turned and brighter surroundings.
fn relit() -> Scene {
    let mut scene = head();
    for light in &mut scene.lights {
        match light {
            Light::Directional { dir_to_light, irradiance_w_per_m2, .. } => {
                *dir_to_light = Vec3::new(0.5, 0.5, 0.7).normalize();
                *irradiance_w_per_m2 *= 2.0;
            }
            Light::Point { position_mm, .. } => position_mm.x = -350.0,
            Light::Spot { intensity_w_per_sr, outer_cone_rad, .. } => {
                intensity_w_per_sr.z = 1.0;
                *outer_cone_rad = 0.5;
            }
            Light::Projector(projector) => {
                projector.position_mm.y = -80.0;
                projector.axes = Projector::axes(Vec3::new(-0.14, 0.11, -1.0).normalize(), Vec3::X);
                projector.shift = Vec2::new(0.3, -0.15);
                projector.tan_half_height = 0.2;
            }
        }
    }
    if let Some(environment) = &mut scene.environment {
        environment.rotation_rad += 1.0;
        environment.radiance_scale *= 1.5;
    }
    scene
}

#[test]
fn other_lights_are_those_of_a_scene_made_with_them() {
    let Some(renderer) = renderer("other_lights_are_those_of_a_scene_made_with_them") else { return };
    let mut ready = renderer.scene(&head(), &settings(), &Silent).expect("is uploaded");
    let before = picture(renderer, &ready);
    assert!(ready.set_lights(&renderer.gpu, &relit()), "the lamps are of the same kinds");
    let after = picture(renderer, &ready);
    assert!(after != before, "nothing has changed");
    assert!(after == whole(renderer, &relit()), "other light");
    assert!(ready.set_lights(&renderer.gpu, &head()));
    assert!(picture(renderer, &ready) == before, "not as it was");
}

#[test]
fn lights_and_poses_follow_in_any_order() {
    let Some(renderer) = renderer("lights_and_poses_follow_in_any_order") else { return };
    let gpu = &renderer.gpu;
    let pose = Pose { wave: Some(Wave::sideways(8.0, 90.0, 0.5)), ..Pose::default() };
    let mut ready = renderer.scene(&head(), &settings(), &Silent).expect("is uploaded");
    ready.set_pose(gpu, &head(), &pose).expect("is a pose");
    assert!(ready.set_lights(gpu, &relit()));
    let light_last = picture(renderer, &ready);
    let mut other = renderer.scene(&head(), &settings(), &Silent).expect("is uploaded");
    assert!(other.set_lights(gpu, &relit()));
    other.set_pose(gpu, &relit(), &pose).expect("is a pose");
    assert!(light_last == picture(renderer, &other), "the order matters");
    // At rest the lights are laid as for the scene that is made with them.
    other.set_pose(gpu, &relit(), &Pose::default()).expect("is a pose");
    assert!(picture(renderer, &other) == whole(renderer, &relit()), "something of the pose is left");
}

#[test]
fn what_takes_other_steps_is_told_and_changes_nothing() {
    let Some(renderer) = renderer("what_takes_other_steps_is_told_and_changes_nothing") else { return };
    let mut ready = renderer.scene(&head(), &settings(), &Silent).expect("is uploaded");
    let before = picture(renderer, &ready);
    let changes: [fn(&mut Scene); 7] = [
        |scene| scene.lights.truncate(2),
        |scene| scene.lights.swap(0, 1),
        // Among the objects: no map shows all of them.
        |scene| match &mut scene.lights[1] {
            Light::Point { position_mm, .. } => *position_mm = Vec3::ZERO,
            other => panic!("{other:?}"),
        },
        |scene| {
            for light in &mut scene.lights {
                match light {
                    Light::Directional { angular_radius_rad, .. } => *angular_radius_rad = 0.0,
                    Light::Point { radius_mm, .. } | Light::Spot { radius_mm, .. } => *radius_mm = 0.0,
                    Light::Projector(projector) => projector.radius_mm = 0.0,
                }
            }
        },
        |scene| match &mut scene.lights[3] {
            Light::Projector(projector) => projector.image = Arc::new(Texture::clone(&SLIDE)),
            other => panic!("{other:?}"),
        },
        |scene| scene.environment = None,
        |scene| scene.environment.as_mut().expect("a studio has one").visible ^= true,
    ];
    for (number, change) in (1..).zip(changes) {
        let mut scene = relit();
        change(&mut scene);
        assert!(!ready.set_lights(&renderer.gpu, &scene), "change {number}");
        assert!(picture(renderer, &ready) == before, "change {number} has left something");
    }
}

#[test]
fn a_lamp_that_a_pose_may_swallow_takes_a_scene_of_its_own() {
    let Some(renderer) = renderer("a_lamp_that_a_pose_may_swallow_takes_a_scene_of_its_own") else { return };
    let mut near = head();
    let [_, hi] = near.bounds_mm().expect("has points");
    for light in &mut near.lights {
        if let Light::Point { position_mm, .. } = light {
            *position_mm = Vec3::new(hi.x + 60.0, 0.0, 0.0);
        }
    }
    let mut ready = renderer.scene(&head(), &settings(), &Silent).expect("is uploaded");
    assert!(ready.set_lights(&renderer.gpu, &near), "beside the head as it rests");
    assert!(ready.set_lights(&renderer.gpu, &head()));
    let wave = Wave::sideways(100.0, 400.0, 0.0);
    ready.set_pose(&renderer.gpu, &head(), &Pose { wave: Some(wave), ..Pose::default() }).expect("is a pose");
    let before = picture(renderer, &ready);
    assert!(!ready.set_lights(&renderer.gpu, &near), "the head may reach beyond the lamp");
    assert!(picture(renderer, &ready) == before, "nothing has changed");
}
