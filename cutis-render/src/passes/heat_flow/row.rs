//! The row of polynomials: every one from the two before it, by one exchange.

use super::exchange::Exchange;
use glam::Vec4;
use rayon::prelude::*;
use std::ops::{Add, Sub};

/// What flows.
pub trait Light: Copy + Default + Send + Sync + Add<Output = Self> + Sub<Output = Self> {
    /// So many times as much.
    fn times(self, factor: f32) -> Self;
    /// The inverse of [`Self::times`].
    fn over(self, factor: f32) -> Self;
}

impl Light for Vec4 {
    fn times(self, factor: f32) -> Self {
        self * factor
    }
    fn over(self, factor: f32) -> Self {
        self / factor
    }
}

impl Light for f64 {
    fn times(self, factor: f32) -> Self {
        self * Self::from(factor)
    }
    fn over(self, factor: f32) -> Self {
        self / Self::from(factor)
    }
}

/// Light after every time, by the coefficients of each.
pub fn flown<L: Light>(exchange: &Exchange, times: &[Vec<f32>], light: &[L]) -> Vec<Vec<L>> {
    let mut sums: Vec<Vec<L>> = times.iter().map(|_| light.to_vec()).collect();
    let most = times.iter().map(Vec::len).max().unwrap_or(0);
    let (mut now, mut before) = (light.to_vec(), light.to_vec());
    for k in 0..most {
        let parts: Vec<f32> = times.iter().map(|c| c.get(k).copied().unwrap_or(0.0)).collect();
        // T_1 = x T_0, and after that T_{k+1} = 2 x T_k - T_{k-1}, with x = 1 - 2 L/λ.
        let next = (k + 1 < most).then_some(if k == 0 { (1.0, 0.0) } else { (2.0, 1.0) });
        step(exchange, &now, &mut before, k == 0, next, &mut sums, &parts);
        std::mem::swap(&mut now, &mut before);
    }
    sums
}

/// A row of texels of the polynomial before and of the sums, with the part that is added to each.
struct Row<'a, L> {
    before: &'a mut [L],
    sums: Vec<(f32, &'a mut [L])>,
}

/// Adds `parts` of what there is now to the sums, or begins them, and turns the polynomial before it into the next: a `factor`
/// times x of this one less a `part` of that.
fn step<L: Light>(
    exchange: &Exchange,
    now: &[L],
    before: &mut [L],
    begins: bool,
    next: Option<(f32, f32)>,
    sums: &mut [Vec<L>],
    parts: &[f32],
) {
    let size = exchange.size;
    let speed = 2.0 / exchange.fastest_rate_per_mm2;
    let mut rows: Vec<Row<L>> =
        before.chunks_mut(size).map(|before| Row { before, sums: Vec::with_capacity(parts.len()) }).collect();
    for (sum, &part) in sums.iter_mut().zip(parts).filter(|(_, part)| begins || **part != 0.0) {
        rows.iter_mut().zip(sum.chunks_mut(size)).for_each(|(row, sum)| row.sums.push((part, sum)));
    }
    rows.par_iter_mut().enumerate().for_each(|(y, Row { before: row, sums })| {
        let here = &now[y * size..(y + 1) * size];
        for run in &exchange.runs[y] {
            for (part, sum) in sums.iter_mut() {
                for (sum, &light) in sum[run.clone()].iter_mut().zip(&here[run.clone()]) {
                    let more = light.times(*part);
                    *sum = if begins { more } else { *sum + more };
                }
            }
            let Some((factor, part)) = next else { continue };
            for x in run.clone() {
                let i = y * size + x;
                // Inner squares link no texel along the edges of the map.
                let inner = y > 0 && y + 1 < size && x > 0 && x + 1 < size;
                let flow = if inner { flow(exchange, now, i) } else { L::default() };
                let moved = here[x] + flow.times(exchange.inverse_areas_per_mm2[i]).times(speed);
                row[x] = moved.times(factor) - row[x].times(part);
            }
        }
    });
    if let Some((factor, _)) = next {
        add_rows(exchange, now, before, speed, factor);
    }
}

/// What flows to a texel from its eight neighbours.
#[inline]
fn flow<L: Light>(exchange: &Exchange, light: &[L], i: usize) -> L {
    let (size, own) = (exchange.size, light[i]);
    let (here, below) = (&exchange.links[i - 1..=i], &exchange.links[i - size - 1..i - size + 2]);
    let beside = (light[i + 1] - own).times(here[1][0]) + (light[i - 1] - own).times(here[0][0]);
    let above = (light[i + size] - own).times(here[1][1])
        + (light[i + size + 1] - own).times(here[1][2])
        + (light[i + size - 1] - own).times(here[1][3]);
    let under = (light[i - size] - own).times(below[1][1])
        + (light[i - size - 1] - own).times(below[0][2])
        + (light[i - size + 1] - own).times(below[2][3]);
    beside + above + under
}

/// What flows at the edges of charts.
fn add_rows<L: Light>(exchange: &Exchange, now: &[L], next: &mut [L], speed: f32, factor: f32) {
    let rows = &exchange.rows;
    let added: Vec<L> = rows
        .texels
        .par_iter()
        .zip(rows.starts.par_windows(2))
        .with_min_len(256)
        .map(|(&texel, ends)| {
            let own = now[texel as usize];
            let links = rows.links[ends[0] as usize..ends[1] as usize].iter();
            links.fold(L::default(), |sum, &(other, link)| sum + (now[other as usize] - own).times(link))
        })
        .collect();
    for (&texel, flow) in rows.texels.iter().zip(added) {
        let flow = flow.times(exchange.inverse_areas_per_mm2[texel as usize]).times(speed).times(factor);
        next[texel as usize] = next[texel as usize] + flow;
    }
}
