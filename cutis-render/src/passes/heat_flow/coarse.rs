//! From a map of light to one of half the size: every texel gives its energy to the four coarse ones around it.

use super::exchange::Layout;
use super::row::Light;
use super::rows::Rows;
use super::shore::{Shore, centre, corners};
use crate::passes::atlas::{Atlas, NO_CHART};
use rayon::prelude::*;

/// Parts of a texel's energy that go to the nearer and to the farther coarse texel, along each axis.
const PARTS: [f32; 2] = [0.75, 0.25];
/// Variance that this adds, coarse texel².
pub const ADDED_TEXEL2: f32 = PARTS[0] * PARTS[1];

/// Which energy goes where.
#[derive(Debug, Clone)]
pub struct Halving {
    size: usize,
    /// Coarse squares all of whose texels stand around those in them.
    whole: Vec<bool>,
    /// Area of fine texels, mm².
    fine_mm2: Vec<f32>,
    /// Area that coarse texels get, mm².
    pub areas_mm2: Vec<f32>,
    /// Fine texels in other squares, the coarse ones around them, and their parts.
    rest: Vec<(u32, u32, f32)>,
    /// Coarse texels that stood for no area at first, the fine texels of their chart under them, and the part of each in their mean.
    bare: Vec<(u32, u32, f32)>,
}

impl Halving {
    /// From texels of those areas to the ones of a coarse layout.
    pub fn new(fine: &Atlas, fine_mm2: &[f32], shore: &Shore, layout: &Layout) -> Self {
        let (size, fine_size) = (shore.size(), fine.size);
        let last = size as i64 - 2;
        let rest = (0..fine_size * fine_size)
            .into_par_iter()
            .filter(|&i| fine_mm2[i] > 0.0 && fine.surface[i].triangle != NO_CHART)
            .flat_map_iter(|i| {
                let at = |x: usize| ((x as i64 - 1).div_euclid(2)).clamp(0, last) as usize;
                let first = at(i / fine_size) * size + at(i % fine_size);
                let place = centre(i, fine_size) * 0.5;
                let corners = if layout.whole[first] {
                    None
                } else {
                    shore.corners_from(fine.surface[i].triangle, place, first)
                };
                let f = place - centre(first, size);
                let shares = [(1.0 - f.x) * (1.0 - f.y), f.x * (1.0 - f.y), (1.0 - f.x) * f.y, f.x * f.y];
                let reads = corners.into_iter().flat_map(move |c| c.into_iter().zip(shares));
                reads.flat_map(move |(read, share)| {
                    read.into_iter().map(move |(coarse, weight)| (i as u32, coarse, weight * share))
                })
            })
            .collect();
        let mut halving = Self {
            size,
            whole: layout.whole.clone(),
            fine_mm2: fine_mm2.to_vec(),
            areas_mm2: Vec::new(),
            rest,
            bare: Vec::new(),
        };
        halving.set_areas(fine_mm2);
        halving.bare = (0..size * size)
            .filter(|&i| halving.areas_mm2[i] <= 0.0 && shore.chart(i) != NO_CHART)
            .flat_map(|i| {
                let children = fine.charts.children(i % size, i / size);
                let own: Vec<usize> =
                    children.into_iter().filter(|&c| fine.charts.chart[c] == shore.chart(i)).collect();
                let part = (own.len() as f32).recip();
                own.into_iter().map(move |child| (i as u32, child as u32, part))
            })
            .collect();
        halving
    }

    /// Takes the areas of fine texels in another pose.
    pub fn set_areas(&mut self, fine_mm2: &[f32]) {
        self.fine_mm2 = fine_mm2.to_vec();
        let energy: Vec<f64> = fine_mm2.iter().map(|&area| f64::from(area)).collect();
        self.areas_mm2 = self.gathered(&energy).iter().map(|&area| area as f32).collect();
    }

    /// What those coarse texels take, by fine texels, that are not in the middle of four whole squares or take from elsewhere, too; it
    /// sums to 1 for each.
    pub fn rows(&self) -> Rows {
        let size = self.size;
        let mut all: Vec<(u32, u32, f32)> =
            self.rest.iter().map(|&(fine, to, weight)| (to, fine, weight)).collect();
        let mut takes_more = vec![false; size * size];
        all.iter().for_each(|(to, ..)| takes_more[*to as usize] = true);
        let whole =
            |texel: usize, back: usize| texel.checked_sub(back).is_some_and(|first| self.whole[first]);
        let is_inner = |texel: usize| {
            !takes_more[texel] && [0, 1, size, size + 1].iter().all(|&back| whole(texel, back))
        };
        for first in (0..self.whole.len()).filter(|&first| self.whole[first]) {
            for (k, to) in corners(first, size).into_iter().enumerate() {
                if !is_inner(to) {
                    let under = self.under(first).into_iter().enumerate();
                    all.extend(under.map(|(i, fine)| (to as u32, fine as u32, part(i, k))));
                }
            }
        }
        for (to, fine, weight) in &mut all {
            let energy = f64::from(*weight * self.fine_mm2[*fine as usize]);
            *weight = by_area(energy, self.areas_mm2[*to as usize]) as f32;
        }
        let is_bare = |to: u32| self.areas_mm2[to as usize] <= 0.0;
        all.extend(
            self.bare.iter().map(|&(to, fine, part)| (to, fine, if is_bare(to) { part } else { 0.0 })),
        );
        Rows::new(all)
    }

    /// The light of coarse texels: what they get, by their area.
    pub fn halved<L: Light>(&self, light: &[L]) -> Vec<L> {
        let energy: Vec<L> =
            light.par_iter().zip(&self.fine_mm2).map(|(&light, &area)| light.times(area)).collect();
        let mut coarse = self.gathered(&energy);
        coarse.par_iter_mut().zip(&self.areas_mm2).for_each(|(light, &area)| *light = by_area(*light, area));
        for &(to, fine, part) in self.still_bare() {
            coarse[to as usize] = coarse[to as usize] + light[fine as usize].times(part);
        }
        coarse
    }

    /// The transpose of [`Self::halved`].
    pub fn transposed<L: Light>(&self, coarse: &[L]) -> Vec<L> {
        let given: Vec<L> =
            coarse.iter().zip(&self.areas_mm2).map(|(&light, &area)| by_area(light, area)).collect();
        let fine_size = 2 * self.size;
        let mut fine = vec![L::default(); fine_size * fine_size];
        for first in (0..self.whole.len()).filter(|&first| self.whole[first]) {
            let around = corners(first, self.size);
            for (i, texel) in self.under(first).into_iter().enumerate() {
                let sum = (0..4).fold(L::default(), |sum, k| sum + given[around[k]].times(part(i, k)));
                fine[texel] = fine[texel] + sum;
            }
        }
        for &(texel, from, weight) in &self.rest {
            fine[texel as usize] = fine[texel as usize] + given[from as usize].times(weight);
        }
        let mut fine: Vec<L> =
            fine.iter().zip(&self.fine_mm2).map(|(&light, &area)| light.times(area)).collect();
        for &(from, texel, part) in self.still_bare() {
            fine[texel as usize] = fine[texel as usize] + coarse[from as usize].times(part);
        }
        fine
    }

    /// Those that have no area in this pose, either.
    fn still_bare(&self) -> impl Iterator<Item = &(u32, u32, f32)> {
        self.bare.iter().filter(|(to, ..)| self.areas_mm2[*to as usize] <= 0.0)
    }

    fn gathered<L: Light>(&self, energy: &[L]) -> Vec<L> {
        let size = self.size;
        let of = |texel: usize| {
            let squares = [(0, 0), (1, 1), (size, 2), (size + 1, 3)];
            squares.into_iter().fold(L::default(), |sum, (back, corner)| match texel.checked_sub(back) {
                Some(first) if self.whole[first] => {
                    let under = self.under(first);
                    (0..4).fold(sum, |sum, i| sum + energy[under[i]].times(part(i, corner)))
                }
                _ => sum,
            })
        };
        let mut coarse: Vec<L> = (0..size * size).into_par_iter().map(of).collect();
        for &(texel, to, weight) in &self.rest {
            coarse[to as usize] = coarse[to as usize] + energy[texel as usize].times(weight);
        }
        coarse
    }

    /// The fine texels in a coarse square.
    fn under(&self, first: usize) -> [usize; 4] {
        let (x, y) = (first % self.size, first / self.size);
        corners((2 * y + 1) * 2 * self.size + 2 * x + 1, 2 * self.size)
    }
}

/// Part of fine texel `i` of a square that goes to its corner `k`.
fn part(i: usize, k: usize) -> f32 {
    let differing = i ^ k;
    PARTS[differing & 1] * PARTS[differing >> 1]
}

fn by_area<L: Light>(light: L, area_mm2: f32) -> L {
    if area_mm2 > 0.0 { light.times(area_mm2.recip()) } else { L::default() }
}
