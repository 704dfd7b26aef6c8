//! Which chart every texel of a map belongs to, and reads that stay in one.

use super::NO_CHART;
use glam::Vec2;
use rayon::prelude::*;
use std::ops::{Add, Mul};

/// Which chart every texel of a square map belongs to.
#[derive(Debug, Clone)]
pub struct ChartMap {
    /// Width and height in texels.
    pub size: usize,
    /// Chart of each texel, or [`NO_CHART`].
    pub chart: Vec<u32>,
    /// Along u: texels of the same chart on both sides without a gap, the smaller of the two.
    pub reach_u: Vec<u16>,
    /// The same along v.
    pub reach_v: Vec<u16>,
}

impl ChartMap {
    /// Measures how far every texel is from the edge of its chart.
    pub fn new(size: usize, chart: Vec<u32>) -> Self {
        let (reach_u, reach_v) =
            rayon::join(|| reach_along_rows(&chart, size), || reach_along_columns(&chart, size));
        Self { size, chart, reach_u, reach_v }
    }

    /// The map at half the size. A coarse texel belongs to the chart that most of its four texels belong to, and of
    /// several the one with the lowest number.
    pub fn halved(&self) -> Self {
        let half = self.size / 2;
        let chart = (0..half * half)
            .into_par_iter()
            .map(|i| most_common(self.children(i % half, i / half).map(|child| self.chart[child])))
            .collect();
        Self::new(half, chart)
    }

    /// The four texels under a texel of the halved map.
    pub fn children(&self, x: usize, y: usize) -> [usize; 4] {
        let first = 2 * y * self.size + 2 * x;
        [first, first + 1, first + self.size, first + self.size + 1]
    }

    /// The four texels around `uv`, and their weights in a bilinear read.
    pub fn around(&self, uv: Vec2) -> [(usize, f32); 4] {
        let p = uv * self.size as f32 - 0.5;
        let floor = p.floor();
        let f = p - floor;
        let last = self.size as i32 - 1;
        let column = [floor.x as i32, (floor.x as i32).saturating_add(1)].map(|x| x.clamp(0, last) as usize);
        let row = [floor.y as i32, (floor.y as i32).saturating_add(1)]
            .map(|y| y.clamp(0, last) as usize * self.size);
        [
            (row[0] + column[0], (1.0 - f.x) * (1.0 - f.y)),
            (row[0] + column[1], f.x * (1.0 - f.y)),
            (row[1] + column[0], (1.0 - f.x) * f.y),
            (row[1] + column[1], f.x * f.y),
        ]
    }

    /// Bilinear read of `map` at `uv` from texels of one chart only. `None` if none of the four belongs to it.
    pub fn sample<T>(&self, map: &[T], uv: Vec2, chart: u32) -> Option<T>
    where
        T: Copy + Default + Add<Output = T> + Mul<f32, Output = T>,
    {
        let (mut sum, mut weight) = (T::default(), 0.0);
        for (texel, w) in self.around(uv) {
            if self.chart[texel] == chart {
                sum = sum + map[texel] * w;
                weight += w;
            }
        }
        // Below a thousandth the quotient would only magnify rounding.
        (weight > 1e-3).then(|| sum * weight.recip())
    }
}

/// For each texel: how many of the same chart follow it in its row without a gap on both sides, the smaller count.
fn reach_along_rows(chart: &[u32], size: usize) -> Vec<u16> {
    let mut reach = vec![0u16; chart.len()];
    reach.par_chunks_mut(size).zip(chart.par_chunks(size)).for_each(|(reach, line)| {
        for i in 1..size {
            reach[i] = if line[i] == line[i - 1] { reach[i - 1].saturating_add(1) } else { 0 };
        }
        let mut run = 0u16;
        reach[size - 1] = 0;
        for i in (0..size - 1).rev() {
            run = if line[i] == line[i + 1] { run.saturating_add(1) } else { 0 };
            reach[i] = reach[i].min(run);
        }
    });
    reach
}

/// The same for columns: row by row, each from the one above it, then from the one below.
fn reach_along_columns(chart: &[u32], size: usize) -> Vec<u16> {
    let row = |y: usize| &chart[y * size..(y + 1) * size];
    let mut reach = vec![0u16; chart.len()];
    for y in 1..size {
        let (done, rest) = reach.split_at_mut(y * size);
        let above = &done[(y - 1) * size..];
        for (((to, from), a), b) in rest[..size].iter_mut().zip(above).zip(row(y)).zip(row(y - 1)) {
            *to = if a == b { from.saturating_add(1) } else { 0 };
        }
    }
    let mut run = vec![0u16; size];
    reach[(size - 1) * size..].fill(0);
    for y in (0..size - 1).rev() {
        let line = reach[y * size..(y + 1) * size].iter_mut().zip(&mut run);
        for (((to, run), a), b) in line.zip(row(y)).zip(row(y + 1)) {
            *run = if a == b { run.saturating_add(1) } else { 0 };
            *to = (*to).min(*run);
        }
    }
    reach
}

fn most_common(charts: [u32; 4]) -> u32 {
    if charts == [charts[0]; 4] {
        return charts[0];
    }
    let count = |c: u32| charts.iter().filter(|&&other| other == c).count();
    let covered = charts.into_iter().filter(|&c| c != NO_CHART);
    covered.max_by_key(|&c| (count(c), std::cmp::Reverse(c))).unwrap_or(NO_CHART)
}
