//! Smoothing of a small map over the neighbours of the same chart.

use crate::passes::atlas::{ChartMap, NO_CHART};
use glam::Vec4;
use rayon::prelude::*;

/// Texels on either side that are taken in.
const SIDE: usize = 2;

/// Mean over 5 × 5 texels. `weights` are those of the texel itself and of its neighbours at one and two texels along
/// each axis.
pub fn smoothed(charts: &ChartMap, map: &[Vec4], weights: [f32; SIDE + 1]) -> Vec<Vec4> {
    let size = charts.size;
    let span = |c: usize| c.saturating_sub(SIDE)..(c + SIDE + 1).min(size);
    let mean = |i: usize| {
        let chart = charts.chart[i];
        if chart == NO_CHART {
            return Vec4::ZERO;
        }
        let (x, y) = (i % size, i / size);
        let (mut sum, mut whole) = (Vec4::ZERO, 0.0);
        for ny in span(y) {
            for nx in span(x) {
                if charts.chart[ny * size + nx] == chart {
                    let weight = weights[ny.abs_diff(y)] * weights[nx.abs_diff(x)];
                    sum += map[ny * size + nx] * weight;
                    whole += weight;
                }
            }
        }
        sum / whole
    };
    (0..size * size).into_par_iter().map(mean).collect()
}
