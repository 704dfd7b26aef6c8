//! Relief finer than the mesh: pores, the net of fine furrows between them, creases of the lips; as a height over
//! the surface, and the normal map that follows from it.
//!
//! Depths are of the order of measured skin roughness (tens of micrometres; forehead and cheek replicas give
//! 0.02–0.1 mm; remembered, not looked up). Furrows narrower than a texel are drawn wider and shallower.

use super::areas::Areas;
use super::noise::{cells, lattice};
use super::texels::TexelMap;
use crate::{Object, Texels, Texture};
use glam::Vec3;
use rayon::prelude::*;

/// Mean distance of two pores, mm.
const PORE_SPACING_MM: f32 = 1.05;
/// Steeper slopes than this would be artefacts of a seam.
const STEEPEST: f32 = 0.7;

/// Height of the relief, mm.
pub fn height_mm(p: Vec3, areas: &Areas) -> f32 {
    let bent = p + 0.25 * Vec3::new(lattice(p / 1.7, 1), lattice(p / 1.7, 2), lattice(p / 1.7, 3));
    let pores = cells(bent / PORE_SPACING_MM, 4);
    let furrow = (-((pores.second - pores.nearest) / 0.22).powi(2)).exp();
    // Not every place has a pore that can be seen.
    let pit = (-(pores.nearest / 0.3).powi(2)).exp() * (pores.id * 1.6 - 0.6).max(0.0);
    let coarse = cells(bent / (2.3 * PORE_SPACING_MM), 5);
    let wide_furrow = (-((coarse.second - coarse.nearest) / 0.13).powi(2)).exp();
    let skin = -0.026 * furrow - (0.02 + 0.08 * areas.porous) * pit - 0.030 * wide_furrow
        + 0.04 * lattice(p / 3.1, 6);
    if areas.lips == 0.0 {
        return skin;
    }
    skin * (1.0 - 0.8 * areas.lips) - areas.lips * lip_creases_mm(p)
}

/// Upright creases, about a millimetre apart.
fn lip_creases_mm(p: Vec3) -> f32 {
    let q = Vec3::new(p.x / 1.25, p.y / 7.0, p.z / 2.5);
    let crease = 1.0 - lattice(q, 7).abs() * 2.5;
    0.07 * crease.max(0.0) + 0.03 * lattice(q * 2.1, 8)
}

/// The normal map of a relief given per texel (mm), in the tangent frame of the mesh.
pub fn normal_map(object: &Object, map: &TexelMap, positions_mm: &[Vec3], heights_mm: &[f32]) -> Texture {
    let texel = |i: usize| {
        let Some((t, b1, b2)) = map.place(object, i) else { return [128, 128, 255, 255] };
        let point = object.surface_point(t, b1, b2);
        let g = gradient(map.size as usize, positions_mm, heights_mm, i, point.normal);
        let tangent = point.tangent.truncate();
        let bitangent = point.normal.cross(tangent) * point.tangent.w;
        let bent = Vec3::new(-g.dot(tangent), -g.dot(bitangent), 1.0).normalize();
        let code = |x: f32| ((0.5 + 0.5 * x) * 255.0).round() as u8;
        [code(bent.x), code(bent.y), code(bent.z), 255]
    };
    let texels = (0..map.owner.len()).into_par_iter().map(texel).collect();
    Texture::new(map.size, map.size, Texels::Linear8(texels))
}

/// Slope of the relief along the surface, mm per mm.
fn gradient(size: usize, positions_mm: &[Vec3], heights_mm: &[f32], i: usize, normal: Vec3) -> Vec3 {
    let (x, y) = (i % size, i / size);
    let difference = |back: Option<usize>, ahead: Option<usize>| {
        let known = |j: Option<usize>| j.filter(|&j| !positions_mm[j].is_nan()).unwrap_or(i);
        let (b, a) = (known(back), known(ahead));
        (positions_mm[a] - positions_mm[b], heights_mm[a] - heights_mm[b])
    };
    let (along_u, rise_u) = difference((x > 0).then(|| i - 1), (x + 1 < size).then(|| i + 1));
    let (along_v, rise_v) = difference((y > 0).then(|| i - size), (y + 1 < size).then(|| i + size));
    let area = normal.dot(along_u.cross(along_v));
    if area.abs() < 1e-9 {
        return Vec3::ZERO; // a texel alone: no neighbour to rise to
    }
    let g = (along_v.cross(normal) * rise_u + normal.cross(along_u) * rise_v) / area;
    g.clamp_length_max(STEEPEST)
}
