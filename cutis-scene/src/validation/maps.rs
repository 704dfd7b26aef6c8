//! A body with maps of everything, told in two ways that must give one picture.

use super::bodies::{camera, lamp, scene, skin};
use super::shapes::capsule;
use crate::studio::studio_environment;
use crate::{
    ColourMap, Material, NormalMap, NormalSpace, Object, ScalarMap, Scattering, Scene, SecondMedium, Texels,
    Texture,
};
use glam::{Vec2Swizzles, Vec3};
use std::sync::Arc;

/// Width and height of the maps, texels.
const SIZE: u32 = 24;
/// How often the maps lie along each side of the atlas.
const TIMES: u32 = 3;

/// The body with maps that repeat, so that its texture coordinates leave the unit square, and light in an atlas of its own, where all
/// lies mirrored across the diagonal; and with the same maps written out, on the coordinates of that atlas.
pub fn repeated_and_written_out() -> [Scene; 2] {
    let mut mesh = capsule(Vec3::ZERO, 2.0, 9.0, 48);
    mesh.atlas_uvs = Some(mesh.uvs.iter().map(|uv| uv.yx()).collect());
    mesh.uvs.iter_mut().for_each(|uv| *uv *= TIMES as f32);
    let repeated = Object::new("capsule", mesh, mapped(false));
    // With the same tangents, so that the normal map means the same.
    let mut mesh = repeated.mesh.clone();
    mesh.uvs = mesh.atlas_uvs.take().unwrap_or_default();
    let written_out = Object::new("capsule", mesh, mapped(true));
    [repeated, written_out].map(|object| {
        let light = lamp(Vec3::new(60.0, 60.0, -120.0), 10.0, Vec3::ZERO, 20.0);
        let lit = scene(vec![object], light, camera(Vec3::new(0.0, 20.0, 200.0), Vec3::ZERO, 24.0));
        let second = lamp(Vec3::new(-90.0, -40.0, 90.0), 5.0, Vec3::ZERO, 3.0);
        let lights = [lit.lights, vec![second]].concat();
        Scene { lights, environment: Some(studio_environment()), ..lit }
    })
}

/// Skin that a map changes in every way a map can.
fn mapped(is_written_out: bool) -> Material {
    let spots = |number| Some(spots(number, is_written_out));
    let scalar = |number, offset, gain| ScalarMap { offset, gain, texture: spots(number).map(|t| (t, 0)) };
    let colour = |number| ColourMap { factor: Vec3::ONE, texture: spots(number) };
    Material {
        albedo: colour(1),
        normal: spots(2).map(|texture| NormalMap { texture, space: NormalSpace::Tangent, strength: 0.5 }),
        rho_s: scalar(3, 0.2, 1.0),
        roughness: scalar(4, 0.2, 0.3),
        mean_free_path_scale: scalar(5, 0.6, 0.8),
        under: vec![colour(6)],
        mixed_with: Some(SecondMedium {
            scattering: Scattering::Preset("marble".to_owned()),
            share: scalar(7, 0.0, 1.0),
        }),
        ..skin()
    }
}

/// Spots of colours without order, the same for the same number; written out [`TIMES`] times along each side and mirrored, or not.
fn spots(number: u32, is_written_out: bool) -> Arc<Texture> {
    let size = if is_written_out { SIZE * TIMES } else { SIZE };
    let texel = |i: u32| {
        let (x, y) = if is_written_out { (i / size, i % size) } else { (i % size, i / size) };
        let place = x % SIZE + SIZE * (y % SIZE);
        let bits = (place + 1).wrapping_mul(number.wrapping_mul(0x9e37_79b1) ^ 0x85eb_ca6b);
        let mixed = (bits ^ bits >> 15).wrapping_mul(0x2c1b_3c6d);
        // Blue stays high: as a normal it points outwards.
        [(mixed >> 24) as u8, (mixed >> 16) as u8, 160 + (mixed >> 9) as u8 / 4, 255]
    };
    Arc::new(Texture::new(size, size, Texels::Linear8((0..size * size).map(texel).collect())))
}
