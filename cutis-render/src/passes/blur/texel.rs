//! The taps of one texel, placed for it alone: where the stretch varies, and towards seams.

use super::{Field, Spread, Widening, catmull_rom};
use crate::passes::atlas::{ChartMap, NO_CHART};
use crate::passes::tap::Taps;
use glam::{Vec2, Vec4};

/// What one texel reads.
pub(super) enum Reads {
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
pub(super) struct Cells {
    weights: [f32; 4],
    stride: usize,
}

/// Six taps, three on either side, each interpolated among `N` neighbouring texels.
pub(super) struct Spaced<const N: usize> {
    centre_weight: f32,
    /// First of the texels of each tap; the others follow `stride` elements apart.
    first: [usize; 6],
    weights: [[f32; N]; 6],
    stride: usize,
}

impl Cells {
    #[inline(always)]
    fn gather<T: Field>(&self, map: &[T], texel: usize) -> T {
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
    /// A layer at the texel, blurred.
    #[inline(always)]
    pub(super) fn gather(&self, map: &[Vec4], texel: usize) -> Vec4 {
        match self {
            Self::Own => map[texel],
            Self::Cells(cells) => cells.gather(map, texel),
            Self::Linear(taps) => taps.gather(map, texel),
            Self::Cubic(taps) => taps.gather(map, texel),
        }
    }

    /// The stretch at the texel, blurred.
    #[inline(always)]
    pub(super) fn gather_stretch(&self, map: &[Vec2], texel: usize) -> Vec2 {
        match self {
            Self::Own => map[texel],
            Self::Cells(cells) => cells.gather(map, texel),
            Self::Linear(taps) => taps.gather_nearest(map, texel),
            Self::Cubic(taps) => taps.gather_nearest(map, texel),
        }
    }

    #[inline(always)]
    pub(super) fn at<const V: bool>(
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
