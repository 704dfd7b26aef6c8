//! One blur step along one axis of the texture, its width corrected by the local stretch
//! (d'Eon, Luebke & Enderton 2007, section 5.1 and 5.4).
//!
//! Irradiance, thickness and stretch are blurred together: every texel reads the same taps from all of them. No tap
//! leaves the texel's own chart: towards a seam the spacing shrinks with the distance to it, down to nothing.
//!
//! Placing and weighing taps costs more than reading them. Where the stretch hardly varies, which is nearly everywhere,
//! [`block`] does it once for neighbouring texels; elsewhere [`texel`] does it for each.

mod block;
mod texel;

use crate::passes::atlas::ChartMap;
use crate::passes::tap::{TAPS, Taps};
use block::{BLOCK, Block};
use glam::{Vec2, Vec4};
use rayon::prelude::*;
use std::ops::{Add, Mul};
use std::sync::Arc;
use texel::Reads;

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
        Self::new(zeros(&self.layers), vec![Vec2::ZERO; self.stretch_mm.len()])
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
    layers.iter().map(|layer| vec![Vec4::ZERO; layer.len()]).collect()
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
            return Spread::Cubic(cubic.min((room - 1.0) / 3.0));
        }
        Spread::Linear(taps.spacing(variance).min(room / 3.0))
    }
}

/// How seven taps are laid out.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Spread {
    /// On neighbouring texels, with these weights: the Gaussian integrated over each texel.
    Cells([f32; 4]),
    /// This many texels apart, read by cubic interpolation.
    Cubic(f32),
    /// This many texels apart, read by linear interpolation.
    Linear(f32),
}

impl Spread {
    /// Distance of the farthest texel that is read, texels.
    #[inline]
    fn farthest_texel(self) -> usize {
        match self {
            Self::Cells(_) => 3,
            Self::Cubic(spacing) => (3.0 * spacing) as usize + 2,
            Self::Linear(spacing) => (3.0 * spacing) as usize + 1,
        }
    }
}

/// Below this variance in texel² light has hardly left its texel (1.2 % of it at the limit): the texels count as raw,
/// and the Gaussian is integrated over them exactly.
const RAW_TEXEL2: f32 = 0.06;
/// Spacing in texels below which taps are read by cubic interpolation. Light that was spread just enough for the taps
/// still has detail of a few texels, which linear reads wash out unevenly (up to 4 % error in the measured profiles).
const CUBIC_SPACING: f32 = 4.0;
/// Variance in texel² from which on linear reads are good enough at any spacing.
const CUBIC_TEXEL2: f32 = 3.0;

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
    let blur = Blur::<V> { taps: &TAPS, charts, widening, source };
    rows.into_par_iter().zip(stretch_mm.par_chunks_mut(size)).enumerate().for_each(
        |(y, (mut layers, stretch))| {
            let mut x = 0;
            while x < size {
                x += blur.some_texels(y * size, x, &mut layers, stretch);
            }
        },
    );
    target.stretch_mm = stretch_mm;
}

/// One blur along one axis: everything it reads.
struct Blur<'a, const V: bool> {
    taps: &'a Taps,
    charts: &'a ChartMap,
    widening: Widening,
    source: &'a Fields,
}

impl<const V: bool> Blur<'_, V> {
    /// Blurs a block of texels of a row from `x` on if one set of taps will do for all, else one texel; returns how
    /// many it blurred. `row` is the number of the row's first texel.
    #[inline(always)]
    fn some_texels(&self, row: usize, x: usize, layers: &mut [&mut [Vec4]], stretch: &mut [Vec2]) -> usize {
        let (texel, source) = (row + x, self.source);
        if x + BLOCK <= self.charts.size
            && let Some(block) =
                Block::at::<V>(self.taps, self.charts, self.widening, &source.stretch_mm, texel)
        {
            for (to, from) in layers.iter_mut().zip(source.layers.iter()) {
                to[x..x + BLOCK].copy_from_slice(&block.gather(from, texel));
            }
            stretch[x..x + BLOCK].copy_from_slice(&block.gather_stretch(&source.stretch_mm, texel));
            return BLOCK;
        }
        let reads = Reads::at::<V>(self.taps, self.charts, self.widening, &source.stretch_mm, texel);
        for (to, from) in layers.iter_mut().zip(source.layers.iter()) {
            to[x] = reads.gather(from, texel);
        }
        stretch[x] = reads.gather_stretch(&source.stretch_mm, texel);
        1
    }
}

/// What can be blurred: weighted sums of it exist.
trait Field: Copy + Add<Output = Self> + Mul<f32, Output = Self> {}

impl<T: Copy + Add<Output = T> + Mul<f32, Output = T>> Field for T {}

/// Weights of cubic interpolation through four neighbours (Catmull & Rom 1974), exact for parabolas.
#[inline(always)]
pub(super) fn catmull_rom(f: f32) -> [f32; 4] {
    let (f2, f3) = (f * f, f * f * f);
    [-0.5 * f + f2 - 0.5 * f3, 1.0 - 2.5 * f2 + 1.5 * f3, 0.5 * f + 2.0 * f2 - 1.5 * f3, -0.5 * f2 + 0.5 * f3]
}
