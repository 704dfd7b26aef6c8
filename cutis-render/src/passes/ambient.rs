//! How open a point is to its surroundings: ambient occlusion and the mean unoccluded direction, by rays.
//!
//! Kept in a texture a quarter as wide as the irradiance: occlusion varies slowly, and the smoothing over 4 × 4 texels
//! that gathers the rays of all of them would blur it anyway.

use crate::passes::atlas::{Atlas, ChartMap};
use crate::passes::smooth::smoothed;
use crate::progress::Progress;
use crate::sampling::{cosine_hemisphere, r2_point, random2};
use cutis_scene::{Bvh, Object, SurfacePoint};
use glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;

/// Stream of random numbers this pass draws from.
const STREAM: u32 = 0xA0;
/// Weights of a square of 4 × 4 texels around a texel: those on its edge count half.
const FOUR_BY_FOUR: [f32; 3] = [1.0, 1.0, 0.5];

/// Openness of the surface.
pub struct Ambient {
    charts: ChartMap,
    /// Bent normal (mean unoccluded direction) in xyz, unoccluded fraction of the cosine-weighted hemisphere in w.
    map: Vec<Vec4>,
}

impl Ambient {
    /// Casts `samples` rays from every texel of `charts`, the atlas at a quarter of its size.
    pub fn new(
        object: &Object,
        atlas: &Atlas,
        charts: ChartMap,
        bvh: &Bvh,
        samples: u32,
        seed: u64,
        progress: &dyn Progress,
    ) -> Self {
        progress.begin("ambient occlusion", charts.size as u64);
        let mut raw = vec![Vec4::ZERO; charts.chart.len()];
        let shift = random2(0, 0, STREAM, seed);
        raw.par_chunks_mut(charts.size).enumerate().for_each(|(y, row)| {
            for (x, texel) in row.iter_mut().enumerate() {
                let chart = charts.chart[y * charts.size + x];
                if let Some(point) = atlas.point_under(object, chart, [x, y], 4) {
                    *texel = openness(bvh, &point, samples, first_point(x, y, samples), shift);
                }
            }
            progress.advance(1);
        });
        let map = smoothed(&charts, &raw, FOUR_BY_FOUR, 1);
        Self { charts, map }
    }

    /// Open to all sides everywhere: what nobody asks for need not be found out.
    pub fn open(charts: ChartMap) -> Self {
        let map = vec![Vec4::W; charts.chart.len()];
        Self { charts, map }
    }

    /// Charts of the map, a quarter as wide as the atlas.
    pub fn charts(&self) -> &ChartMap {
        &self.charts
    }

    /// Bent normal in xyz, unoccluded fraction of the hemisphere in w, texel by texel.
    pub fn map(&self) -> &[Vec4] {
        &self.map
    }

    /// Bent normal and openness at `uv`; open to all sides where the chart has no texel. Relief turns the bent normal as it
    /// turns the smooth one.
    pub fn at(&self, uv: Vec2, chart: u32, smooth_normal: Vec3, normal: Vec3) -> (Vec3, f32) {
        match self.charts.sample(&self.map, uv, chart) {
            Some(value) => {
                let bent = value.truncate().normalize_or(smooth_normal);
                ((normal + bent - smooth_normal).normalize_or(normal), value.w)
            }
            None => (normal, 1.0),
        }
    }
}

/// The texels of every square of 4 × 4 share one sequence of points, so that the smoothing, which takes in just as many,
/// has them all (interleaved sampling, Keller & Heidrich 2001).
fn first_point(x: usize, y: usize, samples: u32) -> u32 {
    (4 * (y % 4) + x % 4) as u32 * samples
}

fn openness(bvh: &Bvh, point: &SurfacePoint, samples: u32, first: u32, shift: Vec2) -> Vec4 {
    if samples == 0 {
        return Vec4::W; // nobody asked: open to all sides
    }
    let origin = bvh.step_off(point.lifted_position_mm, point.flat_normal);
    let (mut open, mut all) = (Vec4::ZERO, Vec3::ZERO);
    for i in first..first + samples {
        let dir = cosine_hemisphere(r2_point(i, shift), point.normal);
        all += dir;
        if !bvh.occluded(origin, dir, f32::INFINITY) {
            open += dir.extend(1.0);
        }
    }
    let share = open / samples as f32;
    // What these few rays miss of the mean of all over an open surface, two thirds of the normal, they miss here, too.
    let missed = point.normal * (2.0 / 3.0) - all / samples as f32;
    share + (missed * share.w).extend(0.0)
}
