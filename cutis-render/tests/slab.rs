//! A slab lit from behind against equation 16 by quadrature.

use cutis_optics::{Profile, presets};
use cutis_render::lit_scene::LitScene;
use cutis_render::{Aov, Settings, Silent, TechniqueName};
use cutis_scene::{Camera, Light, Material, Mesh, Object, ScalarMap, Scene};
use glam::{Vec2, Vec3, Vec4};
use std::f64::consts::TAU;

const SIDE_MM: f32 = 160.0;

/// A box of `thickness_mm` whose six faces are charts of their own; its broad sides face +z and -z.
fn slab(thickness_mm: f32) -> Object {
    let half = Vec3::new(SIDE_MM, SIDE_MM, thickness_mm) * 0.5;
    let mut mesh = Mesh::default();
    let faces = [
        (Vec3::Z, Vec3::X),
        (-Vec3::Z, -Vec3::X),
        (Vec3::X, -Vec3::Z),
        (-Vec3::X, Vec3::Z),
        (Vec3::Y, Vec3::X),
        (-Vec3::Y, Vec3::X),
    ];
    for (i, (normal, right)) in faces.into_iter().enumerate() {
        let up = normal.cross(right);
        let base = mesh.positions_mm.len() as u32;
        let corner = Vec2::new((i % 3) as f32, (i / 3) as f32) / 3.0 + 0.02;
        for (a, b) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            mesh.positions_mm.push((normal + right * a + up * b) * half);
            mesh.normals.push(normal);
            mesh.uvs.push(corner + Vec2::new(0.5 + 0.5 * a, 0.5 - 0.5 * b) * 0.29);
        }
        mesh.triangles.extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
    }
    let mut material = Material { rho_s: ScalarMap::constant(0.0), ..Material::default() };
    material.albedo.factor = Vec3::ONE;
    Object::new("slab", mesh, material)
}

fn backlit(thickness_mm: f32) -> Scene {
    let light = Light::Directional {
        dir_to_light: -Vec3::Z,
        irradiance_w_per_m2: Vec3::ONE,
        angular_radius_rad: 0.0,
    };
    let camera = Camera {
        position_mm: Vec3::Z * 500.0,
        look_at_mm: Vec3::ZERO,
        up: Vec3::Y,
        vertical_fov_rad: 0.02,
        exposure_ev: 0.0,
    };
    Scene {
        objects: vec![slab(thickness_mm)],
        lights: vec![light],
        environment: None,
        camera,
        background: None,
        warnings: Vec::new(),
    }
}

/// 2 pi ∫ R(sqrt(r² + d²)) r dr for an infinite plane lit evenly from behind, by the midpoint rule.
fn equation_16(channel: usize, thickness_mm: f64) -> f64 {
    let kernel = presets::find("three-layer-skin").expect("ships inside").kernel(6).expect("is a constant");
    let profile = kernel.channel(channel);
    let (steps, reach_mm) = (40_000, 40.0);
    let step = reach_mm / f64::from(steps);
    let ring = |i: i32| {
        let r = (f64::from(i) + 0.5) * step;
        profile.at_mm(r.hypot(thickness_mm)) * TAU * r * step
    };
    (0..steps).map(ring).sum()
}

/// Radiance that came through the middle of a slab.
fn through(scene: &Scene) -> Vec4 {
    let settings = Settings {
        width: 4,
        height: 4,
        irradiance_size: 512,
        samples_per_pixel: 1,
        aovs: vec![Aov::Transmission],
        ..Settings::default()
    };
    let mut lit = LitScene::new(scene, &settings, &Silent).expect("draws");
    lit.resolve(&scene.camera, &settings, &Silent).expect("draws").layers[0].pixels[5]
}

/// Light that leaves the middle of a slab by `texture-blur`, W/m².
fn leaves_by_texture_blur(scene: &Scene, passes: u32, depth: bool) -> Vec3 {
    let mut settings = Settings {
        technique: TechniqueName::TextureBlur,
        width: 4,
        height: 4,
        irradiance_size: 256,
        samples_per_pixel: 1,
        aovs: vec![Aov::Exitance],
        ..Settings::default()
    };
    settings.techniques.texture_blur.passes = passes;
    settings.techniques.texture_blur.depth = depth;
    let mut lit = LitScene::new(scene, &settings, &Silent).expect("draws");
    lit.resolve(&scene.camera, &settings, &Silent).expect("draws").layers[0].pixels[5].truncate()
}

#[test]
fn light_through_a_slab_is_in_the_map_that_texture_blur_blurs() {
    let preset = presets::find("three-layer-skin").expect("ships inside").kernel(6).expect("is a constant");
    for (thickness_mm, passes) in [(0.5f32, 0), (1.0, 1), (3.0, 4)] {
        let scene = backlit(thickness_mm);
        assert_eq!(leaves_by_texture_blur(&scene, passes, false), Vec3::ZERO, "its side is dark");
        let leaves = leaves_by_texture_blur(&scene, passes, true);
        for channel in 0..3 {
            let terms = preset.channel(channel).terms;
            let total: f64 = terms.iter().map(|t| t.weight).sum();
            let variance_mm2 = terms.iter().map(|t| t.weight * t.variance_mm2).sum::<f64>() / total;
            let expected = total * (-f64::from(thickness_mm) / variance_mm2.sqrt()).exp();
            // Rays start inside, by 1e-4 mm and 2^-18 of the largest coordinate; half as much more is for rounding.
            let step_mm = 1e-4 + f64::from(0.5 * SIDE_MM) / 262_144.0;
            let off = f64::from(leaves[channel]) / expected - 1.0;
            assert!(
                off.abs() < 1.5 * step_mm / variance_mm2.sqrt(),
                "{thickness_mm} mm, channel {channel}: {leaves} of {expected}"
            );
        }
    }
}

/// Holds what came through against a slab that is so thick.
fn check_thickness(seen: Vec4, thickness_mm: f64, what: &str) {
    // Below a millionth of the light nothing is seen and the look-up is skipped.
    let [share, little] = [0.02, 4e-6];
    for channel in 0..3 {
        let expected = equation_16(channel, thickness_mm);
        // Leaving light spreads evenly: radiance is exitance over pi. No specular surface, so rho_dt is 1.
        let got = f64::from(seen[channel]) * std::f64::consts::PI;
        let slack = share * expected + little;
        assert!((got - expected).abs() <= slack, "{what}, channel {channel}: {got} against {expected}");
    }
}

#[test]
fn transmission_equals_equation_16() {
    for thickness_mm in [0.5f32, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0] {
        let seen = through(&backlit(thickness_mm));
        check_thickness(seen, f64::from(thickness_mm), &format!("{thickness_mm} mm"));
    }
}

#[test]
fn a_scale_that_makes_no_sense_is_refused() {
    for scale in [-1.0, f32::NAN, f32::INFINITY] {
        let mut scene = backlit(1.0);
        scene.objects[0].material.thickness_scale = scale;
        let refused =
            LitScene::new(&scene, &Settings::default(), &Silent).map(|_| ()).expect_err("no such body");
        assert!(refused.to_string().contains("thickness scale"), "{refused}");
    }
}

#[test]
fn a_slab_is_as_thick_as_its_scale_says() {
    // The last is thicker than what is opaque, and a scale of 0 leaves nothing in between.
    for (thickness_mm, thickness_scale) in
        [(2.0f32, 0.0), (3.0, 0.5), (0.5, 2.0), (1.0, 2.0), (3.0, 2.0), (9.0, 2.0)]
    {
        let mut scene = backlit(thickness_mm);
        scene.objects[0].material.thickness_scale = thickness_scale;
        let what = format!("{thickness_mm} mm, scaled by {thickness_scale}");
        check_thickness(through(&scene), f64::from(thickness_mm * thickness_scale), &what);
    }
}
