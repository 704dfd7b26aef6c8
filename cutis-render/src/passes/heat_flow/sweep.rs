//! Two polynomials in one sweep over the maps, which are larger than any cache: the second follows one row of texels behind the
//! first, while that is still at hand.
//!
//! Threads take bands of rows. What a band needs of its neighbours is the first polynomial in the rows along its ends; those
//! rows are made before the sweep, so that bands may overwrite what they have read: two maps suffice for all polynomials.
//! What flows at edges of charts reaches far, but depends on one polynomial alone: that of the first is known before the sweep,
//! and of the second it is added afterwards.

use super::exchange::Exchange;
use super::row::Light;
use super::stencil::{Recurrence, turn};
use rayon::prelude::*;

/// Rows of texels in a band: two of them are read twice.
const BAND_ROWS: usize = 64;

/// What of a sweep goes to a sum.
pub struct Part<'a, L> {
    /// How much of both polynomials there are.
    pub factors: [f32; 2],
    /// The sum.
    pub map: &'a mut [L],
}

/// The polynomials, of which there are two at a time.
pub struct Sweeper<'a, L> {
    exchange: &'a Exchange,
    now: Vec<L>,
    before: Vec<L>,
    /// What flows to the texels of the exchange's rows.
    flows: Vec<L>,
    /// Next polynomial in the last row of every band and in the first of the one after it.
    ends: Vec<L>,
}

/// What a thread takes at a time.
struct Band<'a, L> {
    first: usize,
    /// T_k, which becomes T_{k+2}.
    now: &'a mut [L],
    /// T_{k-1}, which becomes T_{k+1}.
    before: &'a mut [L],
    /// T_{k+1} at both ends.
    ends: [Option<&'a [L]>; 2],
    parts: Vec<Part<'a, L>>,
}

/// What a sweep does.
#[derive(Clone, Copy)]
struct Plan {
    begins: bool,
    /// Polynomials that are left, T_k among them.
    left: usize,
    recurrence: Recurrence,
}

impl<'a, L: Light> Sweeper<'a, L> {
    /// Beginning with light, in two maps.
    pub fn new(exchange: &'a Exchange, now: Vec<L>, before: Vec<L>) -> Self {
        let rows = exchange.size.div_ceil(BAND_ROWS).saturating_sub(1) * 2;
        let ends = vec![L::default(); rows * exchange.size];
        Self { exchange, now, before, flows: Vec::new(), ends }
    }

    /// With T_k there are, and T_{k-1} before: adds T_k and T_{k+1} to the sums, and goes on to T_{k+1} and T_{k+2}. No further than
    /// to the last of those that are `left`, with T_k. The first sweep begins the sums.
    pub fn sweep(&mut self, begins: bool, left: usize, parts: Vec<Part<L>>) {
        let recurrence = if begins { Recurrence::FIRST } else { Recurrence::LATER };
        let plan = Plan { begins, left, recurrence };
        if left > 1 {
            flow_at_edges(self.exchange, &self.now, &mut self.flows);
            self.turn_ends(recurrence);
        }
        let (exchange, flows) = (self.exchange, self.flows.as_slice());
        let mut bands = bands(exchange.size, &mut self.now, &mut self.before, &self.ends, parts);
        bands.par_iter_mut().for_each(|band| band.sweep(exchange, flows, plan));
        if left > 2 {
            flow_at_edges(self.exchange, &self.before, &mut self.flows);
            let (exchange, flows) = (self.exchange, self.flows.as_slice());
            let rows = self.now.par_chunks_mut(exchange.size).enumerate();
            rows.for_each(|(y, row)| add_edges(exchange, flows, Recurrence::LATER, y, row));
        }
    }

    fn turn_ends(&mut self, recurrence: Recurrence) {
        let Self { exchange, now, before, flows, ends } = self;
        let size = exchange.size;
        ends.par_chunks_mut(size).enumerate().for_each(|(n, row)| {
            let y = (n / 2 + 1) * BAND_ROWS - 1 + n % 2;
            row.copy_from_slice(&before[y * size..][..size]);
            let rows = [y - 1, y, y + 1].map(|y| now.get(y * size..(y + 1) * size).unwrap_or_default());
            turn(exchange, recurrence, y, rows, row);
            add_edges(exchange, flows, recurrence, y, row);
        });
    }
}

impl<L: Light> Band<'_, L> {
    fn sweep(&mut self, exchange: &Exchange, flows: &[L], plan: Plan) {
        let size = exchange.size;
        let count = self.now.len() / size;
        for row in 0..count {
            if plan.left > 1 {
                self.turn_first(exchange, flows, plan.recurrence, row);
            }
            self.add(exchange, plan.begins, row);
            if plan.left > 2 && row > 0 {
                self.turn_second(exchange, row - 1);
            }
        }
        if plan.left > 2 {
            self.turn_second(exchange, count - 1);
        }
    }

    /// To T_{k+1}.
    fn turn_first(&mut self, exchange: &Exchange, flows: &[L], recurrence: Recurrence, row: usize) {
        let size = exchange.size;
        let here = &mut self.before[row * size..(row + 1) * size];
        match self.ends {
            [Some(end), _] if row == 0 => here.copy_from_slice(&end[size..]),
            [_, Some(end)] if (row + 1) * size == self.now.len() => here.copy_from_slice(&end[..size]),
            _ => {
                let of = |row: Option<usize>| row.and_then(|row| self.now.get(row * size..(row + 1) * size));
                let rows =
                    [row.checked_sub(1), Some(row), Some(row + 1)].map(|row| of(row).unwrap_or_default());
                turn(exchange, recurrence, self.first + row, rows, here);
                add_edges(exchange, flows, recurrence, self.first + row, here);
            }
        }
    }

    /// To T_{k+2}, but for what flows at edges.
    fn turn_second(&mut self, exchange: &Exchange, row: usize) {
        let size = exchange.size;
        let of = |row: usize| self.before.get(row * size..(row + 1) * size);
        let under = row.checked_sub(1).map_or(self.ends[0].map(|end| &end[..size]), of);
        let above = of(row + 1).or(self.ends[1].map(|end| &end[size..]));
        let rows = [under, of(row), above].map(Option::unwrap_or_default);
        let here = &mut self.now[row * size..(row + 1) * size];
        turn(exchange, Recurrence::LATER, self.first + row, rows, here);
    }

    /// Both polynomials to the sums.
    fn add(&mut self, exchange: &Exchange, begins: bool, row: usize) {
        let start = row * exchange.size;
        for Part { factors: [a, b], map } in &mut self.parts {
            for run in &exchange.runs[self.first + row] {
                let run = start + run.start..start + run.end;
                let both = self.now[run.clone()].iter().zip(&self.before[run.clone()]);
                for (sum, (&now, &next)) in map[run].iter_mut().zip(both) {
                    let more = now.times(*a) + next.times(*b);
                    *sum = if begins { more } else { *sum + more };
                }
            }
        }
    }
}

fn bands<'a, L: Light>(
    size: usize,
    now: &'a mut [L],
    before: &'a mut [L],
    ends: &'a [L],
    parts: Vec<Part<'a, L>>,
) -> Vec<Band<'a, L>> {
    let end = |n: usize| ends.get(n * 2 * size..(n + 1) * 2 * size);
    let maps = now.chunks_mut(BAND_ROWS * size).zip(before.chunks_mut(BAND_ROWS * size));
    let mut bands: Vec<Band<L>> = maps
        .enumerate()
        .map(|(n, (now, before))| {
            let ends = [n.checked_sub(1).and_then(end), end(n)];
            Band { first: n * BAND_ROWS, now, before, ends, parts: Vec::with_capacity(parts.len()) }
        })
        .collect();
    for Part { factors, map } in parts {
        let maps = map.chunks_mut(BAND_ROWS * size);
        bands.iter_mut().zip(maps).for_each(|(band, map)| band.parts.push(Part { factors, map }));
    }
    bands
}

/// What flows at the edges of charts.
fn flow_at_edges<L: Light>(exchange: &Exchange, light: &[L], flows: &mut Vec<L>) {
    let rows = &exchange.rows;
    let of = |(&texel, ends): (&u32, &[u32])| {
        let own = light[texel as usize];
        let links = rows.links[ends[0] as usize..ends[1] as usize].iter();
        links.fold(L::default(), |sum, &(other, link)| sum + (light[other as usize] - own).times(link))
    };
    let texels = rows.texels.par_iter().zip(rows.starts.par_windows(2)).with_min_len(256);
    texels.map(of).collect_into_vec(flows);
}

/// Adds that to a row of the next polynomial.
fn add_edges<L: Light>(exchange: &Exchange, flows: &[L], recurrence: Recurrence, y: usize, row: &mut [L]) {
    let (size, texels) = (exchange.size, &exchange.rows.texels);
    let begin = |y: usize| texels.partition_point(|&texel| (texel as usize) < y * size);
    let (here, speed) = (begin(y)..begin(y + 1), recurrence.speed(exchange));
    for (&texel, flow) in texels[here.clone()].iter().zip(&flows[here]) {
        let x = texel as usize - y * size;
        row[x] = row[x] + flow.times(exchange.inverse_areas_per_mm2[texel as usize]).times(speed);
    }
}
