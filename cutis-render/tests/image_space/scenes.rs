//! Bodies that light is gathered on, and pictures of them.

use cutis_optics::Medium;
use cutis_render::settings::TechniqueSettings;
use cutis_render::technique::image_space::ImageSpaceSettings;
use cutis_render::{Aov, CpuRenderer, Frame, Renderer, Settings, Silent, TechniqueName};
use cutis_scene::validation::shapes;
use cutis_scene::{
    Camera, ColourMap, Environment, Light, Material, Object, Scattering, Scene, Texels, Texture,
};
use glam::Vec3;
use std::sync::Arc;

/// White, without a surface of its own, so that what leaves is the kernel's alone.
pub fn white(scattering: Scattering) -> Material {
    Material {
        scattering,
        albedo: ColourMap { factor: Vec3::ONE, texture: None },
        rho_s: cutis_scene::ScalarMap::constant(0.0),
        ..Material::default()
    }
}

pub fn medium() -> Medium {
    Medium::new(0.05, 1.0, 1.4).expect("is physical")
}

/// A plane of 200 mm, looked at from above or aside, under light that falls straight down on `lit`.
pub fn plane(material: Material, eye_mm: Vec3, light: Light) -> Scene {
    let mesh = shapes::patch(8, 1.0 / 64.0, |u| 200.0 * u - 100.0, |v| 200.0 * v - 100.0);
    Scene {
        objects: vec![Object::new("plane", mesh, material)],
        lights: vec![light],
        environment: None,
        camera: Camera {
            position_mm: eye_mm,
            look_at_mm: Vec3::ZERO,
            up: Vec3::Y,
            vertical_fov_rad: 0.1,
            exposure_ev: 0.0,
        },
        background: None,
        warnings: Vec::new(),
    }
}

pub fn sun(irradiance: f32) -> Light {
    Light::Directional {
        dir_to_light: Vec3::Z,
        irradiance_w_per_m2: Vec3::splat(irradiance),
        angular_radius_rad: 0.0,
    }
}

pub fn settings(image_space: ImageSpaceSettings) -> Settings {
    Settings {
        technique: TechniqueName::ImageSpace,
        techniques: TechniqueSettings { image_space, ..TechniqueSettings::default() },
        width: 48,
        height: 48,
        samples_per_pixel: 1,
        irradiance_size: 256,
        aovs: vec![Aov::Exitance],
        ..Settings::default()
    }
}

pub fn draw(scene: &Scene, settings: &Settings) -> Frame {
    CpuRenderer.render(scene, settings, &Silent).expect("draws")
}

/// Exitance of all pixels.
pub fn exitances(frame: &Frame) -> Vec<Vec3> {
    frame.layers[0].pixels.iter().map(|p| p.truncate()).collect()
}

pub fn mean(values: &[Vec3]) -> Vec3 {
    values.iter().copied().sum::<Vec3>() / values.len() as f32
}

/// A ball of so many millimetres under even light from everywhere, 1 W/m²/sr, its face as large as the picture or a little
/// larger.
pub fn ball_under_the_sky(radius_mm: f32, sides: u32) -> Scene {
    let material = white(Scattering::Medium([medium(); 3]));
    let ball = Object::new("ball", shapes::capsule(Vec3::ZERO, radius_mm, 0.0, sides), material.clone());
    let mut scene = plane(material, Vec3::Z * 1000.0, sun(0.0));
    scene.objects = vec![ball];
    scene.camera.vertical_fov_rad = 0.0022 * radius_mm;
    let sky = Texture::new(2, 1, Texels::LinearF32(vec![[1.0; 4]; 2]));
    scene.environment = Some(Environment {
        map: Arc::new(sky),
        rotation_rad: 0.0,
        radiance_scale: Vec3::ONE,
        visible: false,
    });
    scene
}
