//! Bloom: the glow that the lens and the eye spread around bright things.
//!
//! An energy-conserving mix of the *whole* exposed picture with itself blurred, `(1 - s) x + s G x`, rather than a
//! blur of its bright part: there is no threshold to choose or to flicker, and no light is made. G is a Gaussian in
//! two separable passes (horizontal, vertical) over a copy reduced so far that the Gaussian is still 8 cells wide.
//! At the borders the weights that fall outside are shared among those inside: a plain picture stays plain.
//! Light is conserved exactly (up to rounding) where it lies further from the borders than the blur reaches.
//!
//! Error of the reduction: averaging over cells of width f and reading back linearly add at most f²/4 to a variance
//! of at least 64 f², 0.4 %.

use super::FilmError;
use super::error::in_range;
use glam::Vec4;
use rayon::prelude::*;

/// Cells that a standard deviation still spans after the reduction.
const CELLS_PER_SIGMA: f32 = 8.0;

/// Reach of the blur in standard deviations; 6e-5 of a Gaussian lies beyond.
const REACH_IN_SIGMAS: f32 = 4.0;

/// Cells to either side that the blur may reach: the reduction leaves standard deviations below twice those it aims at.
pub const MAX_REACH: usize = 64;

/// Glow around bright things.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bloom {
    /// Share of the light that is spread, 0..=1.
    pub strength: f32,
    /// Standard deviation of the spread as a part of the picture's height, 0..=0.25.
    pub sigma_over_height: f32,
}

impl Default for Bloom {
    fn default() -> Self {
        Self { strength: 0.04, sigma_over_height: 0.02 }
    }
}

impl Bloom {
    pub(super) fn check(&self) -> Result<(), FilmError> {
        in_range("bloom", self.strength, 0.0..=1.0, "0 to 1")?;
        in_range("bloom radius", self.sigma_over_height, 0.0..=0.25, "0 to 0.25 of the picture's height")
    }

    /// How the light of a picture of this height is spread; none if it stays where it is.
    pub fn spread(&self, height: u32) -> Option<Spread> {
        let sigma = self.sigma_over_height * height as f32;
        if self.strength <= 0.0 || sigma <= 0.0 {
            return None;
        }
        let cell = ((sigma / CELLS_PER_SIGMA) as usize).max(1);
        Some(Spread { cell, weights: gaussian(sigma / cell as f32) })
    }

    /// Spreads the light of a picture in place.
    pub(super) fn apply(&self, width: u32, height: u32, pixels: &mut [Vec4]) {
        let Some(Spread { cell, weights }) = self.spread(height) else { return };
        let width = width as usize;
        let reduced = reduce(&Grid { width, cells: pixels }, cell);
        let columns = width.div_ceil(cell);
        let blurred = blur_vertical(columns, &blur_horizontal(columns, &reduced, &weights), &weights);
        let glow = Grid { width: columns, cells: &blurred };
        pixels.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
            for (x, pixel) in row.iter_mut().enumerate() {
                *pixel = pixel.lerp(read_between(&glow, centre(x, cell), centre(y, cell)), self.strength);
            }
        });
    }
}

/// How light is spread: the same wherever it is computed.
#[derive(Debug, Clone, PartialEq)]
pub struct Spread {
    /// Side of a cell of the reduced copy, pixels.
    pub cell: usize,
    /// Weights of one half of the blur, from the middle outwards; the other half is the same. Not yet normalised.
    pub weights: Vec<f32>,
}

/// Rows of cells.
struct Grid<'a> {
    width: usize,
    cells: &'a [Vec4],
}

/// Means over squares of `cell`² pixels, smaller ones at the right and lower border.
fn reduce(picture: &Grid, cell: usize) -> Vec<Vec4> {
    let columns = picture.width.div_ceil(cell);
    let bands: Vec<_> = picture.cells.par_chunks(picture.width * cell).collect();
    let mean = |band: &[Vec4], column: usize| {
        let squares =
            band.chunks(picture.width).flat_map(|row| row.chunks(cell).nth(column).unwrap_or_default());
        let (sum, count) = squares.fold((Vec4::ZERO, 0.0), |(sum, count), &p| (sum + p, count + 1.0));
        sum / count
    };
    bands.par_iter().flat_map_iter(|band| (0..columns).map(move |column| mean(band, column))).collect()
}

/// Weights of one half of the blur, from the middle outwards; the other half is the same. Not yet normalised.
fn gaussian(sigma: f32) -> Vec<f32> {
    let reach = (REACH_IN_SIGMAS * sigma).ceil() as usize;
    (0..=reach).map(|i| (-0.5 * (i as f32 / sigma).powi(2)).exp()).collect()
}

fn blur_horizontal(width: usize, cells: &[Vec4], weights: &[f32]) -> Vec<Vec4> {
    let blurred = |row: &[Vec4], x: usize| weighted_mean(width, x, weights, |i| row[i]);
    let rows: Vec<_> = cells.par_chunks(width).collect();
    rows.par_iter().flat_map_iter(|row| (0..width).map(move |x| blurred(row, x))).collect()
}

fn blur_vertical(width: usize, cells: &[Vec4], weights: &[f32]) -> Vec<Vec4> {
    let height = cells.len() / width;
    let blurred = |x: usize, y: usize| weighted_mean(height, y, weights, |i| cells[i * width + x]);
    (0..height).into_par_iter().flat_map_iter(|y| (0..width).map(move |x| blurred(x, y))).collect()
}

/// Mean of the cells around `middle` that exist, in a fixed order.
fn weighted_mean(len: usize, middle: usize, weights: &[f32], cell: impl Fn(usize) -> Vec4) -> Vec4 {
    let reach = weights.len() - 1;
    let (first, last) = (middle.saturating_sub(reach), (middle + reach).min(len - 1));
    let (mut sum, mut total) = (Vec4::ZERO, 0.0);
    for i in first..=last {
        let weight = weights[i.abs_diff(middle)];
        sum += cell(i) * weight;
        total += weight;
    }
    sum / total
}

/// Place of a pixel's centre among the centres of the cells.
fn centre(pixel: usize, cell: usize) -> f32 {
    (pixel as f32 + 0.5) / cell as f32 - 0.5
}

/// Bilinear read that holds the outermost cells.
fn read_between(grid: &Grid, x: f32, y: f32) -> Vec4 {
    let (width, height) = (grid.width, grid.cells.len() / grid.width);
    let split = |at: f32, len: usize| {
        let at = at.clamp(0.0, (len - 1) as f32);
        (at as usize, (at as usize + 1).min(len - 1), at.fract())
    };
    let ((x0, x1, fx), (y0, y1, fy)) = (split(x, width), split(y, height));
    let row = |y: usize| grid.cells[y * width + x0].lerp(grid.cells[y * width + x1], fx);
    row(y0).lerp(row(y1), fy)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Width, height, light at the middle of a dark picture, bloomed.
    fn bloomed_point(size: u32, bloom: Bloom) -> Vec<Vec4> {
        let mut pixels = vec![Vec4::ZERO; (size * size) as usize];
        pixels[(size / 2 * size + size / 2) as usize] = Vec4::splat(1000.0);
        bloom.apply(size, size, &mut pixels);
        pixels
    }

    #[test]
    fn no_light_is_made_or_lost_away_from_the_borders() {
        // 128: no reduction; 512: cells of 3 pixels.
        for size in [128, 512] {
            let pixels = bloomed_point(size, Bloom { strength: 0.5, sigma_over_height: 0.05 });
            let sum: f64 = pixels.iter().map(|p| f64::from(p.x)).sum();
            // Some hundred roundings, of random sign, of sums that end at 1000.
            assert!((sum / 1000.0 - 1.0).abs() < 100.0 * f64::from(f32::EPSILON), "{size}: {sum}");
        }
    }

    #[test]
    fn the_spread_has_the_stated_width() {
        for size in [128u32, 512] {
            let pixels = bloomed_point(size, Bloom { strength: 1.0, sigma_over_height: 0.05 });
            let sigma = 0.05 * f64::from(size);
            let moment = |i: usize, p: &Vec4| {
                (i as f64 % f64::from(size) - f64::from(size / 2)).powi(2) * f64::from(p.x)
            };
            let variance: f64 = pixels.iter().enumerate().map(|(i, p)| moment(i, p)).sum::<f64>() / 1000.0;
            // 0.4 % from the reduction (module doc), 0.11 % from the cut at four sigmas, one third of a pixel²
            // from the place of the point in its cell.
            assert!(
                (variance / (sigma * sigma) - 1.0).abs() < 0.012,
                "{size}: {variance} for {}",
                sigma * sigma
            );
        }
    }

    #[test]
    fn a_plain_picture_stays_plain_up_to_its_borders() {
        let plain = Vec4::new(0.3, 0.2, 0.1, 1.0);
        let mut pixels = vec![plain; 300 * 200];
        Bloom { strength: 0.7, sigma_over_height: 0.2 }.apply(300, 200, &mut pixels);
        assert!(pixels.iter().all(|p| (*p - plain).abs().max_element() < 1e-5));
    }

    #[test]
    fn the_blur_never_reaches_further_than_it_may() {
        for height in 1..5000 {
            let bloom = Bloom { strength: 1.0, sigma_over_height: 0.01 };
            let spread = bloom.spread(height).expect("light is spread");
            assert!(spread.weights.len() <= MAX_REACH + 1, "{height}: {}", spread.weights.len());
        }
    }

    #[test]
    fn odd_little_pictures_are_no_trouble() {
        for (width, height) in [(1, 1), (1, 7), (7, 1), (3, 500)] {
            let mut pixels = vec![Vec4::ONE; (width * height) as usize];
            Bloom { strength: 1.0, sigma_over_height: 0.25 }.apply(width, height, &mut pixels);
            assert!(pixels.iter().all(|p| (*p - Vec4::ONE).abs().max_element() < 1e-5), "{width}x{height}");
        }
    }

    #[test]
    fn one_thread_and_three_give_the_same_bits() {
        let noise: Vec<_> = (0..97 * 61u32).map(|i| Vec4::splat((i * 7919 % 1009) as f32 / 100.0)).collect();
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            let mut pixels = noise.clone();
            pool.install(|| Bloom { strength: 0.3, sigma_over_height: 0.1 }.apply(97, 61, &mut pixels));
            pixels
        };
        assert_eq!(run(1), run(3));
    }
}
