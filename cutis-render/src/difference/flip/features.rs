//! Edges and points: first and second derivatives of the lightness at the scale of the finest detail that is seen.

use super::plane::Plane;
use glam::Vec2;
use rayon::prelude::*;

/// Width of the filter in degrees (`w` in the paper): that of the eye's edge detectors.
const WIDTH_DEGREES: f64 = 0.082;

/// How much of an edge and of a point is at a pixel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Features {
    edge: f32,
    point: f32,
}

impl Features {
    /// The larger of the two differences, in 0..=√2.
    pub(super) fn distance(&self, other: &Self) -> f32 {
        (self.edge - other.edge).abs().max((self.point - other.point).abs())
    }
}

/// Derivatives of a Gaussian.
pub(super) struct FeatureFilter {
    gaussian: Vec<f32>,
    first: Vec<f32>,
    second: Vec<f32>,
}

impl FeatureFilter {
    pub(super) fn new(pixels_per_degree: f64) -> Self {
        let deviation = 0.5 * WIDTH_DEGREES * pixels_per_degree;
        let radius = (3.0 * deviation).ceil() as i32;
        let along = |of: &dyn Fn(f64, f64) -> f64| -> Vec<f64> {
            let at = |i: i32| {
                let x = f64::from(i);
                of(x, (-0.5 * (x / deviation).powi(2)).exp())
            };
            (-radius..=radius).map(at).collect()
        };
        Self {
            gaussian: balanced(&along(&|_, g| g)),
            first: balanced(&along(&|x, g| -x * g)),
            second: balanced(&along(&|x, g| ((x / deviation).powi(2) - 1.0) * g)),
        }
    }

    /// Features of a picture's opponent lightness.
    pub(super) fn of(&self, lightness: Plane) -> Vec<Features> {
        // To 0..=1, where black is 0 and white 1.
        let grey = lightness.map(|y| (y + 16.0) / 116.0);
        let magnitude = |derivative: &[f32]| {
            let across = grey.filtered(derivative, &self.gaussian);
            let down = grey.filtered(&self.gaussian, derivative);
            let pixels = across.values.into_par_iter().zip(down.values);
            pixels.map(|(x, y)| Vec2::new(x, y).length()).collect::<Vec<f32>>()
        };
        let (edges, points) = (magnitude(&self.first), magnitude(&self.second));
        edges.into_par_iter().zip(points).map(|(edge, point)| Features { edge, point }).collect()
    }
}

/// Weights above 0 add up to 1 and those below to -1.
fn balanced(weights: &[f64]) -> Vec<f32> {
    let above: f64 = weights.iter().filter(|&&w| w > 0.0).sum();
    let below: f64 = weights.iter().filter(|&&w| w < 0.0).sum();
    let balance = |&w: &f64| if w > 0.0 { w / above } else { w / -below.min(-f64::MIN_POSITIVE) };
    weights.iter().map(|w| balance(w) as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The opponent lightness of a grey.
    fn plane(width: usize, grey: Vec<f32>) -> Plane {
        Plane::new(width, grey.into_iter().map(|v| 116.0 * v - 16.0).collect())
    }

    #[test]
    fn nothing_is_found_where_nothing_is() {
        for features in FeatureFilter::new(67.0).of(plane(40, vec![0.5; 1600])) {
            // Sums of 19 · 19 rounded weights that cancel.
            assert!(features.edge < 1e-5 && features.point < 1e-5);
        }
    }

    #[test]
    fn a_step_is_an_edge_of_its_height() {
        let step = (0..60 * 60).map(|i| if i % 60 < 30 { 0.25 } else { 0.75 }).collect();
        let found = FeatureFilter::new(67.0).of(plane(60, step));
        // On one side of the step lies the middle weight, 0, so that the whole positive half is on the other.
        let at_step = found[30 * 60 + 30].edge.max(found[30 * 60 + 29].edge);
        assert!((at_step - 0.5).abs() < 1e-5, "{at_step}");
        assert!(found[30 * 60 + 5].edge < 1e-5);
    }

    #[test]
    fn features_are_no_larger_than_the_root_of_two() {
        let noise = (0..64 * 64_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 31) as f32).collect();
        for features in FeatureFilter::new(3.0).of(plane(64, noise)) {
            assert!(features.edge <= 1.4143 && features.point <= 1.4143);
        }
    }
}
