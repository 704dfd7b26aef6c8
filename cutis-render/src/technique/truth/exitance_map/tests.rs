#![allow(clippy::unwrap_used, reason = "tests")]
use super::from_lights::areas_mm2;
use super::*;
use crate::Silent;
use crate::transport::tests::{ball, material, scene_of};
use cutis_scene::Light;
use glam::Vec3;
use std::f64::consts::PI;

const SIZE: usize = 64;
const RADIUS_MM: f64 = 10.0;
const HALF_ANGLE: f64 = 0.5;

/// A white ball of index 1 in even light from the side of +x: all that falls on it leaves it.
#[test]
fn the_light_that_fell_on_a_white_ball_is_all_on_its_map() {
    let body = ball(RADIUS_MM as f32, 48, material(0.0, 1.0, 1.0, 0.3));
    let light = Light::Directional {
        dir_to_light: Vec3::X,
        irradiance_w_per_m2: Vec3::splat(2.0),
        // Through a surface that bends nothing, paths meet the lamp by chance: it is large.
        angular_radius_rad: HALF_ANGLE as f32,
    };
    let scene = scene_of(vec![body], vec![light], None);
    let transport = Transport::new(&scene, 1).unwrap();
    let areas = areas_mm2(&scene.objects[0], SIZE);
    let whole: f64 = areas.iter().sum();
    assert!((whole / (4.0 * PI * RADIUS_MM * RADIUS_MM) - 1.0).abs() < 3e-3, "the ball's surface: {whole}");
    let settings = Settings { irradiance_size: SIZE as u32, samples_per_pixel: 16, ..Settings::default() };
    // The lamp's radiance E/(π sin²) times its solid angle 2π (1 - cos) times the ball's cross section, of which the
    // edges of 96 facets cut off 0.1 %.
    let expected = 2.0 * 2.0 / (1.0 + HALF_ANGLE.cos()) * PI * RADIUS_MM * RADIUS_MM;
    // On the ball +x is at a quarter of the turn or three, so that the map has a bright and a dark half.
    let sides = [Start::Light, Start::Texel].map(|start| {
        let map = ExitanceMap::starting(start, &transport, &settings, &Silent).unwrap();
        let flux = |texel: usize| map.exitance_w_per_m2[texel].x * areas[texel];
        let total: f64 = (0..SIZE * SIZE).map(flux).sum();
        let error = (0..SIZE * SIZE).map(|t| (map.standard_error_w_per_m2[t].x * areas[t]).powi(2));
        let error = error.sum::<f64>().sqrt();
        // Four standard errors, and the facets and texels at the poles.
        let off = total - expected;
        assert!(off.abs() < 4.0 * error + 0.004 * expected, "{start:?}: {total} ± {error} of {expected}");
        assert!(error < 0.02 * expected, "{start:?}: {error}");
        (0..SIZE / 8)
            .map(|b| (0..SIZE * SIZE).filter(|t| t % SIZE / 8 == b).map(flux).sum())
            .collect::<Vec<f64>>()
    });
    for (block, (light, texel)) in sides[0].iter().zip(&sides[1]).enumerate() {
        assert!((light - texel).abs() < 0.02 * expected, "columns {block}: {light} and {texel}");
    }
    let (dark, bright) = sides[0].iter().fold((f64::MAX, 0.0f64), |(a, b), &x| (a.min(x), b.max(x)));
    assert!(bright > 3.0 * dark, "{dark} {bright}");
}
