//! Plain numbers: root mean square error, relative mean square error, mean bias.

use super::Pair;
use glam::Vec3;
use rayon::prelude::*;

/// Added to the squared reference before it divides a squared error, in the square of the picture's unit. It keeps dark
/// pixels from counting without limit; 0.01 is customary where Monte Carlo pictures of a brightness near 1 are judged.
pub const RELATIVE_EPSILON: f64 = 0.01;

/// Pixels summed at once; what one thread gets does not depend on how many there are.
const CHUNK: usize = 1 << 14;

/// How far a picture is from its reference, in the pictures' own unit where there is one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Numbers {
    /// Root of the mean over pixels and channels of (a - b)².
    pub rmse: f64,
    /// Mean over pixels and channels of (a - b)² / (b² + [`RELATIVE_EPSILON`]), b being the reference; no unit.
    pub relative_mse: f64,
    /// Mean of a minus mean of b: red, green, blue.
    pub bias: [f64; 3],
    /// The bias as a part of the mean of b; none for a channel whose mean is not above 0.
    pub relative_bias: [Option<f64>; 3],
}

/// Compares every pixel with its counterpart.
pub fn numbers(pair: Pair<'_>) -> Numbers {
    let chunks = pair.test.par_chunks(CHUNK).zip(pair.reference.par_chunks(CHUNK));
    let parts: Vec<Sums> = chunks.map(|(a, b)| Sums::of(a, b)).collect();
    let sums = parts.iter().fold(Sums::default(), |all, part| all.plus(part));
    let pixels = pair.test.len() as f64;
    let bias = sums.difference.map(|sum| sum / pixels);
    let relative = |c: usize| {
        let mean = sums.reference[c] / pixels;
        (mean > 0.0).then(|| bias[c] / mean)
    };
    Numbers {
        rmse: (sums.squared / (3.0 * pixels)).sqrt(),
        relative_mse: sums.relative_squared / (3.0 * pixels),
        bias,
        relative_bias: [0, 1, 2].map(relative),
    }
}

/// Luminance of linear Rec. 709 (ITU-R BT.709-6, item 3.2), in the unit of the colour.
pub fn luminance(colour: Vec3) -> f32 {
    colour.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

/// Error of the luminance Y, with its sign, as a part of the reference's: (Y - Yb) / √(Yb² + [`RELATIVE_EPSILON`]).
/// Pixel by pixel; above 0 where the picture is brighter.
pub fn relative_luminance_errors(pair: Pair<'_>) -> Vec<f32> {
    let error = |(a, b): (&Vec3, &Vec3)| {
        let (test, reference) = (f64::from(luminance(*a)), f64::from(luminance(*b)));
        ((test - reference) / (reference * reference + RELATIVE_EPSILON).sqrt()) as f32
    };
    pair.test.par_iter().zip(pair.reference).map(error).collect()
}

/// Sums over pixels.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    squared: f64,
    relative_squared: f64,
    difference: [f64; 3],
    reference: [f64; 3],
}

impl Sums {
    fn of(test: &[Vec3], reference: &[Vec3]) -> Self {
        let mut sums = Self::default();
        for (a, b) in test.iter().zip(reference) {
            for c in 0..3 {
                let (a, b) = (f64::from(a[c]), f64::from(b[c]));
                let squared = (a - b) * (a - b);
                sums.squared += squared;
                sums.relative_squared += squared / (b * b + RELATIVE_EPSILON);
                sums.difference[c] += a - b;
                sums.reference[c] += b;
            }
        }
        sums
    }

    fn plus(self, other: &Self) -> Self {
        let added = |a: [f64; 3], b: [f64; 3]| [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
        Self {
            squared: self.squared + other.squared,
            relative_squared: self.relative_squared + other.relative_squared,
            difference: added(self.difference, other.difference),
            reference: added(self.reference, other.reference),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(test: &[Vec3], reference: &[Vec3]) -> Numbers {
        numbers(Pair::new(test, reference, 1).expect("a pair"))
    }

    #[test]
    fn two_pixels_by_hand() {
        let reference = [Vec3::new(1.0, 0.5, 0.0), Vec3::new(3.0, 0.5, 0.0)];
        let test = [Vec3::new(1.5, 0.5, 0.0), Vec3::new(3.0, 0.25, 0.125)];
        let found = of(&test, &reference);
        // Squares: 0.25 of 1, 0.0625 of 0.5 squared, 0.015625 of 0.
        assert!((found.rmse - ((0.25 + 0.0625 + 0.015_625) / 6.0_f64).sqrt()).abs() < 1e-15);
        let relative = (0.25 / 1.01 + 0.0625 / 0.26 + 0.015_625 / 0.01) / 6.0;
        assert!((found.relative_mse - relative).abs() < 1e-15);
        assert_eq!(found.bias, [0.25, -0.125, 0.0625]);
        assert_eq!(found.relative_bias, [Some(0.125), Some(-0.25), None]);
    }

    #[test]
    fn identical_pictures_are_no_distance_apart() {
        let picture: Vec<_> = (0..40_000).map(|i| Vec3::new(i as f32, 1.0, 0.25)).collect();
        let found = of(&picture, &picture);
        assert_eq!((found.rmse, found.relative_mse, found.bias), (0.0, 0.0, [0.0; 3]));
    }

    #[test]
    fn a_gain_is_a_relative_bias_on_any_number_of_threads() {
        let reference: Vec<_> = (0..50_000).map(|i| Vec3::splat((i % 977) as f32)).collect();
        let test: Vec<_> = reference.iter().map(|&p| p * 1.25).collect();
        let found = of(&test, &reference);
        // A quarter of a whole number is exact in f32, and so are the sums in f64.
        assert_eq!(found.relative_bias, [Some(0.25); 3]);
        let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
        assert_eq!(alone.install(|| of(&test, &reference)), found);
    }

    #[test]
    fn the_sign_of_the_luminance_error_says_which_is_brighter() {
        let reference = [Vec3::splat(1.0), Vec3::splat(1.0), Vec3::ZERO];
        let test = [Vec3::splat(1.5), Vec3::splat(0.5), Vec3::splat(0.1)];
        let found = relative_luminance_errors(Pair::new(&test, &reference, 3).expect("a pair"));
        let half = 0.5 / 1.01_f32.sqrt();
        // Three roundings each; the last divides by the root of the epsilon, 0.1.
        for (found, expected) in found.iter().zip([half, -half, 1.0]) {
            assert!((found - expected).abs() < 4.0 * f32::EPSILON, "{found} {expected}");
        }
    }
}
