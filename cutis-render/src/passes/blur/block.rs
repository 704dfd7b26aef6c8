//! One set of symmetric taps for a few neighbouring texels of a row, where the stretch hardly varies around them.

use super::{Field, Spread, Widening, catmull_rom};
use crate::passes::atlas::{ChartMap, NO_CHART};
use crate::passes::tap::Taps;
use glam::{Vec2, Vec4};

/// Texels of a block: eight sums of four channels fit into the registers of a processor.
pub(super) const BLOCK: usize = 8;
/// Largest ratio of texel sizes within a block: 1 % from the middle, 2 % in variance at the worst texel.
const MAX_RATIO_INSIDE: f32 = 1.02;
/// Largest ratio to the texels under the outermost taps. Taps that stand symmetrically although the surface does not
/// shift light towards the coarser side; at 1.06 a mapping that doubles its texels over 500 gains 0.7 % of energy.
const MAX_RATIO_AROUND: f32 = 1.03;
/// Distances that are read at most: three cubic taps less than four texels apart reach 14 texels.
const MAX_PAIRS: usize = 14;

/// The taps of a block.
pub(super) struct Block {
    centre_weight: f32,
    /// Distance in elements of the texels read on both sides, and their weight.
    pairs: [(usize, f32); MAX_PAIRS],
    count: usize,
    /// The same without interpolation, for the stretch.
    rough: [(usize, f32); 3],
    rough_centre_weight: f32,
}

impl Block {
    /// Taps for the texels from `first` on, if one set will do: they belong to one chart, none of them is near its
    /// edge, and the stretch is nearly the same for all and around them.
    #[inline(always)]
    pub(super) fn at<const V: bool>(
        taps: &Taps,
        charts: &ChartMap,
        widening: Widening,
        stretch_mm: &[Vec2],
        first: usize,
    ) -> Option<Self> {
        let chart = charts.chart[first];
        if chart == NO_CHART || charts.chart[first..first + BLOCK].iter().any(|&c| c != chart) {
            return None;
        }
        let axis = |stretch: Vec2| if V { stretch.y } else { stretch.x };
        let inside = stretch_mm[first..first + BLOCK].iter().map(|&s| axis(s));
        let (least, most) = inside.fold((f32::INFINITY, 0.0f32), |(lo, hi), mm| (lo.min(mm), hi.max(mm)));
        if most > MAX_RATIO_INSIDE * least {
            return None;
        }
        let texel_mm = 0.5 * (least + most);
        let spread = widening.taps(taps, texel_mm, f32::INFINITY);
        let (reaches, stride) = if V { (&charts.reach_v, charts.size) } else { (&charts.reach_u, 1) };
        let reach = reaches[first..first + BLOCK].iter().copied().min().unwrap_or(0);
        let farthest = spread.farthest_texel();
        if farthest > usize::from(reach) {
            return None;
        }
        let last = first + BLOCK - 1;
        let ends = [first, last].map(|t| [t - farthest * stride, t + farthest * stride]);
        let alike = |&t: &usize| {
            let mm = axis(stretch_mm[t]);
            mm < MAX_RATIO_AROUND * texel_mm && texel_mm < MAX_RATIO_AROUND * mm
        };
        ends.as_flattened().iter().all(alike).then(|| Self::new(taps, spread, stride))
    }

    #[inline(always)]
    fn new(taps: &Taps, spread: Spread, stride: usize) -> Self {
        let mut block = Self {
            centre_weight: taps.weights[0],
            pairs: [(0, 0.0); MAX_PAIRS],
            count: 0,
            rough: [(0, 0.0); 3],
            rough_centre_weight: taps.weights[0],
        };
        match spread {
            Spread::Cells(weights) => {
                block.centre_weight = weights[0];
                block.rough_centre_weight = weights[0];
                for (k, &weight) in weights.iter().enumerate().skip(1) {
                    block.push(k * stride, weight);
                    block.rough[k - 1] = (k * stride, weight);
                }
            }
            Spread::Linear(spacing) => block.add_linear(taps, spacing, stride),
            Spread::Cubic(spacing) => block.add_cubic(taps, spacing, stride),
        }
        block
    }

    #[inline(always)]
    fn push(&mut self, distance: usize, weight: f32) {
        self.pairs[self.count] = (distance, weight);
        self.count += 1;
    }

    #[inline(always)]
    fn add_linear(&mut self, taps: &Taps, spacing: f32, stride: usize) {
        for k in 1..4 {
            let place = k as f32 * spacing;
            let (whole, f) = (place as usize, place.fract());
            self.push(whole * stride, taps.weights[k] * (1.0 - f));
            self.push((whole + 1) * stride, taps.weights[k] * f);
            self.rough[k - 1] = ((whole + usize::from(f > 0.5)) * stride, taps.weights[k]);
        }
    }

    /// Neighbouring cubic taps share texels: their weights are added up by distance.
    #[inline(always)]
    fn add_cubic(&mut self, taps: &Taps, spacing: f32, stride: usize) {
        let mut by_distance = [0.0f32; MAX_PAIRS + 1];
        for k in 1..4 {
            let place = k as f32 * spacing;
            let (whole, f) = (place as usize, place.fract());
            for (j, weight) in catmull_rom(f).into_iter().enumerate() {
                // Before the first texel on one side lies the first on the other: the same distance.
                by_distance[(whole + j).abs_diff(1)] += weight * taps.weights[k];
            }
            self.rough[k - 1] = ((whole + usize::from(f > 0.5)) * stride, taps.weights[k]);
        }
        // What falls on the centre comes from both sides.
        self.centre_weight += 2.0 * by_distance[0];
        for (distance, &weight) in by_distance.iter().enumerate().skip(1).take((3.0 * spacing) as usize + 2) {
            self.push(distance * stride, weight);
        }
    }

    /// A layer at all texels of the block, blurred.
    #[inline(always)]
    pub(super) fn gather(&self, map: &[Vec4], first: usize) -> [Vec4; BLOCK] {
        sum_pairs(map, first, self.centre_weight, &self.pairs[..self.count])
    }

    /// The stretch at all texels of the block, blurred.
    #[inline(always)]
    pub(super) fn gather_stretch(&self, map: &[Vec2], first: usize) -> [Vec2; BLOCK] {
        sum_pairs(map, first, self.rough_centre_weight, &self.rough)
    }
}

#[inline(always)]
fn sum_pairs<T: Field>(map: &[T], first: usize, centre_weight: f32, pairs: &[(usize, f32)]) -> [T; BLOCK] {
    let centre = &map[first..first + BLOCK];
    let mut sums: [T; BLOCK] = std::array::from_fn(|i| centre[i] * centre_weight);
    for &(distance, weight) in pairs {
        let after = &map[first + distance..first + distance + BLOCK];
        let before = &map[first - distance..first - distance + BLOCK];
        for i in 0..BLOCK {
            sums[i] = sums[i] + (after[i] + before[i]) * weight;
        }
    }
    sums
}
