//! Plain bodies of skin.

use super::shapes::{capsule, cuboid};
use crate::{Camera, ColourMap, Light, Material, Mesh, Object, ScalarMap, Scattering, Scene};
use cutis_optics::presets;
use glam::Vec3;

/// The medium of all bodies but the built-in head.
const MEDIUM: &str = "skin1";
/// Around the ball and the fingers: a corner sinks 0.012 mm below a radius of 10 mm.
const SEGMENTS: u32 = 128;

/// Skin in the colour of its medium, without maps.
pub fn skin() -> Material {
    let preset = presets::find(MEDIUM).expect("it ships inside");
    let index = preset.media().expect("it is a medium")[0].refractive_index as f32;
    let f0 = ((index - 1.0) / (index + 1.0)).powi(2);
    Material {
        name: MEDIUM.to_owned(),
        scattering: Scattering::Preset(MEDIUM.to_owned()),
        albedo: ColourMap { factor: Vec3::ONE, texture: None },
        roughness: ScalarMap::constant(0.3),
        f0,
        ..Material::default()
    }
}

/// A lamp that gives a place an irradiance, were nothing in between.
pub fn lamp(position_mm: Vec3, radius_mm: f32, lit_mm: Vec3, irradiance_w_per_m2: f32) -> Light {
    let distance_m = position_mm.distance(lit_mm) * 1e-3;
    let intensity_w_per_sr = Vec3::splat(irradiance_w_per_m2 * distance_m * distance_m);
    Light::Point { position_mm, intensity_w_per_sr, radius_mm }
}

/// A camera that sees so many millimetres of height where it looks.
pub fn camera(position_mm: Vec3, look_at_mm: Vec3, height_mm: f32) -> Camera {
    let half = 0.5 * height_mm / position_mm.distance(look_at_mm);
    Camera { position_mm, look_at_mm, up: Vec3::Y, vertical_fov_rad: 2.0 * half.atan(), exposure_ev: 0.0 }
}

/// Bodies in the light of one lamp, before black.
pub fn scene(objects: Vec<Object>, light: Light, camera: Camera) -> Scene {
    Scene {
        objects,
        lights: vec![light],
        environment: None,
        camera,
        background: Some(Vec3::ZERO),
        warnings: Vec::new(),
    }
}

fn body(name: &str, mesh: Mesh) -> Object {
    Object::new(name, mesh, skin())
}

/// A block of 60 mm in light from straight above, that a black screen 20 mm higher stops on the side of -x. The eye looks
/// below the screen from the lit side; 20 mm of the block are seen.
pub fn shadow_edge() -> Scene {
    let block = body("block", cuboid(Vec3::new(0.0, -10.0, 0.0), Vec3::new(30.0, 10.0, 30.0)));
    // An albedo of 0 swallows what comes in.
    let black = Material { albedo: ColourMap { factor: Vec3::ZERO, texture: None }, ..skin() };
    let screen = cuboid(Vec3::new(-50.0, 21.0, 0.0), Vec3::new(50.0, 1.0, 60.0));
    let light = Light::Directional {
        dir_to_light: Vec3::Y,
        irradiance_w_per_m2: Vec3::splat(3.0),
        // The half shadow is 0.08 mm wide.
        angular_radius_rad: 0.002,
    };
    let eye = camera(Vec3::new(180.0, 200.0, 0.0), Vec3::ZERO, 20.0);
    scene(vec![block, Object::new("screen", screen, black)], light, Camera { up: Vec3::Z, ..eye })
}

/// A ball of 20 mm in light from the side and a little from behind.
pub fn sphere() -> Scene {
    let ball = body("ball", capsule(Vec3::ZERO, 10.0, 0.0, SEGMENTS));
    let light = lamp(Vec3::new(200.0, 60.0, -20.0), 20.0, Vec3::ZERO, 3.0);
    scene(vec![ball], light, camera(Vec3::new(0.0, 0.0, 200.0), Vec3::ZERO, 23.0))
}

/// A plate of 40 × 40 × 2 mm with a lamp behind it, out of the picture.
pub fn thin_slab() -> Scene {
    let plate = body("plate", cuboid(Vec3::ZERO, Vec3::new(20.0, 20.0, 1.0)));
    let light = lamp(Vec3::new(40.0, 90.0, -120.0), 10.0, Vec3::ZERO, 10.0);
    scene(vec![plate], light, camera(Vec3::new(60.0, 0.0, 200.0), Vec3::ZERO, 44.0))
}

/// Two fingers of 16 mm, 1 mm apart; the lamp is behind and to the side, so that one is lit past the other.
pub fn gap() -> Scene {
    let fingers = [-8.5, 8.5].map(|x| body("finger", capsule(Vec3::new(x, 0.0, 0.0), 8.0, 14.0, SEGMENTS)));
    let light = lamp(Vec3::new(130.0, 60.0, -90.0), 12.0, Vec3::ZERO, 6.0);
    scene(fingers.to_vec(), light, camera(Vec3::new(0.0, 0.0, 250.0), Vec3::ZERO, 48.0))
}
