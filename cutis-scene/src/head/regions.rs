//! Cuts the surface into the pieces that become charts: face with throat, back, each ear outside and inside, base.

use super::mesher::Surface;
use super::neck::CUT_Y_MM;
use super::sculpture::{Sculpture, mirrored};
use glam::Vec3;
use std::collections::HashMap;

/// A triangle belongs to the ear where the ear has moved the surface by this much, mm.
const EAR_SHIFT_MM: f32 = 1.3;

/// The three neighbours of every triangle, across the edges from corner i to corner i + 1.
pub fn neighbours(triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut open: HashMap<[u32; 2], (usize, usize)> = HashMap::with_capacity(triangles.len());
    let mut list = vec![[u32::MAX; 3]; triangles.len()];
    for (t, c) in triangles.iter().enumerate() {
        for i in 0..3 {
            let (a, b) = (c[i], c[(i + 1) % 3]);
            if let Some((s, j)) = open.remove(&[b, a]) {
                list[t][i] = s as u32;
                list[s][j] = t as u32;
            } else {
                open.insert([a, b], (t, i));
            }
        }
    }
    list
}

/// Region of every triangle, numbered from 0; every region is connected and has the topology of a disc.
pub fn regions(surface: &Surface, sculpture: &Sculpture) -> Vec<u32> {
    use rayon::prelude::*;
    let neighbours = neighbours(&surface.triangles);
    let mut labels: Vec<u32> =
        (0..surface.triangles.len()).into_par_iter().map(|t| label(sculpture, centre(surface, t))).collect();
    for _ in 0..4 {
        labels = smoothed(&labels, &neighbours);
    }
    absorb_islands(&mut labels, &neighbours);
    split_until_discs(&mut labels, surface, &neighbours)
}

fn centre(surface: &Surface, t: usize) -> Vec3 {
    surface.triangles[t].iter().map(|&c| surface.points_mm[c as usize]).sum::<Vec3>() / 3.0
}

/// 0 face, 1 back, 2 base, 3 and 4 ear outside, 5 and 6 ear inside.
fn label(sculpture: &Sculpture, p: Vec3) -> u32 {
    let side = mirrored(p);
    if sculpture.ear.near(side) {
        let (bare, hollow) = (sculpture.without_ears(p), sculpture.ear.in_hollow(side));
        if hollow || bare.abs() > EAR_SHIFT_MM {
            let outside = hollow || bare < 0.0 || sculpture.ear.front_mm(side) > 0.0;
            return if outside { 3 } else { 5 } + u32::from(p.x < 0.0);
        }
    }
    if p.y < CUT_Y_MM + 4.0 && sculpture.normal(p).y < -0.8 {
        return 2;
    }
    // Through the middle of the ears, over the crown, and down behind the sternocleidomastoid.
    u32::from(p.z < SEAM_Z_MM - 0.1 * (p.y + 17.0).min(0.0))
}

/// Plane of the seam between face and back at the height of the ears, mm.
const SEAM_Z_MM: f32 = -18.0;

/// Each triangle takes the label that two of its neighbours share.
fn smoothed(labels: &[u32], neighbours: &[[u32; 3]]) -> Vec<u32> {
    let vote = |t: usize| {
        let [a, b, c] = neighbours[t].map(|n| labels[n as usize]);
        if a == b || a == c {
            a
        } else if b == c {
            b
        } else {
            labels[t]
        }
    };
    (0..labels.len()).map(vote).collect()
}

/// Connected pieces of equal label: the piece of each triangle and the triangles of each piece.
fn pieces(labels: &[u32], neighbours: &[[u32; 3]]) -> (Vec<u32>, Vec<Vec<usize>>) {
    let mut piece = vec![u32::MAX; labels.len()];
    let mut members = Vec::new();
    for start in 0..labels.len() {
        if piece[start] != u32::MAX {
            continue;
        }
        let number = members.len() as u32;
        let (mut list, mut next) = (vec![start], 0);
        piece[start] = number;
        while next < list.len() {
            for n in neighbours[list[next]].map(|n| n as usize) {
                if piece[n] == u32::MAX && labels[n] == labels[start] {
                    piece[n] = number;
                    list.push(n);
                }
            }
            next += 1;
        }
        members.push(list);
    }
    (piece, members)
}

/// Keeps the largest piece of every label and gives the others to the neighbour with the longest common border.
fn absorb_islands(labels: &mut [u32], neighbours: &[[u32; 3]]) {
    // Each round removes at least the islands inside larger ones; islands in islands in islands do not occur.
    for _ in 0..4 {
        let (_, members) = pieces(labels, neighbours);
        let mut largest: HashMap<u32, usize> = HashMap::new();
        for list in &members {
            let size = largest.entry(labels[list[0]]).or_default();
            *size = (*size).max(list.len());
        }
        for list in &members {
            let own = labels[list[0]];
            if list.len() == largest[&own] {
                continue;
            }
            let mut border = [0usize; 8];
            for n in list.iter().flat_map(|&t| neighbours[t]) {
                border[labels[n as usize] as usize] += usize::from(labels[n as usize] != own);
            }
            let winner = (0..8).max_by_key(|&l| border[l]).unwrap_or(0) as u32;
            list.iter().for_each(|&t| labels[t] = winner);
        }
    }
}

/// Cuts pieces that are no discs in half until all are.
fn split_until_discs(labels: &mut [u32], surface: &Surface, neighbours: &[[u32; 3]]) -> Vec<u32> {
    let mut next_label = 8;
    loop {
        let (piece, members) = pieces(labels, neighbours);
        let bad: Vec<_> = members.iter().filter(|list| !is_disc(list, surface, &piece, neighbours)).collect();
        if bad.is_empty() {
            return piece;
        }
        for list in bad {
            halve(list, surface, labels, next_label);
            next_label += 1;
        }
    }
}

/// Relabels the triangles beyond the middle of the piece's longest side.
fn halve(list: &[usize], surface: &Surface, labels: &mut [u32], label: u32) {
    let centres: Vec<Vec3> = list.iter().map(|&t| centre(surface, t)).collect();
    let (lo, hi) = centres.iter().fold((Vec3::MAX, Vec3::MIN), |(lo, hi), &c| (lo.min(c), hi.max(c)));
    let axis = (hi - lo).max_position();
    let middle = 0.5 * (lo[axis] + hi[axis]);
    list.iter().zip(&centres).filter(|(_, c)| c[axis] > middle).for_each(|(&t, _)| labels[t] = label);
}

/// Whether a connected piece has Euler characteristic 1 and a border that meets no point twice.
fn is_disc(list: &[usize], surface: &Surface, piece: &[u32], neighbours: &[[u32; 3]]) -> bool {
    let (mut points, mut starts, mut inner) = (Vec::new(), Vec::new(), 0usize);
    for &t in list {
        for i in 0..3 {
            points.push(surface.triangles[t][i]);
            if piece[neighbours[t][i] as usize] == piece[t] {
                inner += 1;
            } else {
                starts.push(surface.triangles[t][i]);
            }
        }
    }
    points.sort_unstable();
    points.dedup();
    let border = starts.len();
    starts.sort_unstable();
    starts.dedup();
    let edges = inner / 2 + border;
    border > 0 && starts.len() == border && points.len() + list.len() == edges + 1
}
