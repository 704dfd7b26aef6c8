//! The edges of charts: which texels hold light of their own, and what lies beside them, across seams.

use super::walk::{Arrival, Ground, ON_THE_EDGE_TEXELS};
use crate::passes::atlas::{Atlas, NO_CHART, charts_that_hold_light};
use cutis_scene::Object;
use glam::{IVec2, Vec2};
use rayon::prelude::*;

/// Texels around an edge of a chart that have to do with it: more than the diagonal of a texel.
const NEAR_TEXELS: f32 = 1.5;
/// Times that a read goes back and forth over a seam, …
const DEPTH: usize = 12;
/// … while this weight is left.
const NEGLIGIBLE: f32 = 3e-3;
/// Texels with so many times the area tell less of a place beyond a seam than what is on this side.
const MUCH_LARGER: f32 = 4.0;
/// Most texels of a read: at the poles of a ball dozens take part, the rest of them with next to nothing.
const MOST_TEXELS: usize = 8;
/// Least weight of texels that a read needs.
const LEAST_WEIGHT: f32 = 1e-3;
/// Texels around one, nearest first.
const AROUND: [IVec2; 8] = [
    IVec2::new(1, 0),
    IVec2::new(0, 1),
    IVec2::new(-1, 0),
    IVec2::new(0, -1),
    IVec2::new(1, 1),
    IVec2::new(-1, 1),
    IVec2::new(-1, -1),
    IVec2::new(1, -1),
];

/// A read: texels and their weights, which sum to 1.
pub type Read = Vec<(u32, f32)>;

/// Texels and their charts, on foot.
pub struct Shore<'a> {
    /// The mesh under them.
    pub ground: Ground<'a>,
    /// Whether a texel's centre lies on the surface, and not in the padding around it.
    pub own: Vec<bool>,
    /// Whether an edge across which the texture does not go on is near.
    pub near: Vec<bool>,
    /// Area of a texel on every triangle, mm².
    pub texels_mm2: Vec<f32>,
    object: &'a Object,
    /// The atlas.
    pub atlas: &'a Atlas,
}

impl<'a> Shore<'a> {
    /// Of an object and its atlas.
    pub fn new(object: &'a Object, atlas: &'a Atlas) -> Self {
        let size = atlas.size;
        let mut ground = Ground::new(object, size);
        let is_own = |i: usize| {
            // A halved map of charts may have given the texel to another one.
            let uv = atlas.atlas_uv_under(object, i).filter(|_| is_of_its_chart(object, atlas, i));
            uv.is_some_and(|uv| (uv * size as f32 - centre(i, size)).length() < ON_THE_EDGE_TEXELS)
        };
        let own: Vec<bool> = (0..size * size).into_par_iter().map(is_own).collect();
        // Light ends at the edges of the others: a step to a texel's centre would lead far beyond them.
        let holds_light = charts_that_hold_light(object, size);
        ground.leave_out(|chart| holds_light[chart as usize]);
        let near = near_edges(&ground, object, size);
        let texel_mm2 = |t: usize| {
            let [a, b, c] = ground.corners(t as u32);
            object.mesh.area_mm2(t) / (0.5 * (b - a).perp_dot(c - a).abs()).max(f32::MIN_POSITIVE)
        };
        let texels_mm2 = (0..object.mesh.triangles.len()).map(texel_mm2).collect();
        Self { ground, own, near, texels_mm2, object, atlas }
    }

    /// Width and height of the atlas, texels.
    pub fn size(&self) -> usize {
        self.atlas.size
    }

    /// Whether an edge may cross the square between four texels, of which `first` has the lowest number. A square that none
    /// crosses lies on one chart as a whole, or beside all. Squares along the edge of the texture are edges, too.
    pub fn may_be_cut(&self, first: usize) -> bool {
        let size = self.size();
        let outermost = [first % size, first / size].iter().any(|&at| at == 0 || at + 2 >= size);
        outermost || corners(first, size).iter().all(|&texel| self.near[texel])
    }

    /// Whether the square lies on one chart as a whole.
    pub fn is_whole(&self, first: usize) -> bool {
        !self.may_be_cut(first) && corners(first, self.size()).iter().all(|&texel| self.own[texel])
    }

    /// What a texel that nothing is known of but its chart's edge reads: padding looks across the seam.
    pub fn padding(&self) -> Vec<(u32, Read)> {
        let size = self.size();
        (0..size * size)
            .into_par_iter()
            .filter(|&i| self.atlas.charts.chart[i] != NO_CHART && !self.own[i])
            .filter_map(|i| {
                let to = |from: Vec2, triangle: u32| {
                    self.read(&self.ground.walk(triangle, from, centre(i, size) - from))
                };
                let read = if is_of_its_chart(self.object, self.atlas, i) {
                    to(
                        self.atlas.atlas_uv_under(self.object, i)? * size as f32,
                        self.atlas.surface[i].triangle,
                    )
                } else {
                    // Where charts are less than a texel apart, the surface under it is another one's.
                    self.beside(i).and_then(|own| to(centre(own, size), self.atlas.surface[own].triangle))
                };
                // Where nothing can be read there, what is nearest on this side goes on.
                Some((i as u32, read.or_else(|| Some(vec![(self.beside(i)? as u32, 1.0)]))?))
            })
            .collect()
    }

    /// Texels of a chart, with those around it, in a bilinear read at a place; none beside the map.
    pub fn seen_at(&self, place: Vec2, chart: u32) -> Vec<(u32, f32)> {
        if place.min_element() < 0.0 || place.max_element() > self.size() as f32 {
            return Vec::new();
        }
        let around = self.atlas.charts.around(place / self.size() as f32);
        let seen = around.iter().filter(|(texel, _)| self.atlas.charts.chart[*texel] == chart);
        let sum: f32 = seen.clone().map(|(_, weight)| weight).sum();
        seen.filter(|_| sum > LEAST_WEIGHT).map(|&(texel, weight)| (texel as u32, weight / sum)).collect()
    }

    /// The own texel of the same chart next to one.
    fn beside(&self, texel: usize) -> Option<usize> {
        let size = self.size() as i32;
        let at = IVec2::new(texel as i32 % size, texel as i32 / size);
        let chart = self.atlas.charts.chart[texel];
        let inside =
            AROUND.iter().map(|&to| at + to).filter(|p| p.min_element() >= 0 && p.max_element() < size);
        inside
            .map(|p| (p.y * size + p.x) as usize)
            .find(|&i| self.own[i] && self.atlas.charts.chart[i] == chart)
    }

    /// The four corners of a square as they are seen from a place in it, by straight ways. A corner beyond an open border holds
    /// what the corner beside it holds, so that nothing flows out. `None` if no texel is in sight.
    pub fn corners_from(&self, triangle: u32, place: Vec2, first: usize) -> Option<[Read; 4]> {
        let size = self.size();
        let seen = corners(first, size).map(|texel| {
            let arrival = self.ground.walk(triangle, place, centre(texel, size) - place);
            if arrival.at_border || self.is_coarse(&arrival, triangle) { None } else { self.read(&arrival) }
        });
        // Beside along u, along v, across.
        let in_sight = |k: usize| [k, k ^ 1, k ^ 2, k ^ 3].into_iter().find_map(|k| seen[k].clone());
        Some([in_sight(0)?, in_sight(1)?, in_sight(2)?, in_sight(3)?])
    }

    /// The chart of a texel.
    pub fn chart(&self, texel: usize) -> u32 {
        self.atlas.charts.chart[texel]
    }

    /// Whether a way has crossed a seam to much larger texels, which tell less of the place than those on this side.
    fn is_coarse(&self, arrival: &Arrival, triangle: u32) -> bool {
        let mm2 = |triangle: u32| self.texels_mm2[triangle as usize];
        arrival.over_seam && mm2(arrival.triangle) > MUCH_LARGER * mm2(triangle)
    }

    /// A bilinear read where a way has led. A corner of it that lies beyond the edge of the chart is read on the other side, where
    /// corners may be missing, too, and so on: between the texels on both sides of a seam that is linear interpolation.
    pub fn read(&self, arrival: &Arrival) -> Option<Read> {
        let mut read = Read::new();
        self.add(arrival, 1.0, 0, &mut read);
        // By number where weights are equal, so that all runs leave out the same.
        read.sort_by(|(one, a), (other, b)| b.total_cmp(a).then(one.cmp(other)));
        read.truncate(MOST_TEXELS);
        let sum: f32 = read.iter().map(|(_, weight)| weight).sum();
        read.iter_mut().for_each(|(_, weight)| *weight /= sum);
        (sum > LEAST_WEIGHT).then_some(read)
    }

    fn add(&self, arrival: &Arrival, weight: f32, depth: usize, read: &mut Read) {
        let around = self.atlas.charts.around(arrival.place / self.size() as f32);
        // Where no texel of the chart is near, a step to a texel's centre would lead far beyond it.
        if !around.iter().any(|(texel, _)| self.counts(*texel, arrival.triangle)) {
            return;
        }
        for (texel, part) in around {
            let weight = weight * part;
            if self.counts(texel, arrival.triangle) {
                match read.iter_mut().find(|(known, _)| *known == texel as u32) {
                    Some((_, sum)) => *sum += weight,
                    None if weight > 1e-6 => read.push((texel as u32, weight)),
                    None => {}
                }
            } else if weight > NEGLIGIBLE && depth < DEPTH {
                let step = centre(texel, self.size()) - arrival.place;
                let on = self.ground.walk(arrival.triangle, arrival.place, step);
                if !on.at_border {
                    self.add(&on, weight, depth + 1, read);
                }
            }
        }
    }

    /// Whether a texel holds light of the chart of a triangle.
    fn counts(&self, texel: usize, triangle: u32) -> bool {
        let chart = self.object.charts.of_triangle[triangle as usize];
        self.own[texel] && self.atlas.charts.chart[texel] == chart
    }
}

/// Whether the surface under a texel is of the chart that the texel belongs to.
fn is_of_its_chart(object: &Object, atlas: &Atlas, i: usize) -> bool {
    let triangle = atlas.surface[i].triangle;
    triangle != NO_CHART && object.charts.of_triangle[triangle as usize] == atlas.charts.chart[i]
}

/// The centre of a texel, texels.
pub fn centre(texel: usize, size: usize) -> Vec2 {
    Vec2::new((texel % size) as f32 + 0.5, (texel / size) as f32 + 0.5)
}

/// The four texels of a square, by the first of them: along u, then along v.
pub fn corners(first: usize, size: usize) -> [usize; 4] {
    [first, first + 1, first + size, first + size + 1]
}

/// Texels within [`NEAR_TEXELS`] of an edge across which the texture does not go on.
fn near_edges(ground: &Ground, object: &Object, size: usize) -> Vec<bool> {
    let mut near = vec![false; size * size];
    for triangle in 0..object.mesh.triangles.len() as u32 {
        let corners = ground.corners(triangle);
        for corner in (0..3u8).filter(|&corner| !ground.goes_on(triangle, corner)) {
            let (a, b) = (corners[usize::from(corner)], corners[(usize::from(corner) + 1) % 3]);
            mark_line(&mut near, size, a, b);
        }
    }
    near
}

fn mark_line(near: &mut [bool], size: usize, a: Vec2, b: Vec2) {
    let last = size as f32 - 1.0;
    let lo = (a.min(b) - NEAR_TEXELS - 0.5).clamp(Vec2::ZERO, Vec2::splat(last)).as_uvec2();
    let hi = (a.max(b) + NEAR_TEXELS - 0.5).ceil().clamp(Vec2::ZERO, Vec2::splat(last)).as_uvec2();
    let along = b - a;
    for y in lo.y..=hi.y {
        for x in lo.x..=hi.x {
            let p = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            let part = ((p - a).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
            if (a + along * part - p).length() <= NEAR_TEXELS {
                near[y as usize * size + x as usize] = true;
            }
        }
    }
}
