#![allow(clippy::unwrap_used, reason = "tests")]
use super::*;
use crate::transport::tests::scene_of;
use cutis_scene::{Environment, Texels, Texture};
use glam::{Vec3, Vec4};
use std::sync::Arc;

/// Irradiance on a surface facing +y, from draws and from directions that happen to meet lights.
fn irradiance(scene: &Scene, draws: u32) -> [DVec3; 2] {
    let emitters = Emitters::new(scene);
    let mut random = Random::new(4, 0, 0);
    let (mut drawn, mut met) = (DVec3::ZERO, DVec3::ZERO);
    for _ in 0..draws {
        let draw = emitters.draw(emitters.all(), DVec3::ZERO, &mut random).unwrap();
        drawn += draw.light * draw.dir.y.max(0.0);
        let d = random.cosine_hemisphere();
        let dir = DVec3::new(d.x, d.z, d.y);
        met += emitters.seen(emitters.all(), DVec3::ZERO, dir).map(|seen| seen.radiance * PI).sum::<DVec3>();
    }
    [drawn / f64::from(draws), met / f64::from(draws)]
}

#[test]
fn a_sphere_gives_the_irradiance_it_states() {
    let light = Light::Point {
        position_mm: Vec3::new(0.0, 100.0, 0.0),
        intensity_w_per_sr: Vec3::new(1.0, 2.0, 0.5) * 0.01,
        radius_mm: 60.0,
    };
    let scene = scene_of(vec![], vec![light], None);
    for found in irradiance(&scene, 40_000) {
        // sin² of 0.36 of all directions meet it: standard error 0.67 %; drawn ones vary less.
        assert!((found / DVec3::new(1.0, 2.0, 0.5) - 1.0).abs().max_element() < 0.03, "{found}");
    }
}

#[test]
fn an_environment_is_drawn_as_bright_as_it_is() {
    let texel = |i: usize| {
        let (x, y) = (i % 16, i / 16);
        let bright = if x == 5 && y == 1 { 40.0 } else { 1.0 + (x + 2 * y) as f32 * 0.05 };
        [bright, 0.5 * bright, 1.0, 1.0]
    };
    let map = Arc::new(Texture::new(16, 8, Texels::LinearF32((0..128).map(texel).collect())));
    let environment =
        Environment { map, rotation_rad: 0.4, radiance_scale: Vec3::splat(0.7), visible: false };
    let scene = scene_of(vec![], vec![], Some(environment.clone()));
    // By quadrature over the upper hemisphere.
    let (rings, sectors) = (400, 1600);
    let mut expected = Vec4::ZERO.truncate().as_dvec3();
    for (i, j) in (0..rings).flat_map(|i| (0..sectors).map(move |j| (i, j))) {
        let (theta, turn) = (0.5 * PI * (i as f64 + 0.5) / rings as f64, TAU * j as f64 / sectors as f64);
        let dir = DVec3::new(theta.sin() * turn.cos(), theta.cos(), theta.sin() * turn.sin());
        let angle = theta.sin() * theta.cos() * 0.5 * PI / rings as f64 * TAU / sectors as f64;
        expected += environment.radiance(dir.as_vec3()).as_dvec3() * angle;
    }
    for found in irradiance(&scene, 40_000) {
        // Directions by chance vary by 2.6 of the mean for the bright texel: 1.3 %; drawn ones by 0.5 %. Four of them.
        assert!((found / expected - 1.0).abs().max_element() < 0.05, "{found} {expected}");
    }
}

#[test]
fn the_density_told_is_that_of_the_draws() {
    // Mean of 1/density over the draws is the solid angle they come from, if density is what it says.
    let map = Arc::new(Texture::new(2, 2, Texels::LinearF32(vec![[1.0; 4], [5.0; 4], [2.0; 4], [0.0; 4]])));
    let environment = Environment { map, rotation_rad: 0.0, radiance_scale: Vec3::ONE, visible: false };
    let scene = scene_of(vec![], vec![], Some(environment));
    let emitters = Emitters::new(&scene);
    let mut random = Random::new(4, 0, 0);
    let n = 20_000;
    let mean: f64 = (0..n)
        .map(|_| {
            emitters.draw(emitters.all(), DVec3::ZERO, &mut random).unwrap().density_per_sr.unwrap().recip()
        })
        .sum::<f64>()
        / f64::from(n);
    // Densities vary by a factor of some ten: standard error below 2 %.
    assert!((mean / (4.0 * PI) - 1.0).abs() < 0.08, "{mean}");
}
