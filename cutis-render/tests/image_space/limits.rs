//! Ends of its numbers, and what must not change the picture.

use crate::common::split;
use crate::scenes::{ball_under_the_sky, draw, exitances, mean, plane, settings, sun, white};
use cutis_optics::{Medium, RgbGaussianSum};
use cutis_render::technique::image_space::ImageSpaceSettings;
use cutis_render::{Aov, Diffusion, Settings, TechniqueName};
use cutis_scene::validation::shapes;
use cutis_scene::{Object, Scattering};
use glam::Vec3;

#[test]
fn no_free_path_is_an_opaque_surface_and_an_endless_one_is_dark() {
    let tiny = |l: f64| Medium::new(0.01 / l, 1.0 / l, 1.4).expect("is physical");
    let scene = |l| plane(white(Scattering::Medium([tiny(l); 3])), Vec3::Z * 1000.0, sun(1.0));
    let own = settings(ImageSpaceSettings::default());
    let sampled = exitances(&draw(&scene(1e-6), &own));
    let opaque = exitances(&draw(&scene(1e-6), &Settings { diffusion: Diffusion::None, ..own.clone() }));
    let off = (mean(&sampled) - mean(&opaque)).abs().max_element();
    // The opaque kernel is a fit, whose total is that of the dipole; the table holds R to 1e-4.
    assert!(off < 2e-3 * mean(&opaque).x, "{} against {}", mean(&sampled), mean(&opaque));
    let spread =
        exitances(&draw(&scene(1e-6), &Settings { technique: TechniqueName::TextureSpace, ..own.clone() }));
    let off = (mean(&spread) - mean(&opaque)).abs().max_element();
    assert!(off < 1e-4 * mean(&opaque).x, "texture-space: {} against {}", mean(&spread), mean(&opaque));
    let endless = exitances(&draw(&scene(1e9), &own));
    assert!(endless.iter().all(|e| e.is_finite() && e.max_element() < 1e-6), "{}", mean(&endless));
}

/// Radii that rounding draws beyond the table's end, of a kernel that is made for it, and a disc as large as one may be.
#[test]
fn what_is_drawn_beyond_the_table_is_nothing() {
    let weights = vec![[0.583_007_93; 3], [0.416_992_07; 3]];
    let kernel = RgbGaussianSum { variances_mm2: vec![0.01, 1.0], weights };
    let disc = ImageSpaceSettings { uniform_radius_mm: Some(1e6), ..Default::default() };
    let follow = ImageSpaceSettings { samples: 512, uniform_samples: 0, ..Default::default() };
    for (own, round) in [(disc, 0), (follow, 0), (follow, 1), (follow, 2)] {
        let mut scene = ball_under_the_sky(6.0, 32);
        scene.objects[0].material = white(Scattering::Kernel(kernel.clone()));
        let pixels = exitances(&draw(&scene, &settings(ImageSpaceSettings { round, ..own })));
        assert!(pixels.iter().all(|e| e.is_finite()), "round {round}");
    }
}

/// Pixels that a body of many triangles shares with one of few.
#[test]
fn a_small_body_stands_before_a_large_one() {
    let mut scene = ball_under_the_sky(6.0, 64);
    let wall = shapes::cuboid(Vec3::new(3.0, 0.0, 8.0), Vec3::new(1.3, 8.0, 0.5));
    scene.objects.insert(0, Object::new("wall", wall, scene.objects[0].material.clone()));
    let own = ImageSpaceSettings::default();
    let picture = Settings { samples_per_pixel: 9, aovs: vec![Aov::Albedo], ..settings(own) };
    let [both, other] = [Vec3::new(1.0, 0.5, 0.5), Vec3::new(0.5, 1.0, 0.5)].map(|colour| {
        scene.objects[0].material.albedo.factor = colour;
        exitances(&draw(&scene, &picture))
    });
    // Pixels of the wall have its colour, whichever that is; those of the ball stay white.
    let pairs = || both.iter().zip(&other);
    let wall = pairs().filter(|(a, b)| (a.x, a.y, b.x, b.y) == (1.0, 0.5, 0.5, 1.0)).count();
    let ball = pairs().filter(|(a, b)| **a == Vec3::ONE && **b == Vec3::ONE).count();
    assert!(wall > 100 && ball > 500, "{wall} pixels of the wall, {ball} of the ball");
}

/// Triangles cut into four, by image-space with planes of triangles and of the smooth surface, and by the techniques that have
/// no test of their own for it.
#[test]
fn triangles_may_be_split() {
    let mut whole = ball_under_the_sky(6.0, 32);
    whole.lights = vec![sun(3.0)];
    let mut cut = whole.clone();
    let object = &whole.objects[0];
    cut.objects = vec![Object::new("ball", split(&object.mesh), object.material.clone())];
    let sampled = |jacobian| settings(ImageSpaceSettings { jacobian, ..Default::default() });
    let by = |technique| Settings { technique, ..settings(ImageSpaceSettings::default()) };
    for (name, settings) in [
        ("planes", sampled(true)),
        ("smooth", sampled(false)),
        ("wrap", by(TechniqueName::Wrap)),
        ("texture-blur", by(TechniqueName::TextureBlur)),
        ("texture-space", by(TechniqueName::TextureSpace)),
    ] {
        let [a, b] = [&whole, &cut].map(|scene| exitances(&draw(scene, &settings)));
        let apart =
            a.iter().zip(&b).map(|(a, b)| (*a - *b).abs().max_element()).sum::<f32>() / a.len() as f32;
        let level = mean(&a).x;
        eprintln!("{name}: {apart} apart, of {level}");
        assert!(level > 0.1 && apart < 1e-3 * level, "{name}: {apart} of {level}");
    }
}
