//! How far apart texels are on the surface: the metric of the unrolled surface.
//!
//! Symbols: X the surface over texels, mm; E = Xu·Xu, F = Xu·Xv, G = Xv·Xv the metric g; a = sqrt(det g) g^-1 what heat flows
//! by between texels; sqrt(det g) the area of a texel, mm².

use crate::passes::atlas::{Atlas, NO_CHART, TexelSurface};
use crate::passes::stretch::derivatives_mm;
use cutis_scene::Object;
use glam::Vec3;
use rayon::prelude::*;

/// Texels smaller than this part of the usual one are taken for that large: slivers would set the pace for all others.
const SMALLEST: f32 = 0.6;
/// Largest cosine between the axes that is believed.
const MOST_SHEAR: f32 = 0.9;

/// The metric under one texel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Metric {
    /// a11, a12 and a22, no unit.
    pub a: Vec3,
    /// Area of the texel, mm².
    pub area_mm2: f32,
}

impl Metric {
    /// From the derivatives along both axes, mm per texel; `texel_mm` is the usual size of a texel.
    pub fn new([xu, xv]: [Vec3; 2], texel_mm: f32) -> Self {
        let least = (SMALLEST * texel_mm).powi(2);
        let (e, g) = (xu.length_squared().max(least), xv.length_squared().max(least));
        let most = MOST_SHEAR * (e * g).sqrt();
        let f = xu.dot(xv).clamp(-most, most);
        let area_mm2 = (e * g - f * f).sqrt();
        Self { a: Vec3::new(g, -f, e) / area_mm2, area_mm2 }
    }
}

/// The metric under every texel that a chart covers; nothing elsewhere.
pub fn metrics(object: &Object, atlas: &Atlas, texel_mm: f32) -> Vec<Metric> {
    let of_triangle: Vec<Option<[Vec3; 2]>> =
        (0..object.mesh.triangles.len()).map(|t| derivatives_mm_per_texel(object, t, atlas.size)).collect();
    let of = |surface: &TexelSurface| {
        if surface.triangle == NO_CHART {
            return Metric::default();
        }
        let flat = [Vec3::X * texel_mm, Vec3::Y * texel_mm];
        Metric::new(of_triangle[surface.triangle as usize].unwrap_or(flat), texel_mm)
    };
    atlas.surface.par_iter().map(of).collect()
}

/// dX/du and dX/dv of a triangle, mm per texel. `None` if it has no area in the texture.
pub fn derivatives_mm_per_texel(object: &Object, triangle: usize, size: usize) -> Option<[Vec3; 2]> {
    let per_texel = derivatives_mm(object, triangle)?.map(|d| d / size as f32);
    per_texel.iter().all(|d| d.is_finite()).then_some(per_texel)
}
