//! Makes triangles rounder: flips edges towards Delaunay, slides points towards the middle of their neighbours, and
//! puts them back onto the sculpture.

use super::mesher::Surface;
use super::sculpture::Sculpture;
use glam::Vec3;
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};

/// Runs `rounds` of flipping and sliding.
pub fn polish(mut surface: Surface, sculpture: &Sculpture, rounds: usize) -> Surface {
    for _ in 0..rounds {
        flip_edges(&mut surface);
        slide(&mut surface, sculpture);
    }
    surface
}

/// Flips every edge whose opposite angles add up to more than half a turn, each triangle at most once.
fn flip_edges(surface: &mut Surface) {
    let mut sides: HashMap<[u32; 2], Vec<(usize, usize)>> =
        HashMap::with_capacity(surface.triangles.len() * 3 / 2);
    for (t, c) in surface.triangles.iter().enumerate() {
        for i in 0..3 {
            let (a, b) = (c[i], c[(i + 1) % 3]);
            sides.entry([a.min(b), a.max(b)]).or_default().push((t, i));
        }
    }
    let mut edges: HashSet<[u32; 2]> = sides.keys().copied().collect();
    let mut list: Vec<_> = sides.into_iter().collect();
    list.sort_unstable();
    let mut touched = vec![false; surface.triangles.len()];
    for (_, uses) in list {
        let [(t, i), (s, j)] = uses[..] else { continue };
        let (a, b) = (surface.triangles[t][i], surface.triangles[t][(i + 1) % 3]);
        let (c, d) = (surface.triangles[t][(i + 2) % 3], surface.triangles[s][(j + 2) % 3]);
        let crossing = [c.min(d), c.max(d)];
        if touched[t] || touched[s] || edges.contains(&crossing) || !better(&surface.points_mm, [a, b, c, d])
        {
            continue;
        }
        surface.triangles[t] = [a, d, c];
        surface.triangles[s] = [d, b, c];
        edges.insert(crossing);
        (touched[t], touched[s]) = (true, true);
    }
}

/// Whether the quad a–d–b–c is better cut along c–d than along a–b.
fn better(points: &[Vec3], corners: [u32; 4]) -> bool {
    let [a, b, c, d] = corners.map(|i| points[i as usize]);
    let angle =
        |at: Vec3| (a - at).normalize_or_zero().dot((b - at).normalize_or_zero()).clamp(-1.0, 1.0).acos();
    if angle(c) + angle(d) < std::f32::consts::PI + 0.1 {
        return false;
    }
    let normal = |p: Vec3, q: Vec3, r: Vec3| (q - p).cross(r - p).normalize_or_zero();
    let before = (normal(a, b, c) + normal(a, d, b)).normalize_or_zero();
    // Only on nearly flat ground: across a crease a flip would cut the crease.
    normal(a, b, c).dot(normal(a, d, b)) > 0.8
        && normal(a, d, c).dot(before) > 0.7
        && normal(d, b, c).dot(before) > 0.7
}

fn slide(surface: &mut Surface, sculpture: &Sculpture) {
    let mut sums = vec![(Vec3::ZERO, 0.0f32); surface.points_mm.len()];
    for c in &surface.triangles {
        let p = c.map(|i| surface.points_mm[i as usize]);
        let area = (p[1] - p[0]).cross(p[2] - p[0]).length();
        let middle = (p[0] + p[1] + p[2]) / 3.0;
        for &i in c {
            sums[i as usize].0 += middle * area;
            sums[i as usize].1 += area;
        }
    }
    surface.points_mm = surface
        .points_mm
        .par_iter()
        .zip(&sums)
        .map(|(&p, &(sum, area))| {
            let wish = if area > 0.0 { 0.5 * (sum / area - p) } else { Vec3::ZERO };
            let normal = sculpture.normal(p);
            sculpture.project(p + wish - normal * normal.dot(wish), 2)
        })
        .collect();
}
