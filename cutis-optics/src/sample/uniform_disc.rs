//! Radii spread evenly over a disc: beside those of a profile, they find light that the profile looks for too rarely.

use super::{RadialSampler, in_lanes, in_unit, unit};
use core::f32::consts::PI;
use wide::f32x8;

/// Draws from the area of a disc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UniformDisc {
    radius_mm: f32,
}

impl UniformDisc {
    /// A disc. `None` unless the radius is above 0 and finite.
    pub fn new(radius_mm: f32) -> Option<Self> {
        (radius_mm > 0.0 && radius_mm.is_finite()).then_some(Self { radius_mm })
    }
}

impl RadialSampler for UniformDisc {
    fn radius_mm(&self, xi: f32) -> f32 {
        self.radius_mm * in_unit(xi).sqrt()
    }

    fn pdf_per_mm2(&self, radius_mm: f32) -> f32 {
        if radius_mm <= self.radius_mm { 1.0 / (PI * self.radius_mm * self.radius_mm) } else { 0.0 }
    }

    fn cdf(&self, radius_mm: f32) -> f32 {
        (radius_mm / self.radius_mm).min(1.0).powi(2)
    }

    fn radii_mm(&self, xi: &[f32], radii_mm: &mut [f32]) {
        in_lanes(xi, radii_mm, |xi| f32x8::splat(self.radius_mm) * unit(xi).sqrt());
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;

    #[test]
    fn a_disc_is_filled_evenly() {
        let disc = UniformDisc::new(3.0).unwrap();
        assert!((disc.pdf_per_mm2(2.9) * PI * 9.0 - 1.0).abs() < 1e-6);
        assert_eq!(disc.pdf_per_mm2(3.1), 0.0);
        for xi in [0.0, 0.04, 0.25, 0.81] {
            let r = disc.radius_mm(xi);
            assert!((r - 3.0 * xi.sqrt()).abs() < 1e-6 && (disc.cdf(r) - xi).abs() < 1e-6, "{xi}");
        }
        let mut radii = [0.0; 9];
        disc.radii_mm(&[0.25; 9], &mut radii);
        assert_eq!(radii, [disc.radius_mm(0.25); 9]);
        for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert_eq!(UniformDisc::new(bad), None);
        }
    }
}
