//! How far apart texels are on the surface: the metric of the unrolled surface.
//!
//! Symbols: X the surface over texels, mm; E = Xu·Xu, F = Xu·Xv, G = Xv·Xv the metric g; a = sqrt(det g) g^-1 what heat flows
//! by between texels; sqrt(det g) the area of a texel, mm².

use crate::passes::atlas::{Atlas, NO_CHART};
use crate::passes::stretch::derivatives_mm;
use cutis_scene::Object;
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Heat crosses texels narrower than this part of the usual one as if they were that wide: slivers would set the pace for all
/// others. Their areas, and what flows along them, are true.
const SMALLEST: f32 = 0.63;
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
    /// The same where heat flows that much better.
    pub fn conducting(self, factor: f32) -> Self {
        Self { a: self.a * factor, ..self }
    }

    /// From the derivatives along both axes, mm per texel; `texel_mm` is the usual size of a texel.
    pub fn new([xu, xv]: [Vec3; 2], texel_mm: f32) -> Self {
        let (e, f, g) = (xu.length_squared(), xu.dot(xv), xv.length_squared());
        let area_mm2 = (e * g - f * f).max(0.0).sqrt();
        let most = area_mm2 / (SMALLEST * texel_mm).powi(2);
        // Without an area nothing can be said, and nothing flows.
        let per_area = if area_mm2 > 0.0 { area_mm2.recip() } else { 0.0 };
        let (a11, a22) = ((g * per_area).min(most), (e * per_area).min(most));
        let shear = MOST_SHEAR * (a11 * a22).sqrt();
        let metric = Self { a: Vec3::new(a11, (-f * per_area).clamp(-shear, shear), a22), area_mm2 };
        if metric.a.is_finite() && area_mm2.is_finite() { metric } else { Self::default() }
    }
}

/// The metric of every triangle; nothing for those that have no area in the texture.
pub fn metrics(object: &Object, size: usize, texel_mm: f32) -> Vec<Metric> {
    let of = |t: usize| derivatives_mm_per_texel(object, t, size).map(|x| Metric::new(x, texel_mm));
    (0..object.mesh.triangles.len()).into_par_iter().map(|t| of(t).unwrap_or_default()).collect()
}

/// How much better heat flows under a place than by the medium: the factor on its mean free path, squared.
pub fn conductivity(object: &Object, uv: Vec2) -> f32 {
    object.material.mean_free_path_scale_at(uv).powi(2)
}

/// Its mean over the texels of charts.
pub fn usual_conductivity(object: &Object, atlas: &Atlas) -> f32 {
    if object.material.mean_free_path_scale.texture.is_none() {
        return conductivity(object, Vec2::ZERO);
    }
    let of = |i: usize| atlas.uv_under(object, i).map(|uv| (f64::from(conductivity(object, uv)), 1.0));
    let add = |a: (f64, f64), b: (f64, f64)| (a.0 + b.0, a.1 + b.1);
    let (sum, count) = (0..atlas.surface.len()).into_par_iter().filter_map(of).reduce(|| (0.0, 0.0), add);
    if count > 0.0 { (sum / count) as f32 } else { 1.0 }
}

/// The metric under every texel that a chart covers, and how well heat flows there; nothing elsewhere.
pub fn metrics_of_texels(object: &Object, atlas: &Atlas, of_triangles: &[Metric]) -> Vec<Metric> {
    let even = object.material.mean_free_path_scale.texture.is_none();
    let everywhere = conductivity(object, Vec2::ZERO);
    let of = |i: usize| {
        let triangle = atlas.surface[i].triangle;
        if triangle == NO_CHART {
            return Metric::default();
        }
        let factor = if even { None } else { atlas.uv_under(object, i).map(|uv| conductivity(object, uv)) };
        of_triangles[triangle as usize].conducting(factor.unwrap_or(everywhere))
    };
    (0..atlas.surface.len()).into_par_iter().map(of).collect()
}

/// dX/du and dX/dv of a triangle, mm per texel. `None` if it has no area in the texture.
pub fn derivatives_mm_per_texel(object: &Object, triangle: usize, size: usize) -> Option<[Vec3; 2]> {
    let derivatives = derivatives_mm(object, triangle)?.map(|d| d / size as f32);
    derivatives.iter().all(|d| d.is_finite()).then_some(derivatives)
}
