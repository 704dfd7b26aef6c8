//! Bodies whose thickness is known, in light from behind, and pictures of them.

use cutis_optics::RgbGaussianSum;
use cutis_render::technique::depth_absorption::{DepthAbsorptionSettings, EntryPoint, FallOff};
use cutis_render::{Aov, CpuRenderer, Frame, Renderer, Settings, Silent, TechniqueName};
use cutis_scene::validation::shapes::{capsule, cuboid};
use cutis_scene::{Camera, Light, Material, Object, ScalarMap, Scattering, Scene};
use glam::Vec3;

/// White through and through, without shine: what leaves is what entered and was not absorbed.
pub fn white() -> Material {
    let kernel = RgbGaussianSum { variances_mm2: vec![1.0], weights: vec![[1.0; 3]] };
    let mut material = Material {
        scattering: Scattering::Kernel(kernel),
        rho_s: ScalarMap::constant(0.0),
        ..Material::default()
    };
    material.albedo.factor = Vec3::ONE;
    material
}

/// Far away, of one W/m².
pub fn sun(dir_to_light: Vec3) -> Light {
    Light::Directional {
        dir_to_light: dir_to_light.normalize(),
        irradiance_w_per_m2: Vec3::ONE,
        angular_radius_rad: 0.0,
    }
}

/// A plate of 80 mm across z.
pub fn plate(thickness_mm: f32) -> Object {
    Object::new("plate", cuboid(Vec3::ZERO, Vec3::new(40.0, 40.0, 0.5 * thickness_mm)), white())
}

/// A ball around the origin.
pub fn ball(radius_mm: f32) -> Object {
    Object::new("ball", capsule(Vec3::ZERO, radius_mm, 0.0, 128), white())
}

/// A ball of 10 mm with a hole of 7 mm.
pub fn hollow_ball() -> Object {
    let mut mesh = capsule(Vec3::ZERO, 10.0, 0.0, 128);
    let hole = capsule(Vec3::ZERO, 7.0, 0.0, 128);
    let first = mesh.positions_mm.len() as u32;
    mesh.positions_mm.extend(hole.positions_mm);
    mesh.normals.extend(hole.normals.iter().map(|&n| -n));
    mesh.uvs.iter_mut().for_each(|uv| uv.x *= 0.49);
    mesh.uvs.extend(hole.uvs.iter().map(|&uv| uv * glam::Vec2::new(0.49, 1.0) + glam::Vec2::X * 0.51));
    mesh.triangles.extend(hole.triangles.iter().map(|&[a, b, c]| [first + a, first + c, first + b]));
    Object::new("hollow ball", mesh, white())
}

/// Bodies before black, seen from +z, 8 mm of them.
pub fn scene(objects: Vec<Object>, lights: Vec<Light>) -> Scene {
    let camera = Camera {
        position_mm: Vec3::Z * 500.0,
        look_at_mm: Vec3::ZERO,
        up: Vec3::Y,
        vertical_fov_rad: 0.016,
        exposure_ev: 0.0,
    };
    Scene { objects, lights, environment: None, camera, background: None, warnings: Vec::new() }
}

/// One way to each place, through bodies as they are.
pub fn plain() -> DepthAbsorptionSettings {
    DepthAbsorptionSettings {
        fall_off: FallOff::Exponential(Vec3::new(0.05, 0.2, 1.0)),
        growth_mm: 0.0,
        entry: EntryPoint::Surface,
        samples: 1,
        filter_radius_mm: 0.0,
        layers: 1,
    }
}

/// A small picture by the technique; layers are exitance and distances.
pub fn settings(depth_absorption: DepthAbsorptionSettings) -> Settings {
    let mut settings = Settings {
        technique: TechniqueName::DepthAbsorption,
        width: 4,
        height: 4,
        samples_per_pixel: 1,
        irradiance_size: 128,
        aovs: vec![Aov::Exitance, Aov::Thickness],
        ..Settings::default()
    };
    settings.techniques.depth_absorption = depth_absorption;
    settings
}

/// The picture.
pub fn draw(scene: &Scene, depth_absorption: DepthAbsorptionSettings) -> Frame {
    CpuRenderer.render(scene, &settings(depth_absorption), &Silent).expect("draws")
}

/// Exitance in the middle of it, W/m².
pub fn exitance(scene: &Scene, depth_absorption: DepthAbsorptionSettings) -> Vec3 {
    draw(scene, depth_absorption).layers[0].pixels[5].truncate()
}
