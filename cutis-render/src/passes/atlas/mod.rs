//! The surface unrolled: for every texel of an object's texture the triangle under it, and for every coarser level of
//! that texture which chart a texel belongs to and how far it is from that chart's edge.
//!
//! A texel belongs to the triangle that covers its centre. Around every chart two more rings of texels are *padded*:
//! they repeat the nearest point of the chart's edge, so that a bilinear read near the edge finds values of its own
//! surface. A read never mixes charts: it leaves out neighbours that belong to another one.

mod chart_map;
mod texels;
mod triangle;

pub use chart_map::ChartMap;
pub use triangle::{barycentric, inside};

use cutis_scene::{Object, SurfacePoint};
use glam::Vec2;
use rayon::prelude::*;
use std::sync::Arc;
use texels::texels;

/// Marks a texel that no chart covers.
pub const NO_CHART: u32 = u32::MAX;

/// A chart of fewer texels hardly holds light.
const LEAST_CHART_TEXELS: f32 = 1.0;

/// Where a texel lies on the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TexelSurface {
    /// Triangle, or [`NO_CHART`] for an empty texel.
    pub triangle: u32,
    /// Barycentric weight of the triangle's second corner.
    pub b1: f32,
    /// Barycentric weight of the triangle's third corner.
    pub b2: f32,
}

/// The unrolled surface at full size.
#[derive(Debug, Clone)]
pub struct Atlas {
    /// Width and height in texels.
    pub size: usize,
    /// Place of each texel on the mesh.
    pub surface: Vec<TexelSurface>,
    /// Chart of each texel.
    pub charts: Arc<ChartMap>,
}

impl Atlas {
    /// Rasterises the object into its own texture.
    pub fn new(object: &Object, size: usize) -> Self {
        let surface = texels(object, size);
        let chart = surface.par_iter().map(|s| chart_of(object, s)).collect();
        Self { size, surface, charts: Arc::new(ChartMap::new(size, chart)) }
    }

    /// The surface under a texel, if a chart covers it.
    pub fn surface_point(&self, object: &Object, texel: usize) -> Option<SurfacePoint> {
        let s = self.surface[texel];
        (s.triangle != NO_CHART).then(|| object.surface_point(s.triangle, s.b1, s.b2))
    }

    /// Place of that surface in the material's maps.
    pub fn map_uv_under(&self, object: &Object, texel: usize) -> Option<Vec2> {
        let s = self.surface[texel];
        (s.triangle != NO_CHART).then(|| object.map_uv_at(s.triangle, s.b1, s.b2))
    }

    /// Place of that surface in the maps of light: the texel's middle, but where it pads a chart.
    pub fn atlas_uv_under(&self, object: &Object, texel: usize) -> Option<Vec2> {
        let s = self.surface[texel];
        (s.triangle != NO_CHART).then(|| object.atlas_uv_at(s.triangle, s.b1, s.b2))
    }

    /// The surface under a texel of a smaller map that belongs to `chart`: `times` as wide as one of these. Of the texels
    /// of that chart the most central one stands for all.
    pub fn point_under(
        &self,
        object: &Object,
        chart: u32,
        [x, y]: [usize; 2],
        times: usize,
    ) -> Option<SurfacePoint> {
        if chart == NO_CHART {
            return None;
        }
        let off_centre = |i: usize| (2 * i + 1).abs_diff(times);
        let own = (0..times * times)
            .map(|i| [i % times, i / times])
            .filter(|[dx, dy]| self.charts.chart[(times * y + dy) * self.size + times * x + dx] == chart);
        let [dx, dy] = own.min_by_key(|[dx, dy]| off_centre(*dx) + off_centre(*dy))?;
        self.surface_point(object, (times * y + dy) * self.size + times * x + dx)
    }
}

/// For every chart of an object whether it is large enough to hold light on a map of that size.
pub fn charts_that_hold_light(object: &Object, size: usize) -> Vec<bool> {
    let of_triangle = &object.charts.of_triangle;
    let mut texels = vec![0.0f32; of_triangle.iter().max().map_or(0, |&last| last as usize + 1)];
    for (triangle, &chart) in of_triangle.iter().enumerate() {
        let [a, b, c] = object.mesh.corner_atlas_uvs(triangle).map(|uv| uv * size as f32);
        texels[chart as usize] += 0.5 * (b - a).perp_dot(c - a).abs();
    }
    texels.into_iter().map(|texels| texels >= LEAST_CHART_TEXELS).collect()
}

fn chart_of(object: &Object, surface: &TexelSurface) -> u32 {
    if surface.triangle == NO_CHART { NO_CHART } else { object.charts.of_triangle[surface.triangle as usize] }
}
