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
    /// Variance in texel² that the step adds where a texel is `texel_mm` wide.
    fn variance_texel2(self, texel_mm: f32) -> f32 {
        let per_mm2 = 1.0 / (texel_mm * texel_mm);
        TAPS.discrete_variance(self.to_mm2 * per_mm2)
            - TAPS.discrete_variance(self.from_mm2 * per_mm2)
            - self.saved_texel2
    }
}

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
struct Reads {
    /// Distance in elements to the nearer texel of each tap pair.
    near: [usize; 3],
    /// Distance to the farther one.
    far: [usize; 3],
    near_weight: [f32; 3],
    far_weight: [f32; 3],
    centre_weight: f32,
}

impl Reads {
    #[inline]
    fn at(charts: &ChartMap, axis: Axis, widening: Widening, stretch_mm: &[Vec2], texel: usize) -> Self {
        let mut reads = Self {
            near: [0; 3],
            far: [0; 3],
            near_weight: [0.0; 3],
            far_weight: [0.0; 3],
            centre_weight: 1.0,
        };
        if charts.chart[texel] == NO_CHART {
            return reads;
        }
        let (reach, stride, texel_mm) = match axis {
            Axis::U => (charts.reach_u[texel], 1, stretch_mm[texel].x),
            Axis::V => (charts.reach_v[texel], charts.size, stretch_mm[texel].y),
        };
        // The outermost tap stays short of the last texel of the chart, so that its farther read is still inside.
        let room = (f32::from(reach) - 1e-3) / 3.0;
        let spacing = TAPS.spacing(widening.variance_texel2(texel_mm)).min(room);
        if spacing <= 0.0 {
            return reads;
        }
        reads.centre_weight = TAPS.weights[0];
        for k in 0..3 {
            let position = (k + 1) as f32 * spacing;
            let whole = position as usize;
            let fraction = position - whole as f32;
            reads.near[k] = whole * stride;
            reads.far[k] = (whole + 1) * stride;
            reads.near_weight[k] = TAPS.weights[k + 1] * (1.0 - fraction);
            reads.far_weight[k] = TAPS.weights[k + 1] * fraction;
        }
        reads
    }

    #[inline]
    fn gather<T>(&self, map: &[T], texel: usize) -> T
    where
        T: Copy + std::ops::Add<Output = T> + std::ops::Mul<f32, Output = T>,
    {
        let mut sum = map[texel] * self.centre_weight;
        if self.far[0] == 0 {
            return sum;
        }
        for k in 0..3 {
            let near = map[texel + self.near[k]] + map[texel - self.near[k]];
            let far = map[texel + self.far[k]] + map[texel - self.far[k]];
            sum = sum + near * self.near_weight[k] + far * self.far_weight[k];
        }
        sum
    }
}
