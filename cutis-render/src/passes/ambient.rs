//! How open a point is to its surroundings: ambient occlusion and the mean unoccluded direction, by rays.
//!
//! Kept in a texture a quarter as wide as the irradiance: occlusion varies slowly, and the smoothing over 5 × 5 texels
//! that removes the noise of few rays would blur it anyway.

use crate::passes::atlas::{Atlas, ChartMap, NO_CHART};
use crate::progress::Progress;
use crate::sampling::{cosine_hemisphere, r2_point, random2};
use cutis_scene::{Bvh, Object};
use glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;

/// Stream of random numbers this pass draws from.
const STREAM: u32 = 0xA0;
/// Texels on either side that the smoothing takes in.
const SMOOTHING: usize = 2;

/// Openness of the surface.
pub struct Ambient {
    charts: ChartMap,
    /// Bent normal (mean unoccluded direction) in xyz, unoccluded fraction of the cosine-weighted hemisphere in w.
    map: Vec<Vec4>,
}

impl Ambient {
    /// Casts `samples` rays from every texel of the quarter-size map.
    pub fn new(
        object: &Object,
        atlas: &Atlas,
        bvh: &Bvh,
        samples: u32,
        seed: u64,
        progress: &dyn Progress,
    ) -> Self {
        let half = atlas.charts.halved();
        let charts = half.halved();
        progress.begin("ambient occlusion", charts.size as u64);
        let mut raw = vec![Vec4::ZERO; charts.chart.len()];
        raw.par_chunks_mut(charts.size).enumerate().for_each(|(y, row)| {
            for (x, texel) in row.iter_mut().enumerate() {
                let chart = charts.chart[y * charts.size + x];
                if let Some(fine) = representative(atlas, chart, x, y) {
                    let shift = random2(x as u32, y as u32, STREAM, seed);
                    *texel = openness(object, atlas, bvh, fine, samples, shift);
                }
            }
            progress.advance(1);
        });
        let map = smoothed(&charts, &raw);
        Self { charts, map }
    }

    /// Bent normal and openness at `uv`; open to all sides where the chart has no texel.
    pub fn at(&self, uv: Vec2, chart: u32, normal: Vec3) -> (Vec3, f32) {
        match self.charts.sample(&self.map, uv, chart) {
            Some(value) => (value.truncate().normalize_or(normal), value.w),
            None => (normal, 1.0),
        }
    }
}

/// A full-size texel of the chart under a quarter-size one, the most central first.
fn representative(atlas: &Atlas, chart: u32, x: usize, y: usize) -> Option<usize> {
    if chart == NO_CHART {
        return None;
    }
    let rows = [1, 2, 0, 3];
    let texels = rows.iter().flat_map(|dy| rows.iter().map(move |dx| (4 * y + dy) * atlas.size + 4 * x + dx));
    texels.into_iter().find(|&texel| atlas.charts.chart[texel] == chart)
}

fn openness(object: &Object, atlas: &Atlas, bvh: &Bvh, texel: usize, samples: u32, shift: Vec2) -> Vec4 {
    let Some(point) = atlas.surface_point(object, texel) else { return Vec4::ZERO };
    if samples == 0 {
        return Vec4::W; // nobody asked: open to all sides
    }
    let origin = bvh.step_off(point.lifted_position_mm, point.flat_normal);
    let mut open = Vec4::ZERO;
    for i in 0..samples {
        let dir = cosine_hemisphere(r2_point(i, shift), point.normal);
        if !bvh.occluded(origin, dir, f32::INFINITY) {
            open += dir.extend(1.0);
        }
    }
    open / samples as f32
}

/// Mean over the neighbours of the same chart.
fn smoothed(charts: &ChartMap, map: &[Vec4]) -> Vec<Vec4> {
    let size = charts.size;
    let mean = |i: usize| {
        let chart = charts.chart[i];
        if chart == NO_CHART {
            return Vec4::ZERO;
        }
        let span = |c: usize| c.saturating_sub(SMOOTHING)..(c + SMOOTHING + 1).min(size);
        let neighbours = span(i / size).flat_map(|y| span(i % size).map(move |x| y * size + x));
        let own = neighbours.filter(|&n| charts.chart[n] == chart);
        let (sum, count) = own.fold((Vec4::ZERO, 0.0), |(sum, count), n| (sum + map[n], count + 1.0));
        sum / count
    };
    (0..size * size).into_par_iter().map(mean).collect()
}
