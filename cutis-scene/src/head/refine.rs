//! Refines an unwrapped surface: long edges are cut in the middle, new points go onto the sculpture. Texture
//! coordinates are those of the edge's middle, so that an injective map stays injective.

use super::sculpture::Sculpture;
use super::unwrap::Unwrapped;
use glam::Vec3;
use rayon::prelude::*;
use std::collections::HashMap;

/// An edge: relative length as ordered bits, its ends, the two sides (triangle, corner where it begins).
type Edge = (u32, [u32; 2], [(u32, u8); 2]);

/// Cuts edges until there are `triangles` of them; the relatively longest first.
pub fn refine(
    mut surface: Unwrapped,
    sculpture: &Sculpture,
    triangles: usize,
    edge_length_mm: &(impl Fn(Vec3) -> f32 + Sync),
) -> Unwrapped {
    let mut wanted_mm: Vec<f32> = surface.surface.points_mm.par_iter().map(|&p| edge_length_mm(p)).collect();
    while surface.surface.triangles.len() + 1 < triangles {
        let first_new = surface.surface.points_mm.len();
        let cuts = (triangles - surface.surface.triangles.len()) / 2;
        cut_longest(&mut surface, &wanted_mm, cuts);
        let points = &mut surface.surface.points_mm;
        points[first_new..].par_iter_mut().for_each(|p| *p = sculpture.project(*p, 2));
        wanted_mm.par_extend(points[first_new..].par_iter().map(|&p| edge_length_mm(p)));
    }
    surface
}

/// Cuts at most `cuts` of the longest edges, each triangle at most once.
fn cut_longest(surface: &mut Unwrapped, wanted_mm: &[f32], cuts: usize) {
    let mut edges = edges(surface, wanted_mm);
    edges.par_sort_unstable_by(|a, b| b.cmp(a));
    // Only edges near the longest: the shorter ones may be spared once their neighbours are cut.
    let at_least = edges.first().map_or(0.0, |e| 0.7 * f32::from_bits(e.0));
    let mut touched = vec![false; surface.surface.triangles.len()];
    let mut done = 0;
    for (ratio, _, sides) in edges {
        if done == cuts || f32::from_bits(ratio) < at_least {
            break;
        }
        if sides.iter().any(|&(t, _)| touched[t as usize]) {
            continue;
        }
        sides.iter().for_each(|&(t, _)| touched[t as usize] = true);
        cut(surface, sides);
        done += 1;
    }
}

fn edges(surface: &Unwrapped, wanted_mm: &[f32]) -> Vec<Edge> {
    let triangles = &surface.surface.triangles;
    let points = &surface.surface.points_mm;
    let mut open: HashMap<[u32; 2], (u32, u8)> = HashMap::with_capacity(triangles.len());
    let mut list = Vec::with_capacity(triangles.len() * 3 / 2);
    for (t, c) in triangles.iter().enumerate() {
        for i in 0..3u8 {
            let (a, b) = (c[usize::from(i)], c[(usize::from(i) + 1) % 3]);
            let here = (t as u32, i);
            if let Some(there) = open.remove(&[b, a]) {
                let length = (points[a as usize] - points[b as usize]).length();
                let ratio = length / (wanted_mm[a as usize] + wanted_mm[b as usize]);
                list.push((ratio.to_bits(), [a, b], [there, here]));
            } else {
                open.insert([a, b], here);
            }
        }
    }
    list
}

/// Puts a point into the middle of an edge and cuts both triangles there.
fn cut(surface: &mut Unwrapped, sides: [(u32, u8); 2]) {
    let ends = |list: &[[u32; 3]], (t, i): (u32, u8)| {
        let c = list[t as usize];
        [c[usize::from(i)], c[(usize::from(i) + 1) % 3]]
    };
    let [a, b] = ends(&surface.surface.triangles, sides[0]);
    let points = &mut surface.surface.points_mm;
    let point = points.len() as u32;
    points.push(0.5 * (points[a as usize] + points[b as usize]));
    let mut last: Option<([u32; 2], u32)> = None;
    for side in sides {
        let [from, to] = ends(&surface.triangle_uvs, side);
        let uv = match last {
            Some((pair, uv)) if pair == [to, from] => uv,
            _ => {
                let middle = 0.5 * (surface.uvs[from as usize] + surface.uvs[to as usize]);
                surface.uvs.push(middle);
                surface.uvs.len() as u32 - 1
            }
        };
        last = Some(([from, to], uv));
        halve(&mut surface.surface.triangles, side, point);
        halve(&mut surface.triangle_uvs, side, uv);
    }
}

/// Replaces a triangle by the two on either side of a new corner in its edge from `corner`.
fn halve(list: &mut Vec<[u32; 3]>, (t, corner): (u32, u8), middle: u32) {
    let i = usize::from(corner);
    let c = list[t as usize];
    let (from, to, apex) = (c[i], c[(i + 1) % 3], c[(i + 2) % 3]);
    list[t as usize] = [from, middle, apex];
    list.push([middle, to, apex]);
}
