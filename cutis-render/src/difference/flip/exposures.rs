//! FLIP without limit of brightness: both pictures are shown at several exposures, and each pixel has the largest error
//! of all of them. The reference says which exposures: from its brightest light to its median.

use super::{Filters, FlipMap};
use crate::difference::{Pair, luminance};
use glam::Vec3;
use rayon::prelude::*;

/// ACES' filmic curve as fitted by Narkowicz 2015, (a x² + b x + c) / (d x² + e x + f), with the factor of 0.6 before it
/// that FLIP's authors give it.
const CURVE: [f64; 6] = [0.6 * 0.6 * 2.51, 0.6 * 0.03, 0.0, 0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14];
/// What the curve shall make of the brightest light at the first exposure, and of the median at the last.
const SHOWN: f64 = 0.85;

/// Darkest light that is told from none, in the picture's unit; the authors' code has the same.
const LEAST_LIGHT: f32 = f32::EPSILON;

/// Which exposures are looked at, in stops.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exposures {
    /// The darkest: highlights are told apart.
    pub start_ev: f64,
    /// The brightest: half of the picture is nearly white.
    pub stop_ev: f64,
    /// How many, evenly from one to the other; at least 2.
    pub count: u32,
}

impl Exposures {
    /// Those that show all of a reference. Light below [`LEAST_LIGHT`] is taken for that much, so that a picture that is
    /// mostly black has exposures, too.
    pub fn of(reference: &[Vec3]) -> Self {
        let mut luminances: Vec<f32> = reference.par_iter().map(|&colour| luminance(colour)).collect();
        let brightest = luminances.iter().copied().fold(LEAST_LIGHT, f32::max);
        let middle = median(&mut luminances).max(LEAST_LIGHT);
        let white = light_shown_as(SHOWN);
        let [start_ev, stop_ev] = [brightest, middle].map(|light| (white / f64::from(light)).log2());
        Self { start_ev, stop_ev, count: ((stop_ev - start_ev).ceil() as u32).max(2) }
    }

    /// Each of them.
    fn all(&self) -> impl Iterator<Item = f64> {
        let Self { start_ev, stop_ev, count } = *self;
        (0..count).map(move |i| start_ev + (stop_ev - start_ev) * f64::from(i) / f64::from(count - 1))
    }
}

/// FLIP of pictures without limit of brightness.
#[derive(Debug, Clone, PartialEq)]
pub struct HdrFlip {
    /// The largest error of each pixel.
    pub map: FlipMap,
    /// The exposures that were looked at.
    pub exposures: Exposures,
}

/// FLIP of two pictures in scene-linear Rec. 709, which has no limit; the unit does not matter.
///
/// # Panics
/// If `pixels_per_degree` is not a number of at least 1.
pub fn hdr_flip(pair: Pair<'_>, pixels_per_degree: f64) -> HdrFlip {
    let filters = Filters::new(pixels_per_degree);
    let exposures = Exposures::of(pair.reference);
    let mut worst = vec![0.0_f32; pair.test.len()];
    for ev in exposures.all() {
        let gain = ev.exp2() as f32;
        let errors = filters.errors(pair.test, pair.reference, pair.width, |pixel| shown(pixel * gain));
        worst.par_iter_mut().zip(errors).for_each(|(worst, error)| *worst = worst.max(error));
    }
    HdrFlip { map: FlipMap::new(worst), exposures }
}

/// The curve, in 0..=1.
fn shown(colour: Vec3) -> Vec3 {
    let [a, b, c, d, e, f] = CURVE.map(|v| v as f32);
    // Beyond this the curve is flat, and squares stay finite.
    let x = colour.clamp(Vec3::ZERO, Vec3::splat(1e6));
    (x * (a * x + b) + c) / (x * (d * x + e) + f)
}

/// The light that the curve shows as `value`: the larger root of a quadratic.
fn light_shown_as(value: f64) -> f64 {
    let [a, b, c] = [0, 1, 2].map(|i| CURVE[i] - value * CURVE[i + 3]);
    let half = -0.5 * b / a;
    half + (half * half - c / a).sqrt()
}

/// The median, of an even number the upper of the middle two, as in the authors' code; 0 for nothing. Changes the order.
fn median(values: &mut [f32]) -> f32 {
    if values.is_empty() {
        return 0.0;
    }
    *values.select_nth_unstable_by(values.len() / 2, f32::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_in_the_middle() {
        assert_eq!(median(&mut [3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&mut [4.0, 1.0, 2.0, 3.0]), 3.0);
        assert_eq!((median(&mut [5.0]), median(&mut [])), (5.0, 0.0));
    }

    #[test]
    fn the_brightest_and_the_median_are_shown_as_asked() {
        let reference: Vec<_> = (0..100).map(|i| Vec3::splat(0.5 * 1.1_f32.powi(i % 64))).collect();
        let exposures = Exposures::of(&reference);
        let of = |light: f32, ev: f64| shown(Vec3::splat(light) * ev.exp2() as f32).x;
        let mut luminances: Vec<f32> = reference.iter().map(|&c| luminance(c)).collect();
        let brightest = luminances.iter().copied().fold(0.0, f32::max);
        // Rounding of an exposure and of the curve.
        assert!((of(brightest, exposures.start_ev) - 0.85).abs() < 1e-5);
        assert!((of(median(&mut luminances), exposures.stop_ev) - 0.85).abs() < 1e-5);
        let all: Vec<_> = exposures.all().collect();
        assert_eq!((all[0], all.len()), (exposures.start_ev, exposures.count as usize));
        assert!((all[all.len() - 1] - exposures.stop_ev).abs() < 1e-12);
    }

    #[test]
    fn black_pictures_have_exposures_too() {
        let dark = Exposures::of(&[Vec3::ZERO; 4]);
        assert!(dark.start_ev.is_finite() && dark.start_ev == dark.stop_ev && dark.count == 2);
        let mostly = Exposures::of(&[Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, Vec3::splat(4.0)]);
        assert!(mostly.start_ev < mostly.stop_ev && mostly.stop_ev == dark.stop_ev, "{mostly:?}");
    }
}
