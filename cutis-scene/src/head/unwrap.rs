//! Texture coordinates for the head: regions, each flattened on its own, turned upright and packed.

use super::flatten::{Disc, flatten};
use super::mesher::Surface;
use super::neck::CUT_Y_MM;
use super::regions::{neighbours, regions};
use super::sculpture::Sculpture;
use glam::{DVec2, Vec2};
use rayon::prelude::*;
use std::collections::HashMap;

/// Free texels (of 2048) around every chart; two charts are twice as far apart.
const GUTTER: f64 = 8.0 / 2048.0;

/// A closed surface with texture coordinates.
#[derive(Debug, Clone, Default)]
pub struct Unwrapped {
    /// The surface.
    pub surface: Surface,
    /// Texture coordinates; v grows downwards.
    pub uvs: Vec<Vec2>,
    /// Texture coordinates of each triangle's corners, by number.
    pub triangle_uvs: Vec<[u32; 3]>,
}

/// A flattened region.
struct Chart {
    disc: Disc,
    /// Triangles of the surface, in the order of the disc's.
    triangles: Vec<usize>,
    flat: Vec<DVec2>,
}

/// Cuts, flattens and packs.
pub fn unwrap(surface: Surface, sculpture: &Sculpture) -> Unwrapped {
    let regions = regions(&surface, sculpture);
    let count = regions.iter().max().map_or(0, |&m| m + 1);
    let mut charts: Vec<Chart> = (0..count).into_par_iter().map(|r| chart(&surface, &regions, r)).collect();
    charts.iter_mut().for_each(|chart| {
        stand_upright(chart);
        spare_texels(chart);
    });
    pack(&mut charts);
    let mut unwrapped =
        Unwrapped { triangle_uvs: vec![[0; 3]; surface.triangles.len()], surface, uvs: Vec::new() };
    for chart in charts {
        let first = unwrapped.uvs.len() as u32;
        unwrapped.uvs.extend(chart.flat.iter().map(|p| Vec2::new(p.x as f32, 1.0 - p.y as f32)));
        for (corners, t) in chart.disc.triangles.iter().zip(chart.triangles) {
            unwrapped.triangle_uvs[t] = corners.map(|c| first + c);
        }
    }
    unwrapped
}

fn chart(surface: &Surface, regions: &[u32], region: u32) -> Chart {
    let triangles: Vec<usize> = (0..regions.len()).filter(|&t| regions[t] == region).collect();
    let mut number = HashMap::new();
    let mut disc = Disc { points_mm: Vec::new(), triangles: Vec::new(), border: Vec::new() };
    for &t in &triangles {
        disc.triangles.push(surface.triangles[t].map(|c| {
            *number.entry(c).or_insert_with(|| {
                disc.points_mm.push(surface.points_mm[c as usize].as_dvec3());
                disc.points_mm.len() as u32 - 1
            })
        }));
    }
    disc.border = border(&disc.triangles);
    let flat = flatten(&disc);
    Chart { disc, triangles, flat }
}

/// The border of a disc, in the sense of its triangles.
fn border(triangles: &[[u32; 3]]) -> Vec<u32> {
    let across = neighbours(triangles);
    let mut next = HashMap::new();
    for (t, c) in triangles.iter().enumerate() {
        for i in (0..3).filter(|&i| across[t][i] == u32::MAX) {
            next.insert(c[i], c[(i + 1) % 3]);
        }
    }
    let Some(&start) = next.keys().min() else { return Vec::new() };
    let mut ring = vec![start];
    while let Some(&p) = next.get(&ring[ring.len() - 1]).filter(|&&p| p != start) {
        ring.push(p);
    }
    ring
}

/// Turns a chart so that up in space is up in the texture, as far as it goes.
fn stand_upright(chart: &mut Chart) {
    let mut up = DVec2::ZERO;
    for corners in &chart.disc.triangles {
        let [a, b, c] = corners.map(|i| (chart.flat[i as usize], chart.disc.points_mm[i as usize]));
        // Gradient of the height (of the depth, for the base) over the texture, weighted by area.
        let height = |p: glam::DVec3| p.y - 0.01 * p.z;
        let (db, dc) = (height(b.1) - height(a.1), height(c.1) - height(a.1));
        up += (c.0 - a.0).perp() * -db + (b.0 - a.0).perp() * dc;
    }
    let turn = DVec2::new(up.y, up.x).normalize_or(DVec2::X);
    chart.flat.iter_mut().for_each(|p| *p = turn.rotate(*p));
}

/// Shrinks the charts nobody looks at closely, so that the others get more texels.
fn spare_texels(chart: &mut Chart) {
    let points = &chart.disc.points_mm;
    let middle = points.iter().sum::<glam::DVec3>() / points.len() as f64;
    let scale = if middle.y < f64::from(CUT_Y_MM) + 10.0 {
        0.5 // the end of the neck
    } else if middle.z < -40.0 && middle.x.abs() < 20.0 {
        0.85 // the back of the head
    } else {
        1.0
    };
    chart.flat.iter_mut().for_each(|p| *p *= scale);
}

/// Places the charts in the unit square: rows, the tallest first, as large as they fit, one scale for all.
fn pack(charts: &mut [Chart]) {
    let bounds =
        |flat: &[DVec2]| flat.iter().fold((DVec2::MAX, DVec2::MIN), |(lo, hi), &p| (lo.min(p), hi.max(p)));
    let mut sizes = Vec::new();
    for chart in charts.iter_mut() {
        let (lo, hi) = bounds(&chart.flat);
        chart.flat.iter_mut().for_each(|p| *p -= lo);
        sizes.push(hi - lo);
    }
    let mut order: Vec<usize> = (0..charts.len()).collect();
    order.sort_by(|&a, &b| sizes[b].y.total_cmp(&sizes[a].y));
    // Bisection on mm per unit of the texture; 40 halvings of 4 m are far below a texel.
    let (mut too_small, mut fits) = (1.0, 4000.0);
    for _ in 0..40 {
        let middle = 0.5 * (too_small + fits);
        match rows(&sizes, &order, middle) {
            Some(_) => fits = middle,
            None => too_small = middle,
        }
    }
    for (chart, corner) in charts.iter_mut().zip(rows(&sizes, &order, fits).unwrap_or_default()) {
        chart.flat.iter_mut().for_each(|p| *p = *p / fits + corner);
    }
}

/// Lower left corners of all charts at a scale, if they fit: rows of columns, a column being filled up to the height
/// of its row.
fn rows(sizes: &[DVec2], order: &[usize], mm_per_unit: f64) -> Option<Vec<DVec2>> {
    let mut corners = vec![DVec2::ZERO; sizes.len()];
    let (mut floor, mut ceiling) = (0.0f64, 0.0f64);
    // The current column: where it begins and ends, and how far up it is used.
    let (mut left, mut right, mut used) = (0.0f64, 0.0f64, 0.0f64);
    for &i in order {
        let size = sizes[i] / mm_per_unit + DVec2::splat(2.0 * GUTTER);
        let stacks = used > floor && used + size.y <= ceiling && left + size.x <= right;
        if !stacks {
            left = right;
            if left + size.x > 1.0 {
                (floor, left) = (ceiling, 0.0);
            }
            (used, right) = (floor, left + size.x);
        }
        corners[i] = DVec2::new(left, used) + DVec2::splat(GUTTER);
        used += size.y;
        ceiling = ceiling.max(used);
        if ceiling > 1.0 || right > 1.0 {
            return None;
        }
    }
    Some(corners)
}
