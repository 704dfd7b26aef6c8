//! One blur step along one axis of the texture, its width corrected by the local stretch
//! (d'Eon, Luebke & Enderton 2007, section 5.1 and 5.4).
//!
//! Irradiance, thickness and stretch are blurred together: every texel reads the same taps from all of them. No tap
//! leaves the texel's own chart: towards a seam the spacing shrinks with the distance to it, down to nothing.

use crate::passes::atlas::{ChartMap, NO_CHART};
use crate::passes::tap::TAPS;
use glam::{Vec2, Vec4};
use rayon::prelude::*;

/// What is blurred: any number of four-channel layers, and the stretch that rules the width.
#[derive(Debug, Clone)]
pub struct Fields {
    /// Irradiance with thickness in alpha, then further thicknesses.
    pub layers: Vec<Vec<Vec4>>,
    /// Millimetres per texel along u and v.
    pub stretch_mm: Vec<Vec2>,
}

impl Fields {
    /// Fields of zeros with the same shape.
    pub fn zeros(layers: usize, texels: usize) -> Self {
        Self { layers: vec![vec![Vec4::ZERO; texels]; layers], stretch_mm: vec![Vec2::ZERO; texels] }
    }
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
    fn taps(self, texel_mm: f32, room: f32) -> Spread {
        let per_mm2 = 1.0 / (texel_mm * texel_mm);
        let (from, to) = (self.from_mm2 * per_mm2, self.to_mm2 * per_mm2);
        if from < RAW_TEXEL2 && to < TAPS.widest_cells() && room >= 3.0 {
            return Spread::Cells(TAPS.cells(to));
        }
        let variance = TAPS.discrete_variance(to) - TAPS.discrete_variance(from) - self.saved_texel2;
        // A cubic read has no variance of its own, a linear one has; see `TAPS`.
        let cubic = TAPS.cubic_spacing(variance);
        if cubic < CUBIC_SPACING {
            return Spread::Cubic(cubic.min((room - 1.0) / 3.0));
        }
        Spread::Linear(TAPS.spacing(variance).min(room / 3.0))
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

/// Below this variance in texel² light has hardly left its texel (1.2 % of it at the limit): the texels count as raw,
/// and the Gaussian is integrated over them exactly.
const RAW_TEXEL2: f32 = 0.06;
/// Spacing in texels below which taps are read by cubic interpolation. Light that was spread just enough for the taps
/// still has detail of a few texels, which linear reads wash out unevenly (up to 4 % error in the measured profiles).
const CUBIC_SPACING: f32 = 4.0;

/// Blurs `source` along an axis into `target`.
pub fn blur(charts: &ChartMap, axis: Axis, widening: Widening, source: &Fields, target: &mut Fields) {
    let size = charts.size;
    let Fields { layers, stretch_mm } = target;
    let mut rows: Vec<Vec<&mut [Vec4]>> = (0..size).map(|_| Vec::with_capacity(layers.len())).collect();
    for layer in layers {
        for (row, slice) in rows.iter_mut().zip(layer.chunks_mut(size)) {
            row.push(slice);
        }
    }
    rows.into_par_iter().zip(stretch_mm.par_chunks_mut(size)).enumerate().for_each(
        |(y, (mut layers, stretch))| {
            for x in 0..size {
                let texel = y * size + x;
                let reads = Reads::at(charts, axis, widening, &source.stretch_mm, texel);
                for (target, source) in layers.iter_mut().zip(&source.layers) {
                    target[x] = reads.gather(source, texel);
                }
                stretch[x] = reads.gather(&source.stretch_mm, texel);
            }
        },
    );
}

/// The texels one texel reads, relative to itself, and their weights.
enum Reads {
    /// Only itself.
    Own,
    /// Itself and three neighbours on either side.
    Cells { weights: [f32; 4], stride: usize },
    /// Three taps on the side of growing and of falling coordinates.
    Spaced { sides: [[Tap; 3]; 2], stride: usize, cubic: bool },
}

/// One tap: the texel before its place, in elements away from the centre, and the weights of the four around it.
#[derive(Clone, Copy)]
struct Tap {
    whole: usize,
    weights: [f32; 4],
}

/// The line of texels along which one texel is blurred.
struct Line<'a> {
    stretch_mm: &'a [Vec2],
    axis: Axis,
    texel: usize,
    /// Elements from one texel of the line to the next.
    stride: usize,
    /// Farthest place of a tap, texels.
    room: f32,
}

impl Line<'_> {
    #[inline]
    fn texel_mm(&self, texel: usize) -> f32 {
        match self.axis {
            Axis::U => self.stretch_mm[texel].x,
            Axis::V => self.stretch_mm[texel].y,
        }
    }

    /// The taps on one side, `spacing_mm` of surface apart: where the stretch varies, so does the distance in texels.
    /// Each step takes the stretch half a step ahead.
    #[inline]
    fn taps(&self, spacing: f32, spacing_mm: f32, forward: bool, cubic: bool) -> [Tap; 3] {
        let mut at = 0.0f32;
        let mut step = spacing;
        std::array::from_fn(|k| {
            let ahead = (at + 0.5 * step).min(self.room) as usize * self.stride;
            step = spacing_mm / self.texel_mm(if forward { self.texel + ahead } else { self.texel - ahead });
            at = (at + step).min(self.room);
            let whole = at as usize;
            let weights = if cubic { catmull_rom } else { linear }(at - whole as f32);
            Tap { whole: whole * self.stride, weights: weights.map(|w| w * TAPS.weights[k + 1]) }
        })
    }
}

/// Weights of linear interpolation between the two middle ones of four neighbours.
#[inline]
fn linear(f: f32) -> [f32; 4] {
    [0.0, 1.0 - f, f, 0.0]
}

/// Weights of cubic interpolation through four neighbours (Catmull & Rom 1974), exact for parabolas.
#[inline]
fn catmull_rom(f: f32) -> [f32; 4] {
    let (f2, f3) = (f * f, f * f * f);
    [-0.5 * f + f2 - 0.5 * f3, 1.0 - 2.5 * f2 + 1.5 * f3, 0.5 * f + 2.0 * f2 - 1.5 * f3, -0.5 * f2 + 0.5 * f3]
}

impl Reads {
    #[inline]
    fn at(charts: &ChartMap, axis: Axis, widening: Widening, stretch_mm: &[Vec2], texel: usize) -> Self {
        if charts.chart[texel] == NO_CHART {
            return Self::Own;
        }
        let (reach, stride) = match axis {
            Axis::U => (charts.reach_u[texel], 1),
            Axis::V => (charts.reach_v[texel], charts.size),
        };
        let reach = f32::from(reach);
        let line = Line { stretch_mm, axis, texel, stride, room: reach };
        let texel_mm = line.texel_mm(texel);
        match widening.taps(texel_mm, reach) {
            Spread::Cells(weights) => Self::Cells { weights, stride },
            // The last texel read must still be inside: one past the place of a linear tap, two past a cubic one.
            Spread::Cubic(spacing) => line.shortened(1.0).spaced(spacing, spacing * texel_mm, true),
            Spread::Linear(spacing) => line.spaced(spacing, spacing * texel_mm, false),
        }
    }

    #[inline]
    fn gather<T>(&self, map: &[T], texel: usize) -> T
    where
        T: Copy + std::ops::Add<Output = T> + std::ops::Mul<f32, Output = T>,
    {
        match self {
            Self::Own => map[texel],
            Self::Cells { weights, stride } => {
                let pair = |k: usize| (map[texel + k * stride] + map[texel - k * stride]) * weights[k];
                map[texel] * weights[0] + pair(1) + pair(2) + pair(3)
            }
            Self::Spaced { sides, stride, cubic } => {
                let mut sum = map[texel] * TAPS.weights[0];
                for [up, down] in std::array::from_fn::<_, 3, _>(|k| [&sides[0][k], &sides[1][k]]) {
                    let (u, d) = (texel + up.whole, texel - down.whole);
                    sum = sum + map[u] * up.weights[1] + map[u + stride] * up.weights[2];
                    sum = sum + map[d] * down.weights[1] + map[d - stride] * down.weights[2];
                    if *cubic {
                        sum = sum + map[u - stride] * up.weights[0] + map[u + 2 * stride] * up.weights[3];
                        sum = sum + map[d + stride] * down.weights[0] + map[d - 2 * stride] * down.weights[3];
                    }
                }
                sum
            }
        }
    }
}

impl Line<'_> {
    /// The same line with less room.
    #[inline]
    fn shortened(self, texels: f32) -> Self {
        Self { room: self.room - texels, ..self }
    }

    #[inline]
    fn spaced(mut self, spacing: f32, spacing_mm: f32, cubic: bool) -> Reads {
        // A place exactly at the end would make the next texel, outside, part of the read.
        self.room -= 1e-3;
        if spacing <= 0.0 || self.room <= 0.0 {
            return Reads::Own;
        }
        let side = |forward| self.taps(spacing, spacing_mm, forward, cubic);
        Reads::Spaced { sides: [side(true), side(false)], stride: self.stride, cubic }
    }
}
