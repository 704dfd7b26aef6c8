//! Planes: even light, and the edge of a shadow.

use crate::scenes::{draw, exitances, medium, plane, settings, sun, white};
use cutis_optics::{Dipole, Profile};
use cutis_render::Settings;
use cutis_render::technique::image_space::{ImageSpaceSettings, SampleCount};
use cutis_scene::{ColourMap, Material, Scattering, Scene, Texels, Texture};
use glam::Vec3;
use std::sync::Arc;

/// Mean over some pixels in each of [`ROUNDS`] rounds, then their mean and its standard error: neighbours share sixteen
/// patterns, so that only rounds are apart.
fn over_rounds(draw_round: impl Fn(u32) -> f32) -> [f32; 2] {
    let means: Vec<f32> = (0..ROUNDS).map(draw_round).collect();
    let n = ROUNDS as f32;
    let mean = means.iter().sum::<f32>() / n;
    let variance = means.iter().map(|m| (m - mean).powi(2)).sum::<f32>() / (n - 1.0);
    [mean, (variance / n).sqrt()]
}

/// Rounds that a mean is taken over. Of eight, 3 standard errors are passed by chance once in 50, 4 once in 190; seeds are fixed.
const ROUNDS: u32 = 8;

/// On a plane under even light every sample that follows a single profile finds the same: R_d E without noise. Uniform samples
/// beside them add noise and no bias; seen aside, the areas of plane and image still agree.
#[test]
fn an_even_plane_sends_back_the_diffuse_reflectance() {
    let expected = Dipole::new(&medium()).expect("is physical").total() as f32;
    for (eye_mm, uniform_samples) in
        [(Vec3::Z * 1000.0, 0), (Vec3::Z * 1000.0, 16), (Vec3::new(800.0, 0.0, 500.0), 16)]
    {
        let scene = plane(white(Scattering::Medium([medium(); 3])), eye_mm, sun(1.0));
        // The image is 30 mm wide at least, and the middle of it sees nothing of its border.
        let in_round = |round| {
            let own =
                ImageSpaceSettings { uniform_samples, count: SampleCount::All, round, ..Default::default() };
            let pixels = exitances(&draw(&scene, &settings(own)));
            let middle = (16..32).flat_map(|y| (16..32).map(move |x| y * 48 + x));
            middle.map(|i| pixels[i].x).sum::<f32>() / 256.0
        };
        let [mean, error] = over_rounds(in_round);
        eprintln!("{uniform_samples} uniform samples: {mean} ± {error}, expected {expected}");
        // Beside the errors: the table holds R to 1e-4, and a millionth of the light lies beyond it.
        assert!((mean - expected).abs() < 3.0 * error + 3e-4 * expected, "{mean} against {expected}");
    }
}

/// A plane whose left half takes in no light: a film that is black there, passed on the way in only.
fn half_lit() -> Scene {
    let texels = (0..2048).map(|x| if x < 1024 { [0.0, 0.0, 0.0, 1.0] } else { [1.0; 4] }).collect();
    let film = Texture::new(2048, 1, Texels::LinearF32(texels));
    let albedo = ColourMap { factor: Vec3::ONE, texture: Some(Arc::new(film)) };
    let material = Material { albedo, albedo_mix: 1.0, ..white(Scattering::Medium([medium(); 3])) };
    let mut scene = plane(material, Vec3::Z * 1000.0, sun(1.0));
    scene.camera.vertical_fov_rad = 0.03;
    scene
}

/// Light of a half-plane at a distance from its edge, as a share of R_d: 1/2 and the line's profile integrated over the
/// distance, the line being ∫ R(sqrt(x² + y²)) dy, both by the midpoint rule, in y = t/(1 - t) mm.
fn half_plane(dipole: &Dipole, from_edge_mm: f64) -> f64 {
    let line = |x: f64| {
        let n = 4000;
        let at = |i: i32| {
            let t = (f64::from(i) + 0.5) / f64::from(n);
            dipole.at_mm(x.hypot(t / (1.0 - t))) / (1.0 - t).powi(2)
        };
        2.0 * (0..n).map(at).sum::<f64>() / f64::from(n)
    };
    let n = 200;
    let step = from_edge_mm / f64::from(n);
    0.5 + (0..n).map(|i| line((f64::from(i) + 0.5) * step)).sum::<f64>() * step / dipole.total()
}

/// Across the edge of a half-plane of light the exitance is the integral of the profile, by samples of the profile, over the disc
/// nearly alone, and by both together.
#[test]
fn a_shadow_edge_has_the_profile_of_a_half_plane() {
    let dipole = Dipole::new(&medium()).expect("is physical");
    let pixel_mm = 1000.0 * 2.0 * 0.015f64.tan() / 96.0;
    let mut noise = [0.0f32; 3];
    for (i, (samples, uniform_samples)) in [(32, 0), (16, 16), (1, 31)].into_iter().enumerate() {
        let frames: Vec<Vec<Vec3>> = (0..ROUNDS)
            .map(|round| {
                let uniform_radius_mm = Some(12.0);
                let own = ImageSpaceSettings {
                    samples,
                    uniform_samples,
                    uniform_radius_mm,
                    round,
                    ..Default::default()
                };
                exitances(&draw(&half_lit(), &Settings { width: 96, height: 96, ..settings(own) }))
            })
            .collect();
        for x in [28usize, 40, 46, 47, 48, 49, 56, 68] {
            let left_mm = (x as f64 - 48.0) * pixel_mm;
            // The mean over the pixel, in which places are random.
            let over: f64 =
                (0..8).map(|k| half_plane(&dipole, left_mm + (f64::from(k) + 0.5) / 8.0 * pixel_mm)).sum();
            // A film of any colour scales the profile to 1: the colour is the film's alone.
            let expected = (over / 8.0) as f32;
            let column =
                |round: u32| (32..64).map(|y| frames[round as usize][y * 96 + x].x).sum::<f32>() / 32.0;
            let [mean, error] = over_rounds(column);
            eprintln!(
                "{samples} + {uniform_samples} at {left_mm:.2} mm: {mean:.5} ± {error:.5}, expected {expected:.5}"
            );
            // Beside four errors: a texel is lit as its middle is, so that of the pixels at the edge, 0.31 mm wide, light within
            // a pixel is shifted by up to a sixth of it on the mean: 0.05 mm of a slope of 0.2 per mm.
            assert!(
                (mean - expected).abs() < 4.0 * error + 0.01,
                "at {left_mm} mm: {mean} against {expected}"
            );
        }
        // Grain of single pixels in the dark near the edge, over what is there.
        for x in [40, 43] {
            let pixels: Vec<f32> = frames.iter().flat_map(|f| (32..64).map(|y| f[y * 96 + x].x)).collect();
            let mean = pixels.iter().sum::<f32>() / pixels.len() as f32;
            let variance = pixels.iter().map(|p| (p - mean).powi(2)).sum::<f32>() / pixels.len() as f32;
            noise[i] += variance.sqrt() / mean / 2.0;
        }
    }
    eprintln!(
        "relative grain in the dark: profile alone {}, combined {}, disc {}",
        noise[0], noise[1], noise[2]
    );
    assert!(noise[1] < noise[0] && noise[1] < noise[2], "{noise:?}");
}
