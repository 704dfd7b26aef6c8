//! A thin plate on a plane under a low light: its shadow begins at its foot, goes on to its end, and has no holes.

mod common;

use common::{patch, patch_under_a_spot, read, renderer};
use cutis_gpu::GpuRenderer;
use cutis_render::{Settings, Silent};
use cutis_scene::validation::shapes::cuboid;
use cutis_scene::{Light, Material, Object, Scene};
use glam::{Vec2, Vec3, Vec4};

/// Side of the plane, mm.
const SIDE_MM: f32 = 40.0;
/// Half of the plate: half a millimetre thick.
const HALF_MM: Vec3 = Vec3::new(0.25, 8.0, 3.0);
/// Height of the light over the plane, as a slope.
const SLOPE: f32 = 0.1;

/// The plate stands across the plane's middle; the light comes from the right and is 6 degrees high.
fn plate_on_a_plane(light: Light) -> Scene {
    let middle = Vec3::new(0.6 * SIDE_MM, -0.5 * SIDE_MM, HALF_MM.z);
    let mut scene = patch_under_a_spot(patch(|u| f64::from(SIDE_MM) * u, |v| f64::from(SIDE_MM) * v));
    scene.objects.push(Object::new("plate", cuboid(middle, HALF_MM), Material::default()));
    scene.lights = vec![light];
    scene
}

fn sun(angular_radius_rad: f32) -> Light {
    Light::Directional {
        dir_to_light: Vec3::new(1.0, 0.0, SLOPE).normalize(),
        irradiance_w_per_m2: Vec3::ONE,
        angular_radius_rad,
    }
}

/// A lamp of a size that leaves most of the shadow dark.
fn lamp() -> Light {
    let position_mm = Vec3::new(24.0, -20.0, 0.0) + Vec3::new(1.0, 0.0, SLOPE) * 200.0;
    Light::Point { position_mm, intensity_w_per_sr: Vec3::ONE, radius_mm: 2.0 }
}

/// What every texel of the plane sees of the light, and how many there are along a side.
fn seen_of(renderer: &GpuRenderer, scene: &Scene, irradiance_size: u32) -> (Vec<Vec4>, usize) {
    let settings =
        Settings { width: 8, height: 8, irradiance_size, samples_per_pixel: 1, ..Settings::default() };
    let ready = renderer.scene(scene, &settings, &Silent).expect("is uploaded");
    ready.draw(&renderer.gpu).expect("is drawn");
    let visibility = &ready.objects[0].visibility;
    (read(&renderer.gpu, visibility, 0), visibility.width() as usize)
}

#[test]
fn the_shadow_of_a_thin_plate_begins_at_its_foot_and_has_no_holes() {
    let Some(renderer) = renderer("the_shadow_of_a_thin_plate_begins_at_its_foot_and_has_no_holes") else {
        return;
    };
    for (light, what) in [(sun(0.0), "sharp"), (sun(0.01), "of a wide sun"), (lamp(), "soft")] {
        let scene = plate_on_a_plane(light);
        let (seen, size) = seen_of(renderer, &scene, 512);
        let foot_mm = 0.6 * SIDE_MM;
        let reach_mm = 2.0 * HALF_MM.z / SLOPE;
        // Four texels of the map of the light, which are a tenth of a millimetre wide.
        let slack_mm = 0.4;
        let (mut lit, mut dark) = (0, 0);
        for (texel, seen) in seen.iter().enumerate() {
            let place =
                (Vec2::new((texel % size) as f32, (texel / size) as f32) + 0.5) / size as f32 * SIDE_MM;
            let aside_mm = (place.y - 0.5 * SIDE_MM).abs();
            let behind_mm = foot_mm - HALF_MM.x - place.x;
            let on_plane = place.min_element() > 1.0 && place.max_element() < SIDE_MM - 1.0;
            // A third of the shadow lies beyond the edge of the lamp's disc or in half light.
            if aside_mm < HALF_MM.y - 1.0 && behind_mm > slack_mm && behind_mm < 0.66 * reach_mm && on_plane {
                assert!(seen.x < 0.02, "{what}: light {behind_mm} mm behind the plate: {}", seen.x);
                dark += 1;
            }
            let in_front = behind_mm < -2.0 * HALF_MM.x - slack_mm;
            // The lamp's shadow grows wider by an eighth, and has a soft edge.
            if on_plane && (in_front || aside_mm > 1.125 * HALF_MM.y + 1.0) {
                assert!(
                    seen.x > 0.98,
                    "{what}: shadow {aside_mm} mm aside, {behind_mm} mm behind: {}",
                    seen.x
                );
                lit += 1;
            }
        }
        assert!(lit > 10_000 && dark > 10_000, "{lit} lit, {dark} dark");
    }
}

/// A large light just over the horizon of a plane: what of its disc lies below lights nothing, by the area of a segment of a
/// circle.
#[test]
fn what_lies_below_the_horizon_of_a_plane_does_not_light_it() {
    let Some(renderer) = renderer("what_lies_below_the_horizon_of_a_plane_does_not_light_it") else { return };
    let radius_rad = 3f32.to_radians();
    for share in [1.0 / 3.0, 2.0 / 3.0f32] {
        let height_rad = share * radius_rad;
        let mut scene = plate_on_a_plane(Light::Directional {
            dir_to_light: Vec3::new(height_rad.cos(), 0.0, height_rad.sin()),
            irradiance_w_per_m2: Vec3::ONE,
            angular_radius_rad: radius_rad,
        });
        scene.objects.truncate(1);
        let (seen, size) = seen_of(renderer, &scene, 128);
        let inner = |i: &usize| (8..size - 8).contains(&(i % size)) && (8..size - 8).contains(&(i / size));
        let texels: Vec<f32> = (0..seen.len()).filter(inner).map(|i| seen[i].x).collect();
        let mean = texels.iter().sum::<f32>() / texels.len() as f32;
        let below = (share.acos() - share * (1.0 - share * share).sqrt()) / std::f32::consts::PI;
        // Sixteen places, turned from texel to texel: their mean is that of a segment to a quarter of one of them.
        assert!(
            (mean - (1.0 - below)).abs() < 0.25 / 16.0,
            "{share}: {mean} is seen, {} is above",
            1.0 - below
        );
    }
}
