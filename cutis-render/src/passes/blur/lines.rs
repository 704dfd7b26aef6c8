//! Where taps lie: for one texel, or for a block of neighbours whose stretch hardly differs.

use super::reads::{Reads, SIDE};
use super::{Spread, Widening};
use crate::passes::atlas::{ChartMap, NO_CHART};
use crate::passes::tap::TAPS;
use glam::Vec2;
use wide::f32x8;

/// Largest root mean square deviation of texel sizes from a straight line between those at the ends of their block: 2 %
/// in variance.
const MAX_BEND: f32 = 0.01;
/// Largest ratio of texel sizes at the ends of a block. Between, two Gaussians of different width are mixed.
const MAX_RATIO: f32 = 1.25;

/// Texel sizes that differ by less than this ratio are the same.
const ALIKE: f32 = 0.001;

/// The lines of texels of one axis: along v if `V`, else along u.
pub(super) struct Lines<'a, const V: bool> {
    pub(super) charts: &'a ChartMap,
    pub(super) widening: Widening,
    pub(super) stretch_mm: &'a [Vec2],
}

impl<const V: bool> Lines<'_, V> {
    /// What one texel reads. Towards a seam its taps come closer.
    #[inline(always)]
    pub(super) fn of_texel(&self, texel: usize) -> Reads {
        if self.charts.chart[texel] == NO_CHART {
            return Reads::own();
        }
        let reach = f32::from(self.reaches()[texel]);
        let texel_mm = self.texel_mm(texel);
        match self.widening.taps(&TAPS, texel_mm, reach) {
            Spread::Cells(weights) => Reads::cells(weights, self.stride()),
            Spread::Spaced { spacing, cubic } => {
                let room = room(reach, cubic);
                if room <= 0.0 || spacing <= 0.0 {
                    return Reads::own();
                }
                let [near, far] = self.places(texel, texel_mm, spacing, room);
                Reads::at(near.map(|p| p.min(room)), far.map(|p| p.min(room)), cubic, self.stride())
            }
        }
    }

    /// What the first and the last texel of a block read, if a mixture of both will do for all between: they belong to
    /// one chart, none is so near to its edge that taps must come closer, and the stretch grows or shrinks evenly.
    /// Where it stays the same, what the first reads is enough.
    #[inline(always)]
    pub(super) fn of_block(&self, first: usize, count: usize) -> Option<(Reads, Option<Reads>)> {
        let charts = &self.charts.chart[first..first + count];
        if charts.iter().fold(false, |mixed, &chart| mixed | (chart != charts[0])) {
            return None;
        }
        if charts[0] == NO_CHART {
            return Some((Reads::own(), None));
        }
        if !self.is_even(first, count) {
            return None;
        }
        let reaches = &self.reaches()[first..first + count];
        let reach = f32::from(reaches.iter().copied().fold(u16::MAX, u16::min));
        let last = first + count - 1;
        let start = self.unhindered(first, reach)?;
        if (self.texel_mm(last) - self.texel_mm(first)).abs() <= ALIKE * self.texel_mm(first) {
            return Some((start, None));
        }
        Some((start, Some(self.unhindered(last, reach)?)))
    }

    /// What a texel reads, if none of that is farther than `reach`.
    #[inline(always)]
    fn unhindered(&self, texel: usize, reach: f32) -> Option<Reads> {
        let texel_mm = self.texel_mm(texel);
        match self.widening.taps(&TAPS, texel_mm, f32::INFINITY) {
            Spread::Cells(weights) => (reach >= SIDE as f32).then(|| Reads::cells(weights, self.stride())),
            Spread::Spaced { spacing, cubic } => {
                let room = room(reach, cubic);
                if room <= 0.0 {
                    return None;
                }
                let [near, far] = self.places(texel, texel_mm, spacing, room);
                let fits = near[SIDE - 1] <= room && far[SIDE - 1] <= room;
                fits.then(|| Reads::at(near, far, cubic, self.stride()))
            }
        }
    }

    /// Whether the stretch is nearly a straight line along a block.
    #[inline(always)]
    fn is_even(&self, first: usize, count: usize) -> bool {
        let (start, end) = (self.stretch_mm[first], self.stretch_mm[first + count - 1]);
        let step = (end - start) / (count - 1) as f32;
        let mut bend = Vec2::ZERO;
        for (i, &stretch) in self.stretch_mm[first..first + count].iter().enumerate() {
            let off = stretch - (start + step * i as f32);
            bend += off * off;
        }
        let (bend, start_mm, end_mm) = if V { (bend.y, start.y, end.y) } else { (bend.x, start.x, end.x) };
        let least_mm = if start_mm < end_mm { start_mm } else { end_mm };
        bend <= (MAX_BEND * least_mm).powi(2) * count as f32
            && start_mm <= MAX_RATIO * least_mm
            && end_mm <= MAX_RATIO * least_mm
    }

    /// Distances in texels of three taps on either side of a texel, the same distance of surface apart: where the
    /// stretch varies, so does the distance in texels. Each step takes the stretch in its middle, no farther than `room`.
    #[inline(always)]
    fn places(&self, texel: usize, texel_mm: f32, spacing: f32, room: f32) -> [[f32; SIDE]; 2] {
        let ahead = |tap: usize| (((tap as f32 + 0.5) * spacing).min(room) as i32) as usize * self.stride();
        let near = |tap: usize| self.texel_mm(texel + ahead(tap));
        let far = |tap: usize| self.texel_mm(texel - ahead(tap));
        let sizes_mm = f32x8::from([near(0), near(1), near(2), 1.0, far(0), far(1), far(2), 1.0]);
        let steps = (f32x8::splat(spacing * texel_mm) / sizes_mm).to_array();
        let sums = |a: f32, b: f32, c: f32| [a, a + b, a + b + c];
        [sums(steps[0], steps[1], steps[2]), sums(steps[4], steps[5], steps[6])]
    }

    /// Elements from one texel of a line to the next.
    #[inline(always)]
    fn stride(&self) -> usize {
        if V { self.charts.size } else { 1 }
    }

    /// Distance of each texel from the end of its line, texels.
    #[inline(always)]
    fn reaches(&self) -> &[u16] {
        if V { &self.charts.reach_v } else { &self.charts.reach_u }
    }

    #[inline(always)]
    fn texel_mm(&self, texel: usize) -> f32 {
        if V { self.stretch_mm[texel].y } else { self.stretch_mm[texel].x }
    }
}

/// How far a tap may lie from a texel that is `reach` texels from the end of its line. Cubic reads take in one texel
/// more; and a place exactly at the end would make the next texel, outside, part of the read.
#[inline(always)]
fn room(reach: f32, cubic: bool) -> f32 {
    reach - if cubic { 1.001 } else { 0.001 }
}
