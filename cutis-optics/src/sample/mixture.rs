//! One set of radii for several profiles: red, green and blue share the samples of a renderer.
//!
//! A part of the mixture is picked by its share of `xi`, then a radius is drawn from it. The density is the sum of all parts'
//! densities by their shares, whichever part was picked: an estimator that divides by it follows the balance heuristic
//! (Veach & Guibas 1995, doi:10.1145/218380.218498, not opened) over the parts.

use super::{RadialSampler, in_unit};

/// Draws from one of several samplers.
pub struct MixtureSampler {
    /// Samplers, and up to which `xi` each of them is picked.
    parts: Vec<(f32, Box<dyn RadialSampler + Send + Sync>)>,
}

/// Without the samplers.
impl core::fmt::Debug for MixtureSampler {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let ends: Vec<f32> = self.parts.iter().map(|(end, _)| *end).collect();
        f.debug_struct("MixtureSampler").field("ends", &ends).finish_non_exhaustive()
    }
}

impl MixtureSampler {
    /// A mixture of samplers with shares that are above 0; these are scaled to sum 1. `None` if there is no such share.
    pub fn new(parts: Vec<(f64, Box<dyn RadialSampler + Send + Sync>)>) -> Option<Self> {
        let counts = |share: f64| share > 0.0 && share.is_finite();
        let parts: Vec<_> = parts.into_iter().filter(|(share, _)| counts(*share)).collect();
        let total: f64 = parts.iter().map(|(share, _)| share).sum();
        let mut below = 0.0;
        let ends: Vec<_> = parts
            .into_iter()
            .map(|(share, sampler)| {
                below += share / total;
                (below as f32, sampler)
            })
            .collect();
        (!ends.is_empty()).then_some(Self { parts: ends })
    }

    /// The radius that holds a share of the samples, mm; it grows with the share, unlike [`RadialSampler::radius_mm`].
    pub fn radius_holding(&self, share: f32) -> f32 {
        let (mut low, mut high) = (0.0, self.radius_mm(share).max(f32::MIN_POSITIVE));
        // A part may be a mixture itself, whose radii do not grow with the share.
        while self.cdf(high) < share && high < f32::MAX / 2.0 {
            high *= 2.0;
        }
        // Halvings to the last digit of a float.
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            *(if self.cdf(middle) < share { &mut low } else { &mut high }) = middle;
        }
        high
    }

    /// Shares of the parts with their samplers.
    fn shares(&self) -> impl Iterator<Item = (f32, &dyn RadialSampler)> {
        let from = std::iter::once(0.0).chain(self.parts.iter().map(|(end, _)| *end));
        from.zip(&self.parts)
            .map(|(from, (end, sampler))| (end - from, sampler.as_ref() as &dyn RadialSampler))
    }
}

impl RadialSampler for MixtureSampler {
    fn radius_mm(&self, xi: f32) -> f32 {
        let xi = in_unit(xi);
        let last = self.parts.len() - 1;
        let part = self.parts.partition_point(|(end, _)| *end <= xi).min(last);
        let from = if part == 0 { 0.0 } else { self.parts[part - 1].0 };
        let (end, sampler) = &self.parts[part];
        sampler.radius_mm((xi - from) / (end - from))
    }

    fn pdf_per_mm2(&self, radius_mm: f32) -> f32 {
        self.shares().map(|(share, sampler)| share * sampler.pdf_per_mm2(radius_mm)).sum()
    }

    fn cdf(&self, radius_mm: f32) -> f32 {
        self.shares().map(|(share, sampler)| share * sampler.cdf(radius_mm)).sum()
    }

    fn radii_mm(&self, xi: &[f32], radii_mm: &mut [f32]) {
        assert_eq!(xi.len(), radii_mm.len(), "a radius for every number");
        xi.iter().zip(radii_mm).for_each(|(&xi, radius_mm)| *radius_mm = self.radius_mm(xi));
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::sample::{DipoleSampler, GaussianSampler, XI_MAX};
    use crate::{Dipole, Gaussian, GaussianSum, Medium};
    use core::f64::consts::TAU;

    fn mixture() -> MixtureSampler {
        let dipole = Dipole::new(&Medium::new(0.05, 1.0, 1.4).unwrap()).unwrap();
        let sum = GaussianSum { terms: vec![Gaussian { weight: 1.0, variance_mm2: 0.04 }] };
        let parts: Vec<(f64, Box<dyn RadialSampler + Send + Sync>)> = vec![
            (3.0, Box::new(DipoleSampler::new(&dipole))),
            (0.0, Box::new(DipoleSampler::new(&dipole))),
            (1.0, Box::new(GaussianSampler::new(&sum).unwrap())),
        ];
        MixtureSampler::new(parts).unwrap()
    }

    #[test]
    fn the_density_is_that_of_the_radii() {
        let mixture = mixture();
        // By quadrature: the density integrates to the distribution.
        let (mut sum, step) = (0.0, 1e-3);
        for i in 0..40_000 {
            let r = (f64::from(i) + 0.5) * step;
            sum += TAU * r * f64::from(mixture.pdf_per_mm2(r as f32)) * step;
            if i % 5000 == 4999 {
                // The midpoint rule at (step/deviation)² = 2.5e-5, f32 densities.
                assert!(
                    (sum - f64::from(mixture.cdf(((f64::from(i) + 1.0) * step) as f32))).abs() < 3e-5,
                    "{r}"
                );
            }
        }
        // By counting: of n even xi, the share within any radius is the distribution's, but for one of each part.
        let n = 100_000;
        let mut radii: Vec<f32> = (0..n).map(|i| mixture.radius_mm((i as f32 + 0.5) / n as f32)).collect();
        radii.sort_by(f32::total_cmp);
        for i in (0..n).step_by(997) {
            assert!((mixture.cdf(radii[i]) - (i as f32 + 0.5) / n as f32).abs() < 5e-5, "{i}");
        }
    }

    #[test]
    fn a_radius_holds_its_share() {
        let mixture = mixture();
        for share in [0.01, 0.3, 0.5, 0.95, 0.999] {
            assert!((mixture.cdf(mixture.radius_holding(share)) - share).abs() < 1e-5, "{share}");
        }
    }

    #[test]
    fn ends_and_nothing_are_taken_care_of() {
        let mixture = mixture();
        for xi in [f32::NAN, -1.0, 0.0, 0.75, XI_MAX, 1.0, 2.0] {
            assert!(mixture.radius_mm(xi).is_finite() && mixture.radius_mm(xi) >= 0.0, "{xi}");
        }
        assert!(MixtureSampler::new(Vec::new()).is_none());
        let gaussian = GaussianSum { terms: vec![Gaussian { weight: 1.0, variance_mm2: 1.0 }] };
        for share in [0.0, -1.0, f64::NAN] {
            let sampler = Box::new(GaussianSampler::new(&gaussian).unwrap());
            assert!(MixtureSampler::new(vec![(share, sampler as _)]).is_none(), "{share}");
        }
    }
}
