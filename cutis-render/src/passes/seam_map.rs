//! The seams as a texture: where charts meet, and how far the diffused light on both sides is apart.
//!
//! The mismatch is that of [`super::seams`]: |a - b| over the mean light at all seams of the object. Lines are a few texels
//! wide, so that they are seen.

use crate::passes::atlas::{ChartMap, NO_CHART};
use cutis_scene::Object;
use cutis_scene::charts::Seam;
use glam::{Vec2, Vec3, Vec4};
use std::sync::Arc;

/// Distance along a seam between two places that are looked at, texels.
const STEP_TEXELS: f32 = 0.5;

/// An edge of the surface that lies at two places of the texture.
#[derive(Debug, Clone, Copy)]
struct Edge {
    /// Its ends on either side; the same end is the same point.
    uvs: [[Vec2; 2]; 2],
    /// Chart on either side.
    charts: [u32; 2],
}

/// Where the charts of an object meet.
#[derive(Debug, Clone)]
pub struct Seams {
    edges: Vec<Edge>,
    /// Chart of every texel.
    pub charts: Arc<ChartMap>,
}

/// A place on a seam, with the light on either side.
struct Place {
    uvs: [Vec2; 2],
    charts: [u32; 2],
    light: [f32; 2],
}

impl Seams {
    /// Those of an object.
    pub fn of(object: &Object, charts: Arc<ChartMap>) -> Self {
        let chart = |t: u32| object.charts.of_triangle[t as usize];
        let edge = |seam: &Seam| Edge { uvs: seam.uvs, charts: seam.triangles.map(chart) };
        Self { edges: object.charts.seams.iter().map(edge).collect(), charts }
    }

    /// The texture: in x the mismatch of `light`, a function of a place and its chart, in y 1 beside a seam; 0 elsewhere.
    pub fn map(&self, light: impl Fn(Vec2, u32) -> Vec3) -> Vec<Vec4> {
        let places: Vec<_> = self.edges.iter().flat_map(|edge| self.places(edge, &light)).collect();
        let mean = places.iter().map(|p| 0.5 * (p.light[0] + p.light[1])).sum::<f32>() / places.len() as f32;
        let mut map = vec![Vec4::ZERO; self.charts.chart.len()];
        for place in &places {
            let mismatch = (place.light[0] - place.light[1]).abs() / mean.max(f32::MIN_POSITIVE);
            let value = Vec4::new(mismatch, 1.0, 0.0, 0.0);
            for (uv, chart) in place.uvs.into_iter().zip(place.charts) {
                self.draw(uv, chart, value, &mut map);
            }
        }
        map
    }

    fn places(&self, edge: &Edge, light: &impl Fn(Vec2, u32) -> Vec3) -> Vec<Place> {
        let length = |[from, to]: [Vec2; 2]| (to - from).length() * self.charts.size as f32;
        let count = (length(edge.uvs[0]).max(length(edge.uvs[1])) / STEP_TEXELS).ceil().max(1.0) as usize;
        let at = |f: f32| {
            let uvs = edge.uvs.map(|[from, to]| from.lerp(to, f));
            let light = [0, 1].map(|side| light(uvs[side], edge.charts[side]).element_sum());
            Place { uvs, charts: edge.charts, light }
        };
        (0..count).map(|i| at((i as f32 + 0.5) / count as f32)).collect()
    }

    /// Draws a dot over the texel of a place and those of its chart around it; of several values the greatest stays.
    fn draw(&self, uv: Vec2, chart: u32, value: Vec4, map: &mut [Vec4]) {
        let size = self.charts.size as i32;
        let [x, y] = (uv * size as f32).to_array().map(|c| c as i32);
        let around = (y - 1..=y + 1).flat_map(|y| (x - 1..=x + 1).map(move |x| [x, y]));
        let inside = |[x, y]: &[i32; 2]| (0..size).contains(x) && (0..size).contains(y);
        for texel in around.filter(inside).map(|[x, y]| (y * size + x) as usize) {
            if self.charts.chart[texel] == chart {
                map[texel] = map[texel].max(value);
            }
        }
    }
}

/// The number of the chart of every texel; -1 where there is none.
pub fn chart_numbers(charts: &ChartMap) -> Vec<Vec4> {
    let number = |&chart: &u32| Vec4::splat(if chart == NO_CHART { -1.0 } else { chart as f32 });
    charts.chart.iter().map(number).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two charts side by side, cut down the middle of the texture.
    fn cut() -> Seams {
        let chart = (0..64 * 64).map(|i| u32::from(i % 64 >= 32)).collect();
        let side = |u: f32| [Vec2::new(u, 0.25), Vec2::new(u, 0.75)];
        let edge = Edge { uvs: [side(0.49), side(0.51)], charts: [0, 1] };
        Seams { edges: vec![edge], charts: Arc::new(ChartMap::new(64, chart)) }
    }

    #[test]
    fn light_that_matches_has_seams_without_mismatch() {
        let map = cut().map(|_, _| Vec3::ONE);
        assert!(map.iter().all(|texel| texel.x == 0.0));
        let lines: Vec<_> = (0..64 * 64).filter(|&i| map[i].y == 1.0).map(|i| [i % 64, i / 64]).collect();
        assert!(lines.iter().all(|[x, y]| (30..=33).contains(x) && (15..=48).contains(y)), "{lines:?}");
        assert!((16..48).all(|y| (31..=32).all(|x| lines.contains(&[x, y]))), "{lines:?}");
    }

    #[test]
    fn the_mismatch_is_relative_to_the_mean_of_both_sides() {
        // 3 on one side, 1 on the other: 2 apart, 2 on the mean, whatever the unit.
        for unit in [1e-3, 1.0, 1e3] {
            let map = cut().map(|_, chart| Vec3::splat(unit * if chart == 0 { 3.0 } else { 1.0 }));
            let most = map.iter().map(|texel| texel.x).fold(0.0, f32::max);
            assert!((most - 1.0).abs() < 1e-5, "{most}");
            assert!(map.iter().all(|texel| texel.x == 0.0 || texel.y == 1.0));
        }
    }

    #[test]
    fn an_object_without_seams_has_an_empty_map() {
        let map = Seams { edges: Vec::new(), ..cut() }.map(|_, _| Vec3::ONE);
        assert!(map.iter().all(|texel| *texel == Vec4::ZERO));
    }
}
