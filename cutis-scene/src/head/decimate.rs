//! Thins a closed surface by edge collapse until it has the wanted number of triangles, always taking the edge that
//! is shortest compared with the length wanted at its place.
//!
//! The surface stays a closed manifold: an edge goes only if its two ends have exactly two neighbours in common
//! (link condition; Dey et al. 1999, not opened) and no triangle around it turns over.

use super::mesher::Surface;
use glam::Vec3;
use rayon::prelude::*;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A point with more triangles around it than this takes no more: fans make poor texture maps.
const MOST_TRIANGLES_AT_A_POINT: usize = 9;

/// Collapses edges until `triangles` are left; `edge_length_mm` says how long edges should be where.
pub fn decimate(
    surface: Surface,
    triangles: usize,
    edge_length_mm: &(impl Fn(Vec3) -> f32 + Sync),
) -> Surface {
    let mut thinning = Thinning::new(surface, edge_length_mm);
    while thinning.alive > triangles && thinning.step() {}
    thinning.finish()
}

/// Relative length of an edge as ordered bits, its ends, and how often they had moved.
type Entry = (u32, [u32; 2], [u32; 2]);

struct Thinning<'a, F> {
    surface: Surface,
    dead: Vec<bool>,
    alive: usize,
    around: Vec<Vec<u32>>,
    /// Wanted edge length at each point, mm.
    wanted_mm: Vec<f32>,
    /// Counts the moves of a point: older queue entries of its edges are void.
    moves: Vec<u32>,
    queue: BinaryHeap<Reverse<Entry>>,
    edge_length_mm: &'a F,
}

impl<'a, F: Fn(Vec3) -> f32 + Sync> Thinning<'a, F> {
    fn new(surface: Surface, edge_length_mm: &'a F) -> Self {
        let points = surface.points_mm.len();
        let mut around = vec![Vec::with_capacity(7); points];
        for (t, corners) in surface.triangles.iter().enumerate() {
            corners.iter().for_each(|&c| around[c as usize].push(t as u32));
        }
        let mut thinning = Self {
            dead: vec![false; surface.triangles.len()],
            alive: surface.triangles.len(),
            wanted_mm: surface.points_mm.par_iter().map(|&p| edge_length_mm(p)).collect(),
            moves: vec![0; points],
            queue: BinaryHeap::new(),
            surface,
            around,
            edge_length_mm,
        };
        let edges: Vec<_> =
            thinning.surface.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
        thinning.queue =
            edges.iter().filter(|[a, b]| a < b).map(|&edge| Reverse(thinning.entry(edge))).collect();
        thinning
    }

    /// Queue entry of an edge: its relative length as ordered bits, its ends, and their moves so far.
    fn entry(&self, [a, b]: [u32; 2]) -> Entry {
        let (i, j) = (a as usize, b as usize);
        let length = (self.surface.points_mm[i] - self.surface.points_mm[j]).length();
        let ratio = length / (self.wanted_mm[i] + self.wanted_mm[j]);
        (ratio.to_bits(), [a, b], [self.moves[i], self.moves[j]])
    }

    /// Takes the next edge from the queue; `false` when there is none left.
    fn step(&mut self) -> bool {
        let Some(Reverse((_, [a, b], moves))) = self.queue.pop() else { return false };
        if [self.moves[a as usize], self.moves[b as usize]] == moves && self.allowed(a, b) {
            self.collapse(a, b);
        }
        true
    }

    /// The points around a point: in each of its triangles the corner that follows it.
    fn neighbours(&self, point: u32) -> impl Iterator<Item = u32> + Clone {
        self.around[point as usize].iter().map(move |&t| {
            let [a, b, c] = self.surface.triangles[t as usize];
            if a == point {
                b
            } else if b == point {
                c
            } else {
                a
            }
        })
    }

    fn allowed(&self, a: u32, b: u32) -> bool {
        let (of_a, of_b) = (self.neighbours(a), self.neighbours(b));
        if self.around[a as usize].len() + self.around[b as usize].len() > MOST_TRIANGLES_AT_A_POINT + 4 {
            return false;
        }
        let common = of_a.filter(|n| of_b.clone().any(|m| m == *n)).count();
        common == 2 && self.keeps_faces(a, b) && self.keeps_faces(b, a)
    }

    /// Whether the triangles around `a` that outlive the edge keep their side and some area.
    fn keeps_faces(&self, a: u32, b: u32) -> bool {
        let points = &self.surface.points_mm;
        let middle = 0.5 * (points[a as usize] + points[b as usize]);
        self.around[a as usize].iter().map(|&t| self.surface.triangles[t as usize]).all(|corners| {
            if corners.contains(&b) {
                return true;
            }
            let at = |moved: bool| {
                let p = corners.map(|c| if moved && c == a { middle } else { points[c as usize] });
                (p[1] - p[0]).cross(p[2] - p[0])
            };
            let (before, after) = (at(false), at(true));
            before.dot(after) > 0.3 * before.length() * after.length()
        })
    }

    fn collapse(&mut self, a: u32, b: u32) {
        let (i, j) = (a as usize, b as usize);
        let middle = 0.5 * (self.surface.points_mm[i] + self.surface.points_mm[j]);
        for t in std::mem::take(&mut self.around[j]) {
            let corners = self.surface.triangles[t as usize];
            if corners.contains(&a) {
                self.dead[t as usize] = true;
                self.alive -= 1;
                corners.iter().for_each(|&c| self.around[c as usize].retain(|&other| other != t));
            } else {
                self.surface.triangles[t as usize] = corners.map(|c| if c == b { a } else { c });
                self.around[i].push(t);
            }
        }
        self.surface.points_mm[i] = middle;
        self.wanted_mm[i] = (self.edge_length_mm)(middle);
        self.moves[i] += 1;
        self.moves[j] += 1;
        let renewed: Vec<_> = self.neighbours(a).map(|n| Reverse(self.entry([a.min(n), a.max(n)]))).collect();
        self.queue.extend(renewed);
    }

    fn finish(self) -> Surface {
        let mut number = vec![u32::MAX; self.surface.points_mm.len()];
        let mut slim = Surface::default();
        for (corners, _) in self.surface.triangles.iter().zip(&self.dead).filter(|(_, dead)| !**dead) {
            slim.triangles.push(corners.map(|c| {
                if number[c as usize] == u32::MAX {
                    number[c as usize] = slim.points_mm.len() as u32;
                    slim.points_mm.push(self.surface.points_mm[c as usize]);
                }
                number[c as usize]
            }));
        }
        slim
    }
}
