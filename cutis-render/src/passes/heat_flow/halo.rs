//! What lies beside texels that have no neighbour of their own chart: a bilinear read where a straight way over the surface leads.

use super::walk::{Arrival, Ground};
use crate::passes::atlas::{Atlas, NO_CHART};
use cutis_scene::Object;
use glam::{IVec2, Vec2};
use rayon::prelude::*;

/// The eight neighbours of a texel: east, north-east, north and so on.
pub const NEIGHBOURS: [IVec2; 8] = [
    IVec2::new(1, 0),
    IVec2::new(1, 1),
    IVec2::new(0, 1),
    IVec2::new(-1, 1),
    IVec2::new(-1, 0),
    IVec2::new(-1, -1),
    IVec2::new(0, -1),
    IVec2::new(1, -1),
];
/// Texels around an edge of a chart whose neighbours are looked for on foot.
const NEAR_TEXELS: f32 = 2.0;
/// Distance, in texels, by which a texel's centre may miss its place on the surface: padding is farther off.
const CENTRED_TEXELS: f32 = 2e-3;
/// Times that a read goes back and forth over a seam, …
const DEPTH: usize = 12;
/// … while this weight is left.
const NEGLIGIBLE: f32 = 1e-3;
/// Places of a texel's cell, along each side, that are asked whether the chart covers them.
const PLACES: usize = 8;
/// Smallest area that a texel stands for: a smaller one would set the pace for all.
const LEAST_COVER: f32 = 0.4;
/// Least weight of texels that a read needs.
const LEAST_WEIGHT: f32 = 1e-3;

/// A read: texels and their weights, which sum to 1.
pub type Read = Vec<(u32, f32)>;

/// A texel near an edge of its chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Shore {
    /// The texel.
    pub texel: u32,
    /// Its eight neighbours.
    pub neighbours: [Read; 8],
}

/// Everything that the edges of charts need; it depends on the layout alone.
#[derive(Debug, Clone)]
pub struct Halo {
    /// Whether a texel's centre lies on the surface, and not in the padding around it.
    pub own: Vec<bool>,
    /// Texels near edges.
    pub shores: Vec<Shore>,
    /// Texels of the padding, and what they hold.
    pub padding: Vec<(u32, Read)>,
    /// Area of the chart that each own texel stands for, in texels: 1 but near edges, where cells are cut or have strips beside
    /// them that belong to no other.
    pub cover: Vec<f32>,
}

impl Halo {
    /// Of an object and its atlas.
    pub fn new(object: &Object, atlas: &Atlas) -> Self {
        let size = atlas.size;
        let ground = Ground::new(object, size);
        let centre = |i: usize| Vec2::new((i % size) as f32 + 0.5, (i / size) as f32 + 0.5);
        let own: Vec<bool> = (0..size * size)
            .into_par_iter()
            .map(|i| {
                let uv = atlas.uv_under(object, i);
                uv.is_some_and(|uv| (uv * size as f32 - centre(i)).length() < CENTRED_TEXELS)
            })
            .collect();
        let near = near_edges(&ground, object, size);
        let coast = Coast { object, atlas, ground: &ground, own: &own };
        let shores = (0..size * size)
            .into_par_iter()
            .filter(|&i| own[i] && near[i])
            .map(|i| Shore { texel: i as u32, neighbours: NEIGHBOURS.map(|to| coast.neighbour(i, to)) })
            .collect();
        let padding = (0..size * size)
            .into_par_iter()
            .filter(|&i| atlas.surface[i].triangle != NO_CHART && !own[i])
            .filter_map(|i| {
                let from = atlas.uv_under(object, i)? * size as f32;
                let arrival = ground.walk(atlas.surface[i].triangle, from, centre(i) - from);
                // Where nothing can be read there, what is nearest on this side goes on.
                let beside = || Some(vec![(coast.heir(i)? as u32, 1.0)]);
                Some((i as u32, coast.read_at(&arrival).or_else(beside)?))
            })
            .collect();
        let cover = coast.cover(&near);
        Self { own, shores, padding, cover }
    }
}

struct Coast<'a> {
    object: &'a Object,
    atlas: &'a Atlas,
    ground: &'a Ground<'a>,
    own: &'a [bool],
}

impl Coast<'_> {
    /// See [`Halo::cover`].
    fn cover(&self, near: &[bool]) -> Vec<f32> {
        let size = self.atlas.size;
        let counted: Vec<(usize, f32)> = (0..size * size)
            .into_par_iter()
            .filter(|&i| near[i] && self.atlas.surface[i].triangle != NO_CHART)
            .filter_map(|i| Some((self.heir(i)?, self.covered_part(i)?)))
            .collect();
        let mut cover: Vec<f32> = (0..size * size).map(|i| if near[i] { 0.0 } else { 1.0 }).collect();
        counted.into_iter().for_each(|(texel, part)| cover[texel] += part);
        cover.iter_mut().for_each(|part| *part = part.max(LEAST_COVER));
        cover
    }

    /// The own texel that stands for the chart's part of a texel's cell: itself, or the nearest beside it.
    fn heir(&self, texel: usize) -> Option<usize> {
        if self.own[texel] {
            return Some(texel);
        }
        let size = self.atlas.size as i32;
        let (x, y) = (texel as i32 % size, texel as i32 / size);
        let chart = self.atlas.charts.chart[texel];
        // Those beside it are nearer than those across a corner.
        let order = [0, 2, 4, 6, 1, 3, 5, 7].map(|k: usize| NEIGHBOURS[k]);
        let beside = order.iter().map(|to| (x + to.x, y + to.y));
        let inside = beside.filter(|(x, y)| (0..size).contains(x) && (0..size).contains(y));
        inside
            .map(|(x, y)| (y * size + x) as usize)
            .find(|&i| self.own[i] && self.atlas.charts.chart[i] == chart)
    }

    /// Part of a texel's cell that its chart covers: places in it that a way reaches without leaving the chart.
    fn covered_part(&self, texel: usize) -> Option<f32> {
        let triangle = self.atlas.surface[texel].triangle;
        let from = self.atlas.uv_under(self.object, texel)? * self.atlas.size as f32;
        let corner = self.centre(texel) - 0.5;
        let place =
            |i: usize| corner + (Vec2::new((i % PLACES) as f32, (i / PLACES) as f32) + 0.5) / PLACES as f32;
        let reached = (0..PLACES * PLACES).filter(|&i| {
            let arrival = self.ground.walk(triangle, from, place(i) - from);
            !arrival.over_seam && !arrival.at_border
        });
        Some(reached.count() as f32 / (PLACES * PLACES) as f32)
    }

    /// What lies beside a texel; the texel itself where the surface ends, so that nothing flows.
    fn neighbour(&self, texel: usize, to: IVec2) -> Read {
        let arrival = self.ground.walk(self.atlas.surface[texel].triangle, self.centre(texel), to.as_vec2());
        let read = if arrival.at_border { None } else { self.read_at(&arrival) };
        read.unwrap_or_else(|| vec![(texel as u32, 1.0)])
    }

    fn centre(&self, texel: usize) -> Vec2 {
        let size = self.atlas.size;
        Vec2::new((texel % size) as f32 + 0.5, (texel / size) as f32 + 0.5)
    }

    /// A bilinear read where a way has led. A corner of it that lies beyond the edge of the chart is read on the other side, where
    /// corners may be missing, too, and so on: between the texels on both sides of a seam that is linear interpolation.
    fn read_at(&self, arrival: &Arrival) -> Option<Read> {
        let mut read = Read::new();
        self.add(arrival, 1.0, 0, &mut read);
        let sum: f32 = read.iter().map(|(_, weight)| weight).sum();
        read.iter_mut().for_each(|(_, weight)| *weight /= sum);
        (sum > LEAST_WEIGHT).then_some(read)
    }

    fn add(&self, arrival: &Arrival, weight: f32, depth: usize, read: &mut Read) {
        let corners = self.corners(arrival);
        // A chart of less than a texel holds no light, and a step to a texel's centre would lead far beyond it.
        if !corners.iter().any(|(texel, _)| self.counts(*texel, arrival.triangle)) {
            return;
        }
        for (texel, part) in corners {
            let weight = weight * part;
            if self.counts(texel, arrival.triangle) {
                match read.iter_mut().find(|(known, _)| *known == texel as u32) {
                    Some((_, sum)) => *sum += weight,
                    None if weight > 0.0 => read.push((texel as u32, weight)),
                    None => {}
                }
            } else if weight > NEGLIGIBLE && depth < DEPTH {
                let step = self.centre(texel) - arrival.place;
                let on = self.ground.walk(arrival.triangle, arrival.place, step);
                if !on.at_border {
                    self.add(&on, weight, depth + 1, read);
                }
            }
        }
    }

    fn corners(&self, arrival: &Arrival) -> [(usize, f32); 4] {
        self.atlas.charts.around(arrival.place / self.atlas.size as f32)
    }

    /// Whether a texel holds light of the chart of a triangle.
    fn counts(&self, texel: usize, triangle: u32) -> bool {
        let chart = self.object.charts.of_triangle[triangle as usize];
        self.own[texel] && self.atlas.charts.chart[texel] == chart
    }
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
