//! One blur step along one axis of the texture, its width corrected by the local stretch
//! (d'Eon, Luebke & Enderton 2007, section 5.1 and 5.4).
//!
//! Irradiance, thickness and stretch are blurred together: every texel reads the same taps from all of them. No tap
//! leaves the texel's own chart: towards a seam the spacing shrinks with the distance to it, down to nothing.
//!
//! Placing and weighing taps costs more than reading them. Where the stretch hardly varies, which is nearly everywhere,
//! it is done for the first and the last of up to 32 neighbours, elsewhere for each texel ([`lines`]).

mod bundle;
mod lines;
mod reads;

use crate::passes::atlas::ChartMap;
use crate::passes::tap::Taps;
use bundle::{BLOCK, Block};
use glam::{Vec2, Vec4};
use lines::Lines;
use rayon::prelude::*;
use reads::Reads;
use std::ops::Range;
use std::sync::Arc;
use wide::f32x8;

/// What is blurred: any number of four-channel layers, and the stretch that rules the width.
#[derive(Debug, Clone)]
pub struct Fields {
    /// Irradiance with thickness in alpha, then further thicknesses. Shared with whoever keeps them as they are.
    pub layers: Arc<Vec<Vec<Vec4>>>,
    /// Millimetres per texel along u and v.
    pub stretch_mm: Vec<Vec2>,
}

impl Fields {
    /// Fields to be blurred.
    pub fn new(layers: Vec<Vec<Vec4>>, stretch_mm: Vec<Vec2>) -> Self {
        Self { layers: Arc::new(layers), stretch_mm }
    }

    /// Zeros in the same shape.
    pub fn zeros_like(&self) -> Self {
        Self::new(zeros(&self.layers), bytemuck::zeroed_vec(self.stretch_mm.len()))
    }

    /// The layers, to be written all over: new ones if somebody keeps the old.
    fn layers_to_fill(&mut self) -> &mut Vec<Vec<Vec4>> {
        if Arc::get_mut(&mut self.layers).is_none() {
            self.layers = Arc::new(zeros(&self.layers));
        }
        Arc::get_mut(&mut self.layers).expect("nobody else holds layers that were just made")
    }
}

fn zeros(layers: &[Vec<Vec4>]) -> Vec<Vec<Vec4>> {
    // Asks the system for memory that is zero already: pages come into being where they are first written to, by all
    // threads.
    layers.iter().map(|layer| bytemuck::zeroed_vec(layer.len())).collect()
}

/// Axis of a blur.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// Along the rows of the texture.
    U,
    /// Along its columns.
    V,
}

/// How much one step widens what is there, as a variance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Widening {
    /// Variance reached before the step, mm².
    pub from_mm2: f32,
    /// Variance reached after it, mm².
    pub to_mm2: f32,
    /// Variance in texel² that other means have added or will add, and that the step leaves out.
    pub saved_texel2: f32,
}

impl Widening {
    /// The taps that do it where a texel is `texel_mm` wide and nothing farther than `room` texels may be read.
    #[inline]
    fn taps(self, taps: &Taps, texel_mm: f32, room: f32) -> Spread {
        let per_mm2 = 1.0 / (texel_mm * texel_mm);
        let (from, to) = (self.from_mm2 * per_mm2, self.to_mm2 * per_mm2);
        if from < RAW_TEXEL2 && to < taps.widest_cells() && room >= 3.0 {
            return Spread::Cells(taps.cells(to));
        }
        let variance = taps.discrete_variance(to) - taps.discrete_variance(from) - self.saved_texel2;
        // A cubic read has no variance of its own, a linear one has; see `Taps`.
        let cubic = taps.cubic_spacing(variance);
        if cubic < CUBIC_SPACING && from < CUBIC_TEXEL2 {
            return Spread::Spaced { spacing: cubic.min((room - 1.0) / 3.0), cubic: true };
        }
        Spread::Spaced { spacing: taps.spacing(variance).min(room / 3.0), cubic: false }
    }
}

/// How seven taps are laid out.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Spread {
    /// On neighbouring texels, with these weights: the Gaussian integrated over each texel.
    Cells([f32; 4]),
    /// This many texels apart, interpolated cubically or linearly.
    Spaced { spacing: f32, cubic: bool },
}

/// Below this variance in texel² light has hardly left its texel (1.2 % of it at the limit): the texels count as raw,
/// and the Gaussian is integrated over them exactly.
const RAW_TEXEL2: f32 = 0.06;
/// Spacing in texels below which taps are read by cubic interpolation. Light that was spread just enough for the taps
/// still has detail of a few texels, which linear reads wash out unevenly (up to 4 % error in the measured profiles).
const CUBIC_SPACING: f32 = 4.0;
/// Variance in texel² from which on linear reads are good enough at any spacing.
const CUBIC_TEXEL2: f32 = 3.0;

/// Texels that share the taps of two at most.
const LARGEST_BLOCK: usize = 4 * BLOCK;

/// Blurs `source` along an axis into `target`.
pub fn blur(charts: &ChartMap, axis: Axis, widening: Widening, source: &Fields, target: &mut Fields) {
    match axis {
        Axis::U => blur_along::<false>(charts, widening, source, target),
        Axis::V => blur_along::<true>(charts, widening, source, target),
    }
}

/// The same with the axis known to the compiler: along v if `V`, else along u.
fn blur_along<const V: bool>(charts: &ChartMap, widening: Widening, source: &Fields, target: &mut Fields) {
    let size = charts.size;
    let mut stretch_mm = std::mem::take(&mut target.stretch_mm);
    let mut rows: Vec<Vec<&mut [Vec4]>> = (0..size).map(|_| Vec::new()).collect();
    for layer in target.layers_to_fill() {
        for (row, slice) in rows.iter_mut().zip(layer.chunks_mut(size)) {
            row.push(slice);
        }
    }
    let lines = Lines::<V> { charts, widening, stretch_mm: &source.stretch_mm };
    rows.into_par_iter().zip(stretch_mm.par_chunks_mut(size)).enumerate().for_each(
        |(y, (mut layers, stretch))| {
            let mut row = Row { first: y * size, layers: &mut layers, stretch };
            for x in (0..size).step_by(LARGEST_BLOCK) {
                row.fill(&lines, source, x..(x + LARGEST_BLOCK).min(size));
            }
        },
    );
    target.stretch_mm = stretch_mm;
}

/// One row of everything that is blurred.
struct Row<'a, 'b> {
    /// The row's first texel.
    first: usize,
    layers: &'a mut [&'b mut [Vec4]],
    stretch: &'a mut [Vec2],
}

impl Row<'_, '_> {
    /// Fills some neighbours: mixing what the first and the last would read if that will do, else in halves, and at
    /// last each with its own.
    fn fill<const V: bool>(&mut self, lines: &Lines<V>, source: &Fields, xs: Range<usize>) {
        if xs.len().is_multiple_of(BLOCK) {
            if let Some(ends) = lines.of_block(self.first + xs.start, xs.len()) {
                self.fill_block(&ends, source, xs);
                return;
            }
            if xs.len() > BLOCK {
                let middle = xs.start + (xs.len() / 2).next_multiple_of(BLOCK);
                self.fill(lines, source, xs.start..middle);
                self.fill(lines, source, middle..xs.end);
                return;
            }
        }
        for x in xs {
            let texel = self.first + x;
            let reads = lines.of_texel(texel);
            for (to, from) in self.layers.iter_mut().zip(source.layers.iter()) {
                to[x] = reads.gather(from, texel);
            }
            self.stretch[x] = reads.gather_stretch(&source.stretch_mm, texel);
        }
    }

    #[inline(always)]
    fn fill_block(&mut self, (start, end): &(Reads, Option<Reads>), source: &Fields, xs: Range<usize>) {
        let texel = self.first + xs.start;
        let end = end.as_ref();
        for (to, from) in self.layers.iter_mut().zip(source.layers.iter()) {
            mix_ends(&mut to[xs.clone()], texel, start, end, |reads, t| reads.gather::<[f32x8; 4]>(from, t));
        }
        mix_ends(&mut self.stretch[xs], texel, start, end, |reads, t| {
            reads.gather_stretch::<[f32x8; 2]>(&source.stretch_mm, t)
        });
    }
}

/// Fills `to` with what the taps of the first texel give, passing over evenly into what those of the last give.
#[inline(always)]
fn mix_ends<B: Block>(
    to: &mut [B::Texel],
    first: usize,
    start: &Reads,
    end: Option<&Reads>,
    gather: impl Fn(&Reads, usize) -> B,
) {
    let step = 1.0 / (to.len() - 1) as f32;
    for (i, to) in to.chunks_exact_mut(BLOCK).enumerate() {
        let mut sum = gather(start, first + i * BLOCK);
        if let Some(end) = end {
            sum = sum.mixed(gather(end, first + i * BLOCK), (i * BLOCK) as f32 * step, step);
        }
        sum.store(to);
    }
}
