//! Contrast sensitivity: fine patterns are seen as their mean, those of colour sooner than those of lightness.

use super::plane::Plane;
use glam::Vec3;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Sensitivity of each opponent channel as a sum of Gaussians (a, b): in frequency a exp(-b f²), f in cycles per degree;
/// in the picture a √(π/b) exp(-π² x²/b), x in degrees. Movshon & Kiorpes 1988 and Mullen 1985, by way of the paper.
const SENSITIVITIES: [&[(f64, f64)]; 3] =
    [&[(1.0, 0.0047)], &[(1.0, 0.0053)], &[(34.1, 0.04), (13.5, 0.025)]];

/// The largest b, which gives every channel the same radius: three standard deviations √(b / 2π²).
const WIDEST: f64 = 0.04;

/// One blur for each channel.
pub(super) struct ContrastFilter {
    /// Of each channel: Gaussians with their weights, which add up to 1.
    channels: [Vec<(f32, Vec<f32>)>; 3],
}

impl ContrastFilter {
    pub(super) fn new(pixels_per_degree: f64) -> Self {
        let radius = (3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as i32;
        Self { channels: SENSITIVITIES.map(|terms| channel(terms, radius, pixels_per_degree)) }
    }

    /// The blurred opponent colours.
    pub(super) fn filtered(&self, channels: &[Plane; 3]) -> Vec<Vec3> {
        let [y, x, z] = [0, 1, 2].map(|c| blurred(&channels[c], &self.channels[c]));
        let pixels = y.values.par_iter().zip(&x.values).zip(&z.values);
        pixels.map(|((&y, &x), &z)| Vec3::new(y, x, z)).collect()
    }
}

fn blurred(plane: &Plane, terms: &[(f32, Vec<f32>)]) -> Plane {
    let mut total = plane.map(|_| 0.0);
    for (weight, gaussian) in terms {
        let term = plane.filtered(gaussian, gaussian);
        total.values.par_iter_mut().zip(&term.values).for_each(|(to, from)| *to += weight * from);
    }
    total
}

/// A Gaussian of two dimensions is the product of two of one; a sum of Gaussians is not, so each term has its own.
fn channel(terms: &[(f64, f64)], radius: i32, pixels_per_degree: f64) -> Vec<(f32, Vec<f32>)> {
    let term = |&(a, b): &(f64, f64)| {
        let at = |i: i32| (-(PI * f64::from(i) / pixels_per_degree).powi(2) / b).exp();
        let values: Vec<f64> = (-radius..=radius).map(at).collect();
        let sum: f64 = values.iter().sum();
        let normalised = values.iter().map(|v| (v / sum) as f32).collect::<Vec<f32>>();
        (a * (PI / b).sqrt() * sum * sum, normalised)
    };
    let terms: Vec<_> = terms.iter().map(term).collect();
    let total: f64 = terms.iter().map(|(weight, _)| weight).sum();
    terms.into_iter().map(|(weight, gaussian)| ((weight / total) as f32, gaussian)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_colours_stay() {
        let filter = ContrastFilter::new(67.0);
        let planes = [20.0, -30.0, 50.0].map(|v| Plane::new(30, vec![v; 900]));
        for colour in filter.filtered(&planes) {
            // 21 + 21 products, weights rounded: below 50 ε relative.
            assert!((colour - Vec3::new(20.0, -30.0, 50.0)).abs().max_element() < 3e-4, "{colour}");
        }
    }

    #[test]
    fn the_radius_at_67_pixels_per_degree_is_ten() {
        // 3 √(0.04 / 2π²) 67 = 9.05.
        for terms in ContrastFilter::new(67.0).channels {
            assert!(terms.iter().all(|(_, gaussian)| gaussian.len() == 21));
        }
    }

    #[test]
    fn the_blur_is_the_sum_over_the_square() {
        // One lit pixel in the middle becomes the kernel itself: compared with the formula in two dimensions.
        let (size, middle) = (23, 11);
        let mut values = vec![0.0; size * size];
        values[middle * size + middle] = 1.0;
        let planes = [0, 1, 2].map(|_| Plane::new(size, values.clone()));
        let found = ContrastFilter::new(67.0).filtered(&planes);
        for (c, terms) in SENSITIVITIES.iter().enumerate() {
            let kernel = |x: i32, y: i32| -> f64 {
                let d2 = f64::from(x * x + y * y) / (67.0 * 67.0);
                terms.iter().map(|(a, b)| a * (PI / b).sqrt() * (-PI * PI * d2 / b).exp()).sum()
            };
            let square = (-10..=10).flat_map(|y| (-10..=10).map(move |x| (x, y)));
            let total: f64 = square.clone().map(|(x, y)| kernel(x, y)).sum();
            for (x, y) in square {
                let index = (middle as i32 + y) as usize * size + (middle as i32 + x) as usize;
                let expected = kernel(x, y) / total;
                assert!((f64::from(found[index][c]) - expected).abs() < 1e-6 * expected.max(0.01));
            }
        }
    }
}
