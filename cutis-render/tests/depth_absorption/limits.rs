//! Where numbers go to their ends.

use crate::common::split;
use crate::scenes::{ball, draw, exitance, plain, plate, scene, settings, sun, white};
use cutis_optics::RgbGaussianSum;
use cutis_render::technique::depth_absorption::{DepthAbsorptionSettings, EntryPoint, FallOff};
use cutis_render::{CpuRenderer, Diffusion, Renderer, Settings, Silent};
use cutis_scene::validation::shapes::patch;
use cutis_scene::{Object, Scattering, Scene};
use glam::{Vec3, Vec4};

fn lit_ball() -> Scene {
    let mut lit =
        scene(vec![ball(10.0)], vec![sun(Vec3::new(1.0, 0.0, 0.0)), sun(Vec3::new(-0.6, 0.3, -0.5))]);
    lit.camera.vertical_fov_rad = 0.043;
    lit
}

fn picture(scene: &Scene, settings: &Settings) -> Vec<Vec4> {
    CpuRenderer
        .render(scene, &Settings { width: 48, height: 48, ..settings.clone() }, &Silent)
        .expect("draws")
        .pixels
}

fn mean_difference(a: &[Vec4], b: &[Vec4]) -> f32 {
    let apart: f32 = a.iter().zip(b).map(|(a, b)| (a - b).abs().truncate().element_sum()).sum();
    apart / b.iter().map(|b| b.truncate().element_sum()).sum::<f32>()
}

#[test]
fn without_a_free_path_it_is_plain_diffuse_shading() {
    let mut lit = lit_ball();
    let usual =
        DepthAbsorptionSettings { fall_off: FallOff::Exponential(Vec3::splat(1e30)), ..Default::default() };
    let opaque = Settings { diffusion: Diffusion::None, ..settings(usual.clone()) };
    let expected = picture(&lit, &opaque);
    for entry in EntryPoint::ALL {
        let got = picture(&lit, &settings(DepthAbsorptionSettings { entry, ..usual.clone() }));
        // The opaque surface is shaded at texels and read between them: their chords lie below the cosine by (texel/R)²/8,
        // half a percent, and shadows end within one texel of 50 around.
        let apart = mean_difference(&got, &expected);
        assert!(apart < 0.01, "{entry}: {apart}");
    }
    // A material that spreads no light, and one that spreads it a nanometre.
    for variance_mm2 in [0.0, 1e-12] {
        let kernel = RgbGaussianSum { variances_mm2: vec![variance_mm2], weights: vec![[1.0; 3]] };
        lit.objects[0].material.scattering = Scattering::Kernel(kernel);
        let got = picture(&lit, &settings(DepthAbsorptionSettings::default()));
        let apart = mean_difference(&got, &expected);
        assert!(apart < 0.01, "{variance_mm2} mm²: {apart}");
    }
}

#[test]
fn with_an_endless_free_path_everything_comes_through() {
    for sigma in [0.0, 1e-9] {
        let fall_off = FallOff::Exponential(Vec3::splat(sigma));
        let got = exitance(
            &scene(vec![plate(30.0)], vec![sun(-Vec3::Z)]),
            DepthAbsorptionSettings { fall_off, ..plain() },
        );
        assert!((got - 1.0).abs().max_element() < 1e-5, "{sigma}: {got}");
    }
    // A material that spreads light a kilometre.
    let mut body = plate(30.0);
    let kernel = RgbGaussianSum { variances_mm2: vec![1e12], weights: vec![[1.0; 3]] };
    body.material.scattering = Scattering::Kernel(kernel);
    let got = exitance(
        &scene(vec![body], vec![sun(-Vec3::Z)]),
        DepthAbsorptionSettings { fall_off: FallOff::Material, ..plain() },
    );
    // e^(-30 / 1e6).
    assert!((got - 1.0).abs().max_element() < 4e-5, "{got}");
}

#[test]
fn an_open_surface_lets_nobody_know_where_light_came_in() {
    let sheet = || patch(8, 0.02, |u| 80.0 * u - 40.0, |v| 80.0 * v - 40.0);
    let lit = scene(vec![Object::new("sheet", sheet(), white())], vec![sun(Vec3::new(0.3, 0.1, -0.9))]);
    for (growth_mm, layers, samples) in [(0.0, 1, 1), (0.0, 1, 8), (0.5, 1, 8), (0.5, 4, 8)] {
        // The normal of the entry would make it dark by itself.
        let entry = EntryPoint::Distance;
        let depth =
            DepthAbsorptionSettings { growth_mm, layers, samples, entry, filter_radius_mm: 1.0, ..plain() };
        let frame = draw(&lit, depth);
        let is_dark = frame.pixels.iter().all(|p| p.truncate() == Vec3::ZERO);
        assert!(is_dark, "{growth_mm}, {layers}, {samples}");
        assert!(frame.layers[1].pixels.iter().all(|p| p.is_finite()));
    }
}

#[test]
fn no_line_shows_at_the_terminator() {
    // The light is at the right, so that the terminator is the middle of the picture; 0.8 mm of it are seen.
    let mut lit = scene(vec![ball(10.0)], vec![sun(Vec3::X)]);
    lit.camera.vertical_fov_rad = 0.8 / 490.0;
    for entry in EntryPoint::ALL {
        for (growth_mm, filter_radius_mm) in [(0.0, 0.0), (0.5, 1.0)] {
            let fall_off = FallOff::Exponential(Vec3::splat(0.3));
            let depth = DepthAbsorptionSettings {
                entry,
                growth_mm,
                filter_radius_mm,
                samples: 16,
                fall_off,
                layers: 1,
            };
            let frame = CpuRenderer
                .render(&lit, &Settings { width: 32, height: 32, ..settings(depth) }, &Silent)
                .expect("draws");
            let brightest = frame.layers[0].pixels.iter().map(|p| p.x).fold(0.0, f32::max);
            // cos = 0.4 mm / 10 mm at the edge of the picture, and no brighter on the far side.
            assert!(brightest < 0.045, "{entry}, {growth_mm}, {filter_radius_mm}: {brightest}");
        }
    }
}

#[test]
fn triangles_may_be_split() {
    let whole = lit_ball();
    let mut cut = lit_ball();
    let mesh = split(&whole.objects[0].mesh);
    cut.objects = vec![Object::new("ball", mesh, white())];
    for layers in [1, 4] {
        let depth = DepthAbsorptionSettings { samples: 4, filter_radius_mm: 1.0, layers, ..plain() };
        let [a, b] = [&whole, &cut].map(|scene| picture(scene, &settings(depth.clone())));
        // Weights of a quarter of the triangle are rounded anew; shadows are read from texels between its corners.
        let apart = mean_difference(&a, &b);
        assert!(apart < 1e-4, "{layers}: {apart}");
    }
}
