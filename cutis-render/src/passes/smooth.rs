//! Smoothing of a small map over the neighbours of the same chart.

use crate::passes::atlas::{ChartMap, NO_CHART};
use glam::Vec4;
use rayon::prelude::*;

/// Texels on either side that are taken in.
const SIDE: usize = 2;

/// Mean over 5 × 5 texels, `step` texels apart. `weights` are those of the texel itself and of its neighbours at one and
/// two steps along each axis.
pub fn smoothed(charts: &ChartMap, map: &[Vec4], weights: [f32; SIDE + 1], step: usize) -> Vec<Vec4> {
    let size = charts.size;
    // Steps from -2 to 2 that stay within the map.
    let span = |c: usize| {
        (0..=2 * SIDE).filter_map(move |i| {
            let place = (c + i * step).checked_sub(SIDE * step)?;
            (place < size).then_some((place, weights[i.abs_diff(SIDE)]))
        })
    };
    let mean = |i: usize| {
        let chart = charts.chart[i];
        if chart == NO_CHART {
            return Vec4::ZERO;
        }
        let (mut sum, mut whole) = (Vec4::ZERO, 0.0);
        for (y, weight_y) in span(i / size) {
            for (x, weight_x) in span(i % size) {
                if charts.chart[y * size + x] == chart {
                    sum += map[y * size + x] * (weight_x * weight_y);
                    whole += weight_x * weight_y;
                }
            }
        }
        sum / whole
    };
    (0..size * size).into_par_iter().map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const BINOMIAL: [f32; 3] = [6.0, 4.0, 1.0];

    #[test]
    fn a_lit_texel_spreads_by_the_weights_and_never_into_another_chart() {
        // Two charts side by side; the lit texel is the last of the left one.
        let size = 16;
        let charts = ChartMap::new(size, (0..size * size).map(|i| u32::from(i % size >= 8)).collect());
        let mut map = vec![Vec4::ZERO; size * size];
        map[8 * size + 4] = Vec4::ONE;
        let smooth = smoothed(&charts, &map, BINOMIAL, 1);
        assert!((smooth[8 * size + 4].x - 36.0 / 256.0).abs() < 1e-6);
        assert!((smooth[9 * size + 6].x - 4.0 / (16.0 * 15.0)).abs() < 1e-6, "a column is missing there");
        assert!((0..size * size).filter(|i| i % size >= 8).all(|i| smooth[i].x == 0.0));
    }

    #[test]
    fn constants_stay_whatever_the_step() {
        let charts = ChartMap::new(16, (0..256).map(|i| i % 16 / 5).collect());
        for step in [1, 2, 4] {
            let smooth = smoothed(&charts, &[Vec4::splat(3.0); 256], BINOMIAL, step);
            assert!(smooth.iter().all(|v| (v.x - 3.0).abs() < 1e-6));
        }
    }
}
