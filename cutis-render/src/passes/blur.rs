//! One blur step along one axis of the texture, its width corrected by the local stretch
//! (d'Eon, Luebke & Enderton 2007, section 5.1 and 5.4).
//!
//! Irradiance, thickness and stretch are blurred together: every texel reads the same taps from all of them. No tap
//! leaves the texel's own chart: towards a seam the spacing shrinks with the distance to it, down to nothing.

use crate::passes::atlas::{ChartMap, NO_CHART};
use crate::passes::tap::{TAPS, Taps};
use glam::{Vec2, Vec4};
use rayon::prelude::*;
use std::ops::{Add, Mul};

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
    let Fields { layers, stretch_mm } = target;
    let mut rows: Vec<Vec<&mut [Vec4]>> = (0..size).map(|_| Vec::with_capacity(layers.len())).collect();
    for layer in layers {
        for (row, slice) in rows.iter_mut().zip(layer.chunks_mut(size)) {
            row.push(slice);
        }
    }
    let taps: &Taps = &TAPS;
    rows.into_par_iter().zip(stretch_mm.par_chunks_mut(size)).enumerate().for_each(
        |(y, (mut layers, stretch))| {
            for x in 0..size {
                let texel = y * size + x;
                match Reads::at::<V>(taps, charts, widening, &source.stretch_mm, texel) {
                    Reads::Own => {
                        layers.iter_mut().zip(&source.layers).for_each(|(to, from)| to[x] = from[texel]);
                        stretch[x] = source.stretch_mm[texel];
                    }
                    Reads::Cells(cells) => {
                        layers
                            .iter_mut()
                            .zip(&source.layers)
                            .for_each(|(to, from)| to[x] = cells.gather(from, texel));
                        stretch[x] = cells.gather(&source.stretch_mm, texel);
                    }
                    Reads::Linear(reads) => {
                        layers
                            .iter_mut()
                            .zip(&source.layers)
                            .for_each(|(to, from)| to[x] = reads.gather(from, texel));
                        stretch[x] = reads.gather_nearest(&source.stretch_mm, texel);
                    }
                    Reads::Cubic(reads) => {
                        layers
                            .iter_mut()
                            .zip(&source.layers)
                            .for_each(|(to, from)| to[x] = reads.gather(from, texel));
                        stretch[x] = reads.gather_nearest(&source.stretch_mm, texel);
                    }
                }
            }
        },
    );
}

/// What one texel reads.
enum Reads {
    /// Only itself.
    Own,
    /// Itself and three neighbours on either side.
    Cells(Cells),
    /// Six taps between two texels each, and itself.
    Linear(Spaced<2>),
    /// Six taps among four texels each, and itself.
    Cubic(Spaced<4>),
}

/// Itself and three neighbours on either side.
struct Cells {
    weights: [f32; 4],
    stride: usize,
}

/// Six taps, three on either side, each interpolated among `N` neighbouring texels.
struct Spaced<const N: usize> {
    centre_weight: f32,
    /// First of the texels of each tap; the others follow `stride` elements apart.
    first: [usize; 6],
    weights: [[f32; N]; 6],
    stride: usize,
}

impl Cells {
    #[inline(always)]
    fn gather<T>(&self, map: &[T], texel: usize) -> T
    where
        T: Copy + Add<Output = T> + Mul<f32, Output = T>,
    {
        let pair = |k: usize| (map[texel + k * self.stride] + map[texel - k * self.stride]) * self.weights[k];
        map[texel] * self.weights[0] + pair(1) + pair(2) + pair(3)
    }
}

impl<const N: usize> Spaced<N> {
    #[inline(always)]
    fn gather(&self, map: &[Vec4], texel: usize) -> Vec4 {
        // One sum for each place within a tap: the processor adds them side by side.
        let mut sums = [Vec4::ZERO; N];
        for (&first, weights) in self.first.iter().zip(&self.weights) {
            for j in 0..N {
                sums[j] += map[first + j * self.stride] * weights[j];
            }
        }
        sums.iter().fold(map[texel] * self.centre_weight, |sum, &part| sum + part)
    }

    /// The same without interpolation: enough for the stretch, which is smooth or constant over whole triangles.
    #[inline(always)]
    fn gather_nearest(&self, map: &[Vec2], texel: usize) -> Vec2 {
        let mut sum = map[texel] * self.centre_weight;
        for (&first, weights) in self.first.iter().zip(&self.weights) {
            let middle = N / 2 - 1;
            let nearest = middle + usize::from(weights[middle + 1] > weights[middle]);
            let whole: f32 = weights.iter().sum();
            sum += map[first + nearest * self.stride] * whole;
        }
        sum
    }
}

/// The line of texels along which one texel is blurred.
struct Line<'a, const V: bool> {
    stretch_mm: &'a [Vec2],
    texel: usize,
    /// Elements from one texel of the line to the next.
    stride: usize,
    /// Farthest place of a tap, texels.
    room: f32,
}

impl<const V: bool> Line<'_, V> {
    #[inline(always)]
    fn texel_mm(&self, texel: usize) -> f32 {
        if V { self.stretch_mm[texel].y } else { self.stretch_mm[texel].x }
    }

    /// The texel `steps` away on one side.
    #[inline(always)]
    fn at(&self, steps: usize, forward: bool) -> usize {
        if forward { self.texel + steps * self.stride } else { self.texel - steps * self.stride }
    }
}

impl Reads {
    #[inline(always)]
    fn at<const V: bool>(
        taps: &Taps,
        charts: &ChartMap,
        widening: Widening,
        stretch_mm: &[Vec2],
        texel: usize,
    ) -> Self {
        if charts.chart[texel] == NO_CHART {
            return Self::Own;
        }
        let (reach, stride) =
            if V { (charts.reach_v[texel], charts.size) } else { (charts.reach_u[texel], 1) };
        let reach = f32::from(reach);
        // A place exactly at the end would make the next texel, outside, part of the read.
        let mut line = Line::<V> { stretch_mm, texel, stride, room: reach - 1e-3 };
        match widening.taps(taps, line.texel_mm(texel), reach) {
            Spread::Cells(weights) => Self::Cells(Cells { weights, stride }),
            Spread::Linear(spacing) => {
                line.spaced(taps, spacing, |f| [1.0 - f, f]).map_or(Self::Own, Self::Linear)
            }
            Spread::Cubic(spacing) => {
                // A cubic read reaches one texel farther than a linear one.
                line.room -= 1.0;
                line.spaced(taps, spacing, catmull_rom).map_or(Self::Own, Self::Cubic)
            }
        }
    }
}

impl<const V: bool> Line<'_, V> {
    /// Three taps on either side, the same distance of surface apart: where the stretch varies, so does the distance in
    /// texels. Each step takes the stretch half a step ahead.
    #[inline(always)]
    fn spaced<const N: usize>(
        &self,
        taps: &Taps,
        spacing: f32,
        interpolate: impl Fn(f32) -> [f32; N],
    ) -> Option<Spaced<N>> {
        if spacing <= 0.0 || self.room <= 0.0 {
            return None;
        }
        let mut spaced = Spaced {
            centre_weight: taps.weights[0],
            first: [0; 6],
            weights: [[0.0; N]; 6],
            stride: self.stride,
        };
        let spacing_mm = spacing * self.texel_mm(self.texel);
        let (mut up, mut down) = ([0.0f32, spacing], [0.0f32, spacing]);
        // Texels that a tap needs before the one it follows: none for linear reads, one for cubic ones.
        let before = N / 2 - 1;
        for k in 0..3 {
            self.advance(&mut up, spacing_mm, true);
            self.advance(&mut down, spacing_mm, false);
            for (side, place) in [up[0], down[0]].into_iter().enumerate() {
                let whole = place as usize;
                let mut weights = interpolate(place - whole as f32).map(|w| w * taps.weights[k + 1]);
                spaced.first[2 * k + side] = if side == 0 {
                    self.texel + whole * self.stride - before * self.stride
                } else {
                    // Seen from the other side: the last texel of the tap comes first.
                    weights.reverse();
                    self.texel - (whole + N - 1 - before) * self.stride
                };
                spaced.weights[2 * k + side] = weights;
            }
        }
        Some(spaced)
    }

    /// Moves a place (and the last step to it) by one spacing.
    #[inline(always)]
    fn advance(&self, [place, step]: &mut [f32; 2], spacing_mm: f32, forward: bool) {
        let ahead = (*place + 0.5 * *step).min(self.room) as usize;
        *step = spacing_mm / self.texel_mm(self.at(ahead, forward));
        *place = (*place + *step).min(self.room);
    }
}

/// Weights of cubic interpolation through four neighbours (Catmull & Rom 1974), exact for parabolas.
#[inline(always)]
fn catmull_rom(f: f32) -> [f32; 4] {
    let (f2, f3) = (f * f, f * f * f);
    [-0.5 * f + f2 - 0.5 * f3, 1.0 - 2.5 * f2 + 1.5 * f3, 0.5 * f + 2.0 * f2 - 1.5 * f3, -0.5 * f2 + 0.5 * f3]
}
