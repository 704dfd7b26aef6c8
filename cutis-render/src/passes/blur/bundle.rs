//! What is blurred at once: one texel of a map, or eight neighbours of a row, whose channels lie side by side in memory
//! and are added side by side by the processor.

use glam::{Vec2, Vec4};
use wide::f32x8;

/// Texels of a block.
pub(super) const BLOCK: usize = 8;

/// One texel or a block of them: weighted sums of it exist.
pub(super) trait Bundle: Copy {
    /// What a map holds.
    type Texel;
    /// The bundle that begins at a texel.
    fn load(map: &[Self::Texel], first: usize) -> Self;
    /// This times a weight.
    fn scaled(self, weight: f32) -> Self;
    /// This plus another times a weight.
    fn plus_scaled(self, other: Self, weight: f32) -> Self;
}

macro_rules! one_texel {
    ($texel:ty) => {
        impl Bundle for $texel {
            type Texel = $texel;

            #[inline(always)]
            fn load(map: &[$texel], first: usize) -> Self {
                map[first]
            }

            #[inline(always)]
            fn scaled(self, weight: f32) -> Self {
                self * weight
            }

            #[inline(always)]
            fn plus_scaled(self, other: Self, weight: f32) -> Self {
                self + other * weight
            }
        }
    };
}

one_texel!(Vec4);
one_texel!(Vec2);

/// Eight neighbours.
pub(super) trait Block: Bundle {
    /// Writes them.
    fn store(self, to: &mut [Self::Texel]);
    /// This mixed with another: `share` of the other at the first texel, `step` more at each that follows.
    fn mixed(self, other: Self, share: f32, step: f32) -> Self;
}

/// Eight texels' channels, eight to a register.
macro_rules! eight_texels {
    ($texel:ty, $registers:literal, $index:expr) => {
        impl Bundle for [f32x8; $registers] {
            type Texel = $texel;

            #[inline(always)]
            fn load(map: &[$texel], first: usize) -> Self {
                let floats: &[f32] = bytemuck::cast_slice(&map[first..first + BLOCK]);
                std::array::from_fn(|i| f32x8::from(&floats[8 * i..8 * i + 8]))
            }

            #[inline(always)]
            fn scaled(mut self, weight: f32) -> Self {
                for sum in &mut self {
                    *sum *= f32x8::splat(weight);
                }
                self
            }

            #[inline(always)]
            fn plus_scaled(mut self, other: Self, weight: f32) -> Self {
                for i in 0..self.len() {
                    self[i] = other[i].mul_add(f32x8::splat(weight), self[i]);
                }
                self
            }
        }

        impl Block for [f32x8; $registers] {
            #[inline(always)]
            fn store(self, to: &mut [$texel]) {
                to.copy_from_slice(&bytemuck::cast::<_, [$texel; BLOCK]>(self));
            }

            #[inline(always)]
            fn mixed(mut self, other: Self, share: f32, step: f32) -> Self {
                // Which texel of a register a channel belongs to.
                let index = f32x8::from($index);
                let register = (BLOCK / $registers) as f32;
                for i in 0..self.len() {
                    let share = (index + register * i as f32) * step + share;
                    self[i] = (other[i] - self[i]).mul_add(share, self[i]);
                }
                self
            }
        }
    };
}

eight_texels!(Vec4, 4, [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]);
eight_texels!(Vec2, 2, [0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0]);
