//! A photographer's studio made by code: what lights a scene that brings no light of its own.
//!
//! Everything is placed by the box around the scene, which is taken for a head that looks towards +Z: a key light in
//! front, to the left and above; a rim light behind, on the other side and at the height of the ears, so that it
//! shines through one; a soft room around both.

use crate::head::{HeadDetail, built_in};
use crate::{Camera, Environment, Light, Scene, Texels, Texture, TextureSource};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// Size of the environment map in texels.
const MAP_SIZE: [u32; 2] = [256, 128];

/// Irradiance of the key light at the middle of the scene, W/m².
const KEY_W_PER_M2: f32 = 3.0;

/// Irradiance of the rim light at the middle of the scene, W/m².
const RIM_W_PER_M2: f32 = 6.0;

/// Radiance of the backdrop, W/(m² sr): dark, so that light through an ear shows.
pub const STUDIO_BACKGROUND: Vec3 = Vec3::new(0.012, 0.013, 0.016);

/// A soft rectangle of light on the studio's walls.
struct Panel {
    /// Unit direction of its middle.
    dir: Vec3,
    /// Half its extent to the side and upwards, rad.
    half_size_rad: Vec2,
    /// Width over which its edge fades, rad.
    edge_rad: f32,
    /// Radiance, W/(m² sr).
    radiance: Vec3,
}

/// The built-in head in the studio, seen from the front before nothing.
pub fn head_in_the_studio(detail: HeadDetail) -> Scene {
    let object = built_in(detail);
    let bounds_mm = object.mesh.bounds_mm().unwrap_or_default();
    Scene {
        objects: vec![object],
        lights: studio_lights(bounds_mm),
        environment: Some(studio_environment()),
        camera: Camera::framing(bounds_mm, Vec3::Z, 0.4),
        background: None,
        warnings: Vec::new(),
    }
}

/// A soft room: a key box front left, a fill box right, a strip overhead, walls that darken towards the floor.
/// A surface that faces the camera receives about 1.2 W/m².
pub fn studio_environment() -> Environment {
    let [width, height] = MAP_SIZE;
    let blank = Arc::new(Texture::new(1, 1, Texels::LinearF32(vec![[0.0; 4]])));
    let environment =
        Environment { map: blank, rotation_rad: 0.0, radiance_scale: Vec3::ONE, visible: false };
    let panels = panels();
    let texel = |i: u32| {
        let (x, y) = (i % width, i / width);
        let uv = Vec2::new((x as f32 + 0.5) / width as f32, (y as f32 + 0.5) / height as f32);
        room_radiance(environment.dir(uv), &panels).extend(1.0).to_array()
    };
    let texels = (0..width * height).map(texel).collect();
    let map = Texture::new(width, height, Texels::LinearF32(texels)).with_source(TextureSource::Studio);
    Environment { map: Arc::new(map), ..environment }
}

/// Key and rim light for a scene inside a box.
pub fn studio_lights(bounds_mm: [Vec3; 2]) -> Vec<Light> {
    let centre = 0.5 * (bounds_mm[0] + bounds_mm[1]);
    // 50 mm: lights stay outside of something tiny, where the inverse square would blow up.
    let radius_mm = (0.5 * (bounds_mm[1] - bounds_mm[0]).length()).max(50.0);
    let height_mm = bounds_mm[1].y - bounds_mm[0].y;
    // Ears sit a little above the middle of a box that reaches down to the neck or the shoulders.
    let ears = centre + Vec3::Y * (0.12 * height_mm);
    let key_dir = Vec3::new(-0.55, 0.5, 0.75).normalize();
    let rim_dir = Vec3::new(0.42, 0.1, -0.9).normalize();
    vec![
        lamp(centre, key_dir, 4.0 * radius_mm, KEY_W_PER_M2, Vec3::new(1.0, 0.96, 0.9), 25.0),
        lamp(ears, rim_dir, 3.0 * radius_mm, RIM_W_PER_M2, Vec3::new(1.0, 0.98, 0.95), 15.0),
    ]
}

/// A point light at `distance_mm` from `target_mm` that gives it an irradiance.
fn lamp(
    target_mm: Vec3,
    dir: Vec3,
    distance_mm: f32,
    irradiance_w_per_m2: f32,
    colour: Vec3,
    radius_mm: f32,
) -> Light {
    let distance_m = distance_mm * 1e-3;
    Light::Point {
        position_mm: target_mm + dir * distance_mm,
        intensity_w_per_sr: colour * (irradiance_w_per_m2 * distance_m * distance_m),
        // A lamp never reaches the scene itself.
        radius_mm: radius_mm.min(0.1 * distance_mm),
    }
}

fn panels() -> [Panel; 3] {
    [
        Panel {
            dir: Vec3::new(-0.6, 0.45, 0.65).normalize(),
            half_size_rad: Vec2::new(0.45, 0.5),
            edge_rad: 0.25,
            radiance: Vec3::new(2.6, 2.5, 2.35),
        },
        Panel {
            dir: Vec3::new(0.85, 0.1, 0.5).normalize(),
            half_size_rad: Vec2::new(0.5, 0.7),
            edge_rad: 0.4,
            radiance: Vec3::new(0.5, 0.54, 0.6),
        },
        Panel {
            dir: Vec3::new(0.0, 0.95, -0.3).normalize(),
            half_size_rad: Vec2::new(0.8, 0.25),
            edge_rad: 0.2,
            radiance: Vec3::splat(0.8),
        },
    ]
}

/// Walls from dim floor to brighter ceiling, and the panels before them.
fn room_radiance(dir: Vec3, panels: &[Panel]) -> Vec3 {
    let height = smooth(-0.6, 0.8, dir.y);
    let walls = Vec3::new(0.06, 0.055, 0.05).lerp(Vec3::new(0.2, 0.205, 0.215), height);
    panels.iter().fold(walls, |sum, panel| sum + panel.radiance * coverage(panel, dir))
}

/// 1 inside the panel, falling to 0 over its edge.
fn coverage(panel: &Panel, dir: Vec3) -> f32 {
    let right = Vec3::Y.cross(panel.dir).normalize_or(Vec3::X);
    let up = panel.dir.cross(right);
    let forward = dir.dot(panel.dir);
    let angles = Vec2::new(dir.dot(right).atan2(forward), dir.dot(up).atan2(forward)).abs();
    let inside = |angle: f32, half: f32| 1.0 - smooth(half - panel.edge_rad, half, angle);
    inside(angles.x, panel.half_size_rad.x) * inside(angles.y, panel.half_size_rad.y)
}

/// Smooth step from 0 at `from` to 1 at `to`.
fn smooth(from: f32, to: f32, x: f32) -> f32 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::PI;

    /// Irradiance of the room on a surface facing `normal`, by the sum over all texels.
    fn irradiance(environment: &Environment, normal: Vec3) -> f32 {
        let [width, height] = MAP_SIZE;
        let (du, dv) = (1.0 / width as f32, 1.0 / height as f32);
        let mut sum = 0.0;
        for i in 0..width * height {
            let uv = Vec2::new(((i % width) as f32 + 0.5) * du, ((i / width) as f32 + 0.5) * dv);
            let dir = environment.dir(uv);
            let solid_angle_sr = 2.0 * PI * du * PI * dv * (uv.y * PI).sin();
            sum += environment.radiance(dir).y * dir.dot(normal).max(0.0) * solid_angle_sr;
        }
        sum
    }

    #[test]
    fn the_room_is_soft_and_brighter_in_front_than_below() {
        let environment = studio_environment();
        let (front, below) = (irradiance(&environment, Vec3::Z), irradiance(&environment, Vec3::NEG_Y));
        assert!((1.0..2.5).contains(&front), "{front} W/m²");
        assert!(below < 0.5 * front, "{below} of {front} W/m²");
    }

    #[test]
    fn lights_give_the_stated_irradiance_whatever_the_size() {
        for size_mm in [100.0, 430.0, 2000.0] {
            let bounds = [Vec3::splat(-0.5 * size_mm), Vec3::splat(0.5 * size_mm)];
            let lights = studio_lights(bounds);
            let key = lights[0].sample(Vec3::ZERO).irradiance_w_per_m2.x;
            let rim = lights[1].sample(Vec3::Y * (0.12 * size_mm)).irradiance_w_per_m2.x;
            assert!((key - KEY_W_PER_M2).abs() < 1e-4 && (rim - RIM_W_PER_M2).abs() < 1e-4, "{key} {rim}");
        }
    }

    #[test]
    fn the_key_is_in_front_left_and_the_rim_behind_right() {
        let lights = studio_lights([Vec3::splat(-100.0), Vec3::splat(100.0)]);
        let dirs = [0, 1].map(|i| lights[i].sample(Vec3::ZERO).dir_to_light);
        assert!(dirs[0].x < 0.0 && dirs[0].y > 0.0 && dirs[0].z > 0.0, "{}", dirs[0]);
        assert!(dirs[1].x > 0.0 && dirs[1].z < 0.0, "{}", dirs[1]);
    }
}
