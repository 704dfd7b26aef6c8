//! The material of the built-in head: colour, relief and shine, computed per texel from the position in space.

use super::areas::{AreaFinder, Areas};
use super::noise::{cells, lattice, octaves};
use super::relief::{height_mm, normal_map};
use super::sculpture::Sculpture;
use super::sdf::smoothstep;
use super::texels::{NOBODY, TexelMap};
use crate::{ColourMap, Material, NormalMap, NormalSpace, Object, ScalarMap, Texels, Texture};
use glam::Vec3;
use rayon::prelude::*;
use std::sync::Arc;

/// Linear Rec. 709 colour of plain skin, a light olive tone.
const SKIN: Vec3 = Vec3::new(0.70, 0.47, 0.37);
/// Colour of the lips.
const LIPS: Vec3 = Vec3::new(0.56, 0.255, 0.225);
/// Colour of brows and lashes.
const HAIR: Vec3 = Vec3::new(0.085, 0.05, 0.035);

/// Material with maps of `size`² texels; without maps for size 0.
pub fn material(object: &Object, sculpture: &Sculpture, size: u32) -> Material {
    let plain = Material { name: "built-in skin".to_owned(), ..Material::default() };
    if size == 0 {
        return Material { albedo: ColourMap { factor: SKIN, texture: None }, ..plain };
    }
    let map = TexelMap::new(object, size);
    let positions_mm = map.positions_mm(object);
    let finder = AreaFinder::new(sculpture);
    let texels: Vec<SkinTexel> = (0..map.owner.len())
        .into_par_iter()
        .map(|i| {
            if map.owner[i] == NOBODY {
                SkinTexel::nowhere()
            } else {
                SkinTexel::at(positions_mm[i], &finder)
            }
        })
        .collect();
    let heights_mm: Vec<f32> = texels.iter().map(|t| t.height_mm).collect();
    let shine =
        texture(size, Texels::Linear8(texels.iter().map(|t| [t.shine[0], t.shine[1], 0, 255]).collect()));
    let albedo = texture(size, Texels::Srgb8(texels.iter().map(|t| t.albedo).collect()));
    let normal = Arc::new(normal_map(object, &map, &positions_mm, &heights_mm));
    Material {
        albedo: ColourMap { factor: Vec3::ONE, texture: Some(albedo) },
        normal: Some(NormalMap { texture: normal, space: NormalSpace::Tangent, strength: 1.0 }),
        rho_s: ScalarMap { offset: 0.7, gain: 0.6, texture: Some((shine.clone(), 0)) },
        roughness: ScalarMap { offset: 0.23, gain: 0.09, texture: Some((shine, 1)) },
        ..plain
    }
}

fn texture(size: u32, texels: Texels) -> Arc<Texture> {
    Arc::new(Texture::new(size, size, texels))
}

/// All maps at one texel.
struct SkinTexel {
    albedo: [u8; 4],
    /// Taps of rho_s and roughness.
    shine: [u8; 2],
    height_mm: f32,
}

impl SkinTexel {
    /// Far from every chart: plain skin, so that coarse averages of the maps do not darken.
    fn nowhere() -> Self {
        Self { albedo: srgb8(SKIN), shine: [128; 2], height_mm: 0.0 }
    }

    fn at(p: Vec3, finder: &AreaFinder<'_>) -> Self {
        let areas = finder.at(p);
        let (rho_tap, roughness_tap) = shine(p, &areas);
        let code = |x: f32| (x.clamp(0.0, 1.0) * 255.0).round() as u8;
        Self {
            albedo: srgb8(colour(p, &areas)),
            shine: [code(rho_tap), code(roughness_tap)],
            height_mm: height_mm(p, &areas),
        }
    }
}

/// Linear colour: blood and melanin vary the plain tone, hair covers it.
fn colour(p: Vec3, areas: &Areas) -> Vec3 {
    let blotches = 0.55 * octaves(p / 17.0, 2, 20) + 0.45 * octaves(p / 4.5, 2, 25);
    let blood = 0.22 * areas.flushed - 0.06 * areas.pale + 0.10 * blotches;
    let melanin = 0.05 * octaves(p / 9.0, 3, 30) + 0.16 * freckle(p) * (1.0 - areas.lips) + 0.05 * areas.eye;
    // Absorption per unit of each, strongest in green (blood) and blue (melanin).
    let of_blood = Vec3::new(0.25, 1.25, 0.95) * blood;
    let of_melanin = Vec3::new(0.7, 1.1, 1.5) * melanin;
    // Veins and thin skin under the eyes: less red, hardly less blue.
    let of_eye = Vec3::new(0.12, 0.13, 0.04) * areas.eye;
    let mut c = SKIN * (-(of_blood + of_melanin + of_eye)).exp();
    if areas.lips > 0.0 {
        let lip = LIPS * (1.0 + 0.12 * lattice(Vec3::new(p.x / 1.3, p.y / 6.0, p.z / 2.5), 7));
        c = c.lerp(lip, 0.9 * areas.lips);
    }
    c *= 1.0 - 0.3 * areas.mouth_line;
    c.lerp(HAIR, 0.75 * hair(p, areas))
}

/// Small brown spots: one in three cells has one, of varying size, faint at the rim.
fn freckle(p: Vec3) -> f32 {
    let spot = cells(p / 7.5, 40);
    let radius = 0.17 * (spot.id * 3.0 - 2.0).max(0.0);
    if radius < 0.02 {
        return 0.0; // less than a texel
    }
    smoothstep(radius, 0.4 * radius, spot.nearest + 0.04 * lattice(p / 0.9, 41))
}

/// Share of the texel that is covered by hair of brow or lashes.
fn hair(p: Vec3, areas: &Areas) -> f32 {
    let lashes = 0.95 * areas.lashes;
    if areas.brow == 0.0 {
        return lashes;
    }
    // Strokes lie outwards and up: noise stretched along that direction.
    let (along, across) = (p.x.abs() * 0.86 + p.y * 0.5, p.y * 0.86 - p.x.abs() * 0.5);
    let strokes = lattice(Vec3::new(along / 5.5, across / 0.5, p.x.signum() * 9.0), 50);
    let broken = 0.55 + 0.8 * strokes + 0.25 * lattice(p / 1.8, 51);
    lashes.max(areas.brow.sqrt() * (broken * 0.75 + areas.brow * 0.45).clamp(0.0, 0.95))
}

/// Taps of specular intensity and roughness, 0 to 1.
fn shine(p: Vec3, areas: &Areas) -> (f32, f32) {
    let patches = 0.10 * octaves(p / 11.0, 2, 60) + 0.08 * lattice(p / 1.3, 62);
    let rho = 0.42 + 0.35 * areas.oily + 0.35 * areas.lips - 0.12 * areas.eye + patches - 0.4 * areas.brow;
    let rough =
        0.62 - 0.38 * areas.oily - 0.40 * areas.lips + 0.1 * areas.flushed - patches + 0.3 * areas.brow;
    (rho, rough)
}

fn srgb8(linear: Vec3) -> [u8; 4] {
    let encode = |c: f32| {
        let c = c.clamp(0.0, 1.0);
        let encoded = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
        (encoded * 255.0).round() as u8
    };
    [encode(linear.x), encode(linear.y), encode(linear.z), 255]
}
