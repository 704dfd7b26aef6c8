//! How far a picture is from another one that is taken for the truth: plain numbers ([`numbers`]), what a person who
//! flips between the two would see ([`ldr_flip`], [`hdr_flip`]), and colours for maps of either.
//!
//! Everything here is a pure function of two slices of pixels in linear Rec. 709. Sums are taken in an order that does
//! not depend on the number of threads, so that the same pictures give the same bits.

mod colour_map;
mod flip;
mod magma;
mod numbers;

pub use colour_map::{diverging, magma};
pub use flip::{DEFAULT_PIXELS_PER_DEGREE, Exposures, FlipMap, HdrFlip, hdr_flip, ldr_flip};
pub use numbers::{Numbers, RELATIVE_EPSILON, luminance, numbers, relative_luminance_errors};

use glam::Vec3;

/// Why two pictures cannot be compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum DifferenceError {
    /// There is nothing to compare, or rows that are not complete.
    #[error(
        "a picture has at least one pixel and complete rows; {pixels} pixels in rows of {width} are neither"
    )]
    NoPicture {
        /// Pixels that were given.
        pixels: usize,
        /// Pixels in a row.
        width: usize,
    },
    /// One picture has more pixels than the other.
    #[error("one picture has {test} pixels and the reference {reference}; only pictures of one size compare")]
    SizesDiffer {
        /// Pixels of the picture that is judged.
        test: usize,
        /// Pixels of the reference.
        reference: usize,
    },
    /// A pixel holds no number.
    #[error("{which}: the pixel in column {x} of row {y} (from 0, from the top left) is not a finite number")]
    NotFinite {
        /// Which of the two.
        which: &'static str,
        /// Column.
        x: usize,
        /// Row.
        y: usize,
    },
}

/// Two pictures that can be compared: as many pixels in both, every one a finite number.
#[derive(Debug, Clone, Copy)]
pub struct Pair<'a> {
    test: &'a [Vec3],
    reference: &'a [Vec3],
    width: usize,
}

impl<'a> Pair<'a> {
    /// The picture that is judged and the one it is judged by; linear Rec. 709, rows of `width` pixels.
    ///
    /// # Errors
    /// If the sizes differ, a picture is empty or its last row incomplete, or a pixel is not finite.
    pub fn new(test: &'a [Vec3], reference: &'a [Vec3], width: usize) -> Result<Self, DifferenceError> {
        if test.len() != reference.len() {
            return Err(DifferenceError::SizesDiffer { test: test.len(), reference: reference.len() });
        }
        if test.is_empty() || width == 0 || !test.len().is_multiple_of(width) {
            return Err(DifferenceError::NoPicture { pixels: test.len(), width });
        }
        all_finite("the picture", test, width)?;
        all_finite("the reference", reference, width)?;
        Ok(Self { test, reference, width })
    }
}

fn all_finite(which: &'static str, pixels: &[Vec3], width: usize) -> Result<(), DifferenceError> {
    match pixels.iter().position(|pixel| !pixel.is_finite()) {
        Some(index) => Err(DifferenceError::NotFinite { which, x: index % width, y: index / width }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_compared_is_refused_with_its_place() {
        let pixels = [Vec3::ZERO; 6];
        let mut broken = pixels;
        broken[4].y = f32::NAN;
        let refused =
            |a: &[Vec3], b: &[Vec3], width| Pair::new(a, b, width).expect_err("refused").to_string();
        assert!(refused(&broken, &pixels, 3).starts_with("the picture: the pixel in column 1 of row 1"));
        assert!(refused(&pixels, &broken, 3).starts_with("the reference: the pixel in column 1 of row 1"));
        assert!(refused(&pixels[..3], &pixels, 3).contains("3 pixels and the reference 6"));
        for (pixels, width) in [(&pixels[..0], 3), (&pixels[..], 4), (&pixels[..], 0)] {
            assert!(refused(pixels, pixels, width).contains("complete rows"));
        }
    }
}
