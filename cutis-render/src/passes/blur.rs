//! One blur step along one axis of the texture, its width corrected by the local stretch
//! (d'Eon, Luebke & Enderton 2007, section 5.1 and 5.4).
//!
//! Irradiance, thickness and stretch are blurred together: every texel reads the same taps from all of them. No tap
//! leaves the texel's own chart: towards a seam the spacing shrinks with the distance to it, down to nothing.

use crate::passes::atlas::{ChartMap, NO_CHART};
use crate::passes::tap::{TAPS, Taps};
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
                let reads = Reads::at::<V>(taps, charts, widening, &source.stretch_mm, texel);
                for (target, source) in layers.iter_mut().zip(&source.layers) {
                    target[x] = reads.gather(source);
                }
                stretch[x] = reads.gather_roughly(taps, &source.stretch_mm, texel);
            }
        },
    );
}

/// Reads of one texel at most: itself, and six taps between four texels each.
const MAX_READS: usize = 25;

/// The texels one texel reads, and their weights.
struct Reads {
    count: usize,
    texels: [u32; MAX_READS],
    weights: [f32; MAX_READS],
    /// The texels nearest to the six taps, for what needs no interpolation.
    nearest: [u32; 6],
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
    fn own(texel: usize) -> Self {
        let mut reads =
            Self { count: 1, texels: [0; MAX_READS], weights: [0.0; MAX_READS], nearest: [texel as u32; 6] };
        reads.texels[0] = texel as u32;
        reads.weights[0] = 1.0;
        reads
    }

    #[inline(always)]
    fn push(&mut self, texel: usize, weight: f32) {
        self.texels[self.count] = texel as u32;
        self.weights[self.count] = weight;
        self.count += 1;
    }

    #[inline(always)]
    fn at<const V: bool>(
        taps: &Taps,
        charts: &ChartMap,
        widening: Widening,
        stretch_mm: &[Vec2],
        texel: usize,
    ) -> Self {
        let mut reads = Self::own(texel);
        if charts.chart[texel] == NO_CHART {
            return reads;
        }
        let (reach, stride) =
            if V { (charts.reach_v[texel], charts.size) } else { (charts.reach_u[texel], 1) };
        let reach = f32::from(reach);
        // A place exactly at the end would make the next texel, outside, part of the read.
        let mut line = Line::<V> { stretch_mm, texel, stride, room: reach - 1e-3 };
        match widening.taps(taps, line.texel_mm(texel), reach) {
            Spread::Cells(weights) => reads.add_cells(&line, weights),
            Spread::Linear(spacing) => reads.add_spaced::<V, false>(taps, &line, spacing),
            Spread::Cubic(spacing) => {
                // A cubic read reaches one texel farther than a linear one.
                line.room -= 1.0;
                reads.add_spaced::<V, true>(taps, &line, spacing);
            }
        }
        reads
    }

    #[inline(always)]
    fn add_cells<const V: bool>(&mut self, line: &Line<V>, weights: [f32; 4]) {
        self.weights[0] = weights[0];
        for k in 1..4 {
            let pair = [line.at(k, true), line.at(k, false)];
            self.push(pair[0], weights[k]);
            self.push(pair[1], weights[k]);
            self.nearest[2 * k - 2] = pair[0] as u32;
            self.nearest[2 * k - 1] = pair[1] as u32;
        }
    }

    /// Three taps on either side, the same distance of surface apart: where the stretch varies, so does the distance in
    /// texels. Each step takes the stretch half a step ahead.
    #[inline(always)]
    fn add_spaced<const V: bool, const CUBIC: bool>(&mut self, taps: &Taps, line: &Line<V>, spacing: f32) {
        if spacing <= 0.0 || line.room <= 0.0 {
            return;
        }
        self.weights[0] = taps.weights[0];
        let spacing_mm = spacing * line.texel_mm(line.texel);
        for (side, forward) in [true, false].into_iter().enumerate() {
            let mut place = 0.0f32;
            let mut step = spacing;
            for k in 0..3 {
                let ahead = (place + 0.5 * step).min(line.room) as usize;
                step = spacing_mm / line.texel_mm(line.at(ahead, forward));
                place = (place + step).min(line.room);
                let whole = place as usize;
                let f = place - whole as f32;
                self.add_tap::<V, CUBIC>(line, whole, f, forward, taps.weights[k + 1]);
                self.nearest[2 * k + side] = line.at(whole + usize::from(f > 0.5), forward) as u32;
            }
        }
    }

    #[inline(always)]
    fn add_tap<const V: bool, const CUBIC: bool>(
        &mut self,
        line: &Line<V>,
        whole: usize,
        f: f32,
        forward: bool,
        weight: f32,
    ) {
        let near = line.at(whole, forward);
        let far = line.at(whole + 1, forward);
        if CUBIC {
            let [w0, w1, w2, w3] = catmull_rom(f);
            // Before the first texel on this side lies the first on the other.
            let before = if whole > 0 { line.at(whole - 1, forward) } else { line.at(1, !forward) };
            self.push(before, weight * w0);
            self.push(near, weight * w1);
            self.push(far, weight * w2);
            self.push(line.at(whole + 2, forward), weight * w3);
        } else {
            self.push(near, weight * (1.0 - f));
            self.push(far, weight * f);
        }
    }

    #[inline(always)]
    fn gather(&self, map: &[Vec4]) -> Vec4 {
        // The number of reads is 1 plus a multiple of 6: six sums at a time keep the processor's adders busy.
        let mut sums = [Vec4::ZERO; 6];
        let reads =
            self.texels[1..self.count].chunks_exact(6).zip(self.weights[1..self.count].chunks_exact(6));
        for (texels, weights) in reads {
            for k in 0..6 {
                sums[k] += map[texels[k] as usize] * weights[k];
            }
        }
        map[self.texels[0] as usize] * self.weights[0]
            + (sums[0] + sums[1])
            + (sums[2] + sums[3])
            + (sums[4] + sums[5])
    }

    /// The same without interpolation: enough for the stretch, which is smooth or constant over whole triangles.
    #[inline(always)]
    fn gather_roughly(&self, taps: &Taps, map: &[Vec2], texel: usize) -> Vec2 {
        if self.count == 1 {
            return map[texel];
        }
        let centre = self.weights[0];
        let outer =
            if self.count == 7 { [self.weights[1], self.weights[3], self.weights[5]] } else { taps.outer() };
        let pairs = self.nearest.chunks_exact(2).zip(outer);
        pairs.fold(map[texel] * centre, |sum, (pair, w)| {
            sum + (map[pair[0] as usize] + map[pair[1] as usize]) * w
        })
    }
}

/// Weights of cubic interpolation through four neighbours (Catmull & Rom 1974), exact for parabolas.
#[inline(always)]
fn catmull_rom(f: f32) -> [f32; 4] {
    let (f2, f3) = (f * f, f * f * f);
    [-0.5 * f + f2 - 0.5 * f3, 1.0 - 2.5 * f2 + 1.5 * f3, 0.5 * f + 2.0 * f2 - 1.5 * f3, -0.5 * f2 + 0.5 * f3]
}
