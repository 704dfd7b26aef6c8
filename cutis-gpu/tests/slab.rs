//! A slab lit from behind against equation 16 by quadrature, and a white furnace, on the device.

mod common;

use common::{renderer, tolerances};
use cutis_gpu::GpuRenderer;
use cutis_optics::{Profile, RgbGaussianSum, presets};
use cutis_render::{Aov, Renderer, Settings, Silent};
use cutis_scene::{
    Camera, Environment, Light, Material, Mesh, Object, ScalarMap, Scattering, Scene, Texels, Texture,
};
use glam::{Vec2, Vec3, Vec4};
use std::f64::consts::TAU;
use std::sync::Arc;

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
fn through(renderer: &GpuRenderer, scene: &Scene) -> Vec4 {
    let settings = Settings {
        width: 4,
        height: 4,
        irradiance_size: 512,
        samples_per_pixel: 1,
        aovs: vec![Aov::Transmission],
        ..Settings::default()
    };
    let frame = renderer.render(scene, &settings, &Silent).expect("draws");
    frame.layers[0].pixels[5]
}

/// Holds what came through against a slab that is so thick.
fn check_thickness(seen: Vec4, thickness_mm: f64, what: &str) {
    let [share, little] = tolerances::EQUATION_16;
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
    let Some(renderer) = renderer("transmission_equals_equation_16") else { return };
    for thickness_mm in [0.5f32, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0] {
        let seen = through(renderer, &backlit(thickness_mm));
        check_thickness(seen, f64::from(thickness_mm), &format!("{thickness_mm} mm"));
    }
}

#[test]
fn a_slab_is_as_thick_as_its_scale_says() {
    let Some(renderer) = renderer("a_slab_is_as_thick_as_its_scale_says") else { return };
    // The last is thicker than what is opaque, and a scale of 0 leaves nothing in between.
    for (thickness_mm, thickness_scale) in
        [(2.0f32, 0.0), (3.0, 0.5), (0.5, 2.0), (1.0, 2.0), (3.0, 2.0), (9.0, 2.0)]
    {
        let mut scene = backlit(thickness_mm);
        scene.objects[0].material.thickness_scale = thickness_scale;
        let what = format!("{thickness_mm} mm, scaled by {thickness_scale}");
        check_thickness(through(renderer, &scene), f64::from(thickness_mm * thickness_scale), &what);
    }
}

/// An environment of radiance 1 everywhere.
fn furnace() -> Environment {
    let map = Texture::new(1, 1, Texels::LinearF32(vec![[1.0; 4]]));
    Environment { map: Arc::new(map), rotation_rad: 0.0, radiance_scale: Vec3::ONE, visible: false }
}

#[test]
fn nothing_is_gained_in_a_white_furnace() {
    let Some(renderer) = renderer("nothing_is_gained_in_a_white_furnace") else { return };
    for rho_s in [0.0, 1.0] {
        let mut scene = backlit(60.0);
        scene.lights.clear();
        scene.environment = Some(furnace());
        scene.camera.vertical_fov_rad = 0.2;
        scene.camera.position_mm = Vec3::new(300.0, 200.0, 400.0);
        scene.objects[0].material.rho_s = ScalarMap::constant(rho_s);
        scene.objects[0].material.scattering = Scattering::Kernel(white_kernel());
        let settings = Settings {
            width: 32,
            height: 32,
            irradiance_size: 256,
            samples_per_pixel: 1,
            ..Settings::default()
        };
        let frame = renderer.render(&scene, &settings, &Silent).expect("draws");
        let brightest = frame.pixels.iter().map(|p| p.truncate().max_element()).fold(0.0, f32::max);
        // White without shine gives back what falls in; with shine a little is lost between the two.
        assert!(brightest <= 1.0 + tolerances::FURNACE, "rho_s {rho_s}: {brightest}");
        assert!(rho_s > 0.0 || brightest >= 1.0 - tolerances::FURNACE, "{brightest}");
    }
}

/// A body that gives back all light.
fn white_kernel() -> RgbGaussianSum {
    RgbGaussianSum { variances_mm2: vec![0.5], weights: vec![[1.0; 3]] }
}
