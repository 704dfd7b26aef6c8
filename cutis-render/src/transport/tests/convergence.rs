//! Noise falls as the square root of the number of samples: what is drawn is independent, and has a variance.

use super::{ball, even_environment, material, scene_of};
use crate::Silent;
use crate::settings::Settings;
use crate::technique::truth;
use cutis_scene::{Light, Scene};
use glam::{Vec3, Vec4};

/// A ball that fills the picture, so that no pixel sees its edge: within a pixel samples are spread more evenly than by
/// chance, and there noise would fall faster.
fn ball_close_by(roughness: f32, lamps: usize) -> Scene {
    let lamp = Light::Point {
        position_mm: Vec3::new(40.0, 60.0, 70.0),
        intensity_w_per_sr: Vec3::new(0.03, 0.02, 0.01),
        radius_mm: 8.0,
    };
    let object = ball(10.0, 16, material(0.1, 1.0, 1.4, roughness));
    let mut scene = scene_of(vec![object], vec![lamp; lamps], Some(even_environment()));
    scene.camera.vertical_fov_rad = 0.1;
    scene
}

/// Root mean squared error of a picture with so many samples per pixel, from pairs of independent ones: their difference has
/// twice the variance of each.
fn error(scene: &Scene, samples_per_pixel: u32, pairs: u64) -> f64 {
    let picture = |seed| {
        let settings = Settings { width: 16, height: 16, samples_per_pixel, seed, ..Settings::default() };
        truth::render(scene, &settings, &Silent).unwrap().pixels
    };
    let mut squares = 0.0;
    for pair in 0..pairs {
        let first = 1 + u64::from(samples_per_pixel) * 1000 + 2 * pair;
        let (a, b) = (picture(first), picture(first + 1));
        let square = |(a, b): (&Vec4, &Vec4)| f64::from((a.truncate() - b.truncate()).length_squared());
        squares += a.iter().zip(&b).map(square).sum::<f64>() / (2.0 * 3.0 * a.len() as f64);
    }
    (squares / pairs as f64).sqrt()
}

/// Slope of the logarithm of the error against that of the number of samples, by least squares.
fn slope(scene: &Scene, samples: &[u32], pairs: u64) -> f64 {
    let points: Vec<(f64, f64)> =
        samples.iter().map(|&n| (f64::from(n).ln(), error(scene, n, pairs).ln())).collect();
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
    let slope = mean(&|p| (p.0 - x) * (p.1 - y)) / mean(&|p| (p.0 - x).powi(2));
    eprintln!("slope {slope:.4} from errors {:?}", points.iter().map(|p| p.1.exp()).collect::<Vec<_>>());
    slope
}

#[test]
fn noise_falls_as_the_root_of_the_samples() {
    // No path carries more than a few times the mean: 256 pixels and 4 pairs tell each error to 2 %, the slope over two steps
    // of ln 4 to 0.01.
    let slope = slope(&ball_close_by(0.0, 0), &[8, 32, 128], 4);
    assert!((slope + 0.5).abs() < 0.05, "{slope}");
}

#[test]
#[ignore = "slow suite: up to 1024 samples"]
fn slow_noise_falls_as_the_root_of_the_samples() {
    let slope = slope(&ball_close_by(0.4, 1), &[16, 64, 256, 1024], 4);
    assert!((slope + 0.5).abs() < 0.05, "{slope}");
}
