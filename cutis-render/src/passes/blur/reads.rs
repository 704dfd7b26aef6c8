//! What a texel reads, and adding it up: itself and three taps on either side along a line.

use super::bundle::Bundle;
use crate::passes::tap::TAPS;
use wide::f32x8;

/// Taps on one side.
pub(super) const SIDE: usize = 3;
/// Where the taps of the far side begin: one register holds both sides, four places each, of which the last is empty.
const FAR: usize = 4;
/// Farthest texel of a dense read. Cubic taps are less than four texels apart; the rest is for varying stretch.
const FARTHEST: usize = 20;

/// Itself and six taps, relative to the texel that reads.
pub(super) struct Reads {
    /// Elements from one texel of the line to the next.
    stride: usize,
    layout: Layout,
    /// Texels and weights for the stretch, which is smooth and needs no interpolation.
    rough: Rough,
}

/// How a layer is read.
enum Layout {
    /// Only the texel itself.
    Own,
    /// All texels up to `farthest` on either side.
    Dense { farthest: usize, weights: [f32; 2 * FARTHEST + 1] },
    /// Six taps between two texels each.
    Sparse { whole: [i32; 8], weights: [[f32; 8]; 2] },
}

/// The texel nearest to each tap.
struct Rough {
    centre_weight: f32,
    nearest: [i32; 8],
    weights: [f32; 8],
}

impl Reads {
    /// Only the texel itself.
    #[inline(always)]
    pub(super) fn own() -> Self {
        let rough = Rough { centre_weight: 1.0, nearest: [0; 8], weights: [0.0; 8] };
        Self { stride: 0, layout: Layout::Own, rough }
    }

    /// The texel and three neighbours on either side.
    #[inline(always)]
    pub(super) fn cells([w0, w1, w2, w3]: [f32; 4], stride: usize) -> Self {
        let mut weights = [0.0; 2 * FARTHEST + 1];
        weights[..2 * SIDE + 1].copy_from_slice(&[w3, w2, w1, w0, w1, w2, w3]);
        Self {
            stride,
            layout: Layout::Dense { farthest: SIDE, weights },
            rough: Rough {
                centre_weight: w0,
                nearest: [1, 2, 3, 0, 1, 2, 3, 0],
                weights: [w1, w2, w3, 0.0, w1, w2, w3, 0.0],
            },
        }
    }

    /// Taps at these distances in texels on the near and the far side, interpolated linearly or cubically.
    #[inline(always)]
    pub(super) fn at(near: [f32; SIDE], far: [f32; SIDE], cubic: bool, stride: usize) -> Self {
        // Places so far apart, where texels shrink quickly, are read well enough by linear interpolation.
        let cubic = cubic && near[SIDE - 1].max(far[SIDE - 1]) < (FARTHEST - 2) as f32;
        let places = f32x8::from([near[0], near[1], near[2], 0.0, far[0], far[1], far[2], 0.0]);
        let [centre_weight, w1, w2, w3] = TAPS.weights;
        let tap_weights = f32x8::from([w1, w2, w3, 0.0, w1, w2, w3, 0.0]);
        let floor = places.floor();
        let f = places - floor;
        let whole = floor.fast_trunc_int().to_array();
        let layout = if cubic {
            dense(whole, catmull_rom(f).map(|w| (w * tap_weights).to_array()), centre_weight)
        } else {
            let (first, second) = ((f32x8::ONE - f) * tap_weights, f * tap_weights);
            Layout::Sparse { whole, weights: [first.to_array(), second.to_array()] }
        };
        let nearest = (places + 0.5).fast_trunc_int().to_array();
        Self { stride, layout, rough: Rough { centre_weight, nearest, weights: tap_weights.to_array() } }
    }

    /// A layer, blurred at a texel (or at a block that begins there).
    #[inline(always)]
    pub(super) fn gather<B: Bundle>(&self, map: &[B::Texel], texel: usize) -> B {
        match &self.layout {
            Layout::Own => B::load(map, texel),
            Layout::Dense { farthest, weights } => {
                let mut read = texel - farthest * self.stride;
                let mut sum = B::load(map, read).scaled(weights[0]);
                for &weight in &weights[1..2 * farthest + 1] {
                    read += self.stride;
                    sum = sum.plus_scaled(B::load(map, read), weight);
                }
                sum
            }
            Layout::Sparse { whole, weights } => {
                let mut sum = B::load(map, texel).scaled(self.rough.centre_weight);
                for tap in 0..SIDE {
                    let near = texel + whole[tap] as usize * self.stride;
                    let far = texel - whole[FAR + tap] as usize * self.stride;
                    sum = sum.plus_scaled(B::load(map, near), weights[0][tap]);
                    sum = sum.plus_scaled(B::load(map, near + self.stride), weights[1][tap]);
                    sum = sum.plus_scaled(B::load(map, far), weights[0][FAR + tap]);
                    sum = sum.plus_scaled(B::load(map, far - self.stride), weights[1][FAR + tap]);
                }
                sum
            }
        }
    }

    /// The stretch, blurred.
    #[inline(always)]
    pub(super) fn gather_stretch<B: Bundle>(&self, map: &[B::Texel], texel: usize) -> B {
        let Rough { centre_weight, nearest, weights } = &self.rough;
        let mut sum = B::load(map, texel).scaled(*centre_weight);
        for tap in 0..SIDE {
            let near = texel + nearest[tap] as usize * self.stride;
            let far = texel - nearest[FAR + tap] as usize * self.stride;
            sum = sum.plus_scaled(B::load(map, near), weights[tap]);
            sum = sum.plus_scaled(B::load(map, far), weights[FAR + tap]);
        }
        sum
    }
}

/// Neighbouring cubic taps share texels: their weights are added up by distance.
#[inline(always)]
fn dense(whole: [i32; 8], weights: [[f32; 8]; 4], centre_weight: f32) -> Layout {
    let farthest = whole[SIDE - 1].max(whole[FAR + SIDE - 1]) as usize + 2;
    let mut by_distance = [0.0; 2 * FARTHEST + 1];
    by_distance[farthest] = centre_weight;
    for tap in 0..SIDE {
        // A cubic read begins one texel before the place.
        let near = farthest + whole[tap] as usize - 1;
        let far = farthest + 1 - whole[FAR + tap] as usize;
        for (j, weights) in weights.iter().enumerate() {
            by_distance[near + j] += weights[tap];
            by_distance[far - j] += weights[FAR + tap];
        }
    }
    Layout::Dense { farthest, weights: by_distance }
}

/// Weights of cubic interpolation through four neighbours (Catmull & Rom 1974), exact for parabolas.
#[inline(always)]
fn catmull_rom(f: f32x8) -> [f32x8; 4] {
    let (f2, f3) = (f * f, f * f * f);
    [f2 - 0.5 * (f + f3), f32x8::ONE - 2.5 * f2 + 1.5 * f3, 0.5 * f + 2.0 * f2 - 1.5 * f3, 0.5 * (f3 - f2)]
}
