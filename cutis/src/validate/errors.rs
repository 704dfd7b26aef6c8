//! How far a technique is from the truth, and how far chance moves these numbers.

use super::stored::Truth;
use crate::measure::{Measured, Seen};
use cutis_render::difference::{DEFAULT_PIXELS_PER_DEGREE, DifferenceError, Pair, numbers};
use glam::Vec3;
use serde::{Deserialize, Serialize};

/// Truths that are drawn anew to learn what chance does to a number: its spread is known within a quarter.
const REDRAWN: u64 = 8;

/// Numbers of the diffuse part. All are parts of one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Errors {
    /// Root of the mean square of the errors over that of the truth.
    pub relative_rmse: f64,
    /// Mean error over the mean of the truth: red, green, blue.
    pub bias_rgb: [f64; 3],
    /// Mean HDR-FLIP.
    pub flip_hdr: f64,
}

impl Errors {
    /// Of a picture's diffuse part.
    pub fn of(test: &Seen, truth: &Truth) -> Result<Self, DifferenceError> {
        Self::against(test, truth, &truth.diffuse)
    }

    fn against(test: &Seen, truth: &Truth, light: &[Vec3]) -> Result<Self, DifferenceError> {
        let reference = truth.seen(light);
        let measured = Measured::new(test, &reference, DEFAULT_PIXELS_PER_DEGREE)?;
        Ok(Self {
            relative_rmse: measured.numbers.rmse / root_mean_square(light, truth.width)?,
            bias_rgb: measured.numbers.relative_bias.map(|bias| bias.unwrap_or(0.0)),
            flip_hdr: measured.flip().mean,
        })
    }

    /// Standard deviation of each number when the truth is another one of the same noise.
    pub fn spread(test: &Seen, truth: &Truth) -> Result<Self, DifferenceError> {
        let drawn = (0..REDRAWN).map(|seed| Self::against(test, truth, &truth.redrawn(seed)));
        let drawn = drawn.collect::<Result<Vec<_>, _>>()?;
        let deviation = |i: usize| {
            let values = drawn.iter().map(|errors| errors.list()[i]);
            let mean = values.clone().sum::<f64>() / drawn.len() as f64;
            (values.map(|v| (v - mean) * (v - mean)).sum::<f64>() / (drawn.len() - 1) as f64).sqrt()
        };
        Ok(Self::from_list([0, 1, 2, 3, 4].map(deviation)))
    }

    /// All numbers in a row, biases without their sign.
    pub fn list(&self) -> [f64; 5] {
        let [r, g, b] = self.bias_rgb;
        [self.relative_rmse, r, g, b, self.flip_hdr]
    }

    fn from_list([relative_rmse, r, g, b, flip_hdr]: [f64; 5]) -> Self {
        Self { relative_rmse, bias_rgb: [r, g, b], flip_hdr }
    }
}

impl Truth {
    /// Its own diffuse part, or another one of its size, as pictures are compared.
    pub fn seen(&self, light: &[Vec3]) -> Seen {
        let (width, height) = (self.width as u32, (light.len() / self.width) as u32);
        Seen::developed(width, height, light.iter().map(|p| p.extend(1.0)).collect(), 0.0)
    }

    /// Relative RMSE that its own noise makes.
    pub fn noise(&self) -> Result<f64, DifferenceError> {
        let errors = root_mean_square(&self.standard_errors, self.width)?;
        Ok(errors / root_mean_square(&self.diffuse, self.width)?)
    }

    /// As it may have come out with another seed: every pixel off by its standard error times a normal number, the same in
    /// all channels, whose paths are the same.
    fn redrawn(&self, seed: u64) -> Vec<Vec3> {
        let pixels = self.diffuse.iter().zip(&self.standard_errors).enumerate();
        let off = |(i, (mean, error)): (usize, (&Vec3, &Vec3))| {
            *mean + *error * normal((i as u64) << 8 | seed) as f32
        };
        pixels.map(off).collect()
    }
}

fn root_mean_square(pixels: &[Vec3], width: usize) -> Result<f64, DifferenceError> {
    let black = vec![Vec3::ZERO; pixels.len()];
    Ok(numbers(Pair::new(pixels, &black, width)?).rmse)
}

/// A normal number by its index (Box & Muller 1958, doi:10.1214/aoms/1177706645, not opened).
fn normal(index: u64) -> f64 {
    let unit = |i: u64| (mixed(i) >> 11) as f64 / (1u64 << 53) as f64;
    let (a, b) = (1.0 - unit(2 * index), unit(2 * index + 1));
    (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}

/// Spreads the bits of a number: splitmix64 (Steele, Lea & Flood 2014, doi:10.1145/2660193.2660195, not opened).
fn mixed(index: u64) -> u64 {
    let z = index.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn truth(error: f32) -> Truth {
        let diffuse = (0..1024).map(|i| Vec3::new(1.0, 0.5, 0.25) * (1.0 + (i % 7) as f32)).collect();
        Truth { width: 32, diffuse, standard_errors: vec![Vec3::splat(error); 1024] }
    }

    fn seen(truth: &Truth, gain: f32) -> Seen {
        Seen::developed(32, 32, truth.diffuse.iter().map(|p| (*p * gain).extend(1.0)).collect(), 0.0)
    }

    #[test]
    fn a_gain_is_as_much_of_an_error() {
        let truth = truth(0.0);
        let errors = Errors::of(&seen(&truth, 1.25), &truth).expect("a pair");
        // Multiples of a quarter are exact in f32; sums in f64.
        let expected = [0.25, 0.25, 0.25, 0.25];
        assert!(errors.list()[..4].iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{errors:?}");
        assert!(errors.flip_hdr > 0.0);
        let own = Errors::of(&seen(&truth, 1.0), &truth).expect("a pair").list();
        assert!(own.iter().all(|error| error.abs() < 1e-12), "{own:?}");
    }

    #[test]
    fn a_truth_without_noise_moves_nothing_and_noise_moves_means_by_its_root() {
        let still = truth(0.0);
        let spread = Errors::spread(&seen(&still, 1.25), &still).expect("a pair");
        assert!(spread.list().iter().all(|s| *s < 1e-12), "{spread:?}");
        let noisy = truth(0.4);
        let spread = Errors::spread(&seen(&noisy, 1.25), &noisy).expect("a pair");
        // The mean of 1024 pixels around 4 moves by 0.4 / 32 / 4, and the bias by as much; known within a quarter, four of
        // which are allowed.
        let expected = 1.25 * 0.4 / 32.0 / 3.99;
        assert!((spread.bias_rgb[0] / expected - 1.0).abs() < 1.0, "{spread:?} {expected}");
    }

    #[test]
    fn normal_numbers_have_mean_0_and_variance_1() {
        let n = 40_000;
        let (mut sum, mut squares) = (0.0, 0.0);
        (0..n).map(normal).for_each(|x| {
            sum += x;
            squares += x * x;
        });
        // Four standard errors: 4 / 200 and 4 √2 / 200.
        assert!((sum / n as f64).abs() < 0.02 && (squares / n as f64 - 1.0).abs() < 0.029);
    }
}
