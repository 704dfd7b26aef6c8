//! Radii of a sum of Gaussians: one term is chosen by its weight, then its distribution is inverted.
//!
//! Symbols: v variance along one axis, w weight. Within r lies the share 1 - e^(-r²/2v) of one term, so that
//! r = sqrt(-2 v ln(1 - xi)). The part of `xi` that chose the term is used up; what is left of it, made even again, gives r.

use super::{RadialSampler, SamplerError, in_lanes, odds, unit};
use crate::{GaussianSum, Profile};
use wide::f32x8;

/// Variances that stay far from the ends of f32, mm².
const VARIANCES_MM2: core::ops::RangeInclusive<f64> = 1e-30..=1e30;

/// Draws from a [`GaussianSum`] without negative weights.
#[derive(Debug, Clone, PartialEq)]
pub struct GaussianSampler {
    sum: GaussianSum,
    choices: Vec<Choice>,
}

/// The interval of `xi` that one term has, up to where the next begins.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Choice {
    to: f32,
    /// sqrt(2 v): its square would leave f32 for small `xi`.
    spread_mm: f32,
}

impl GaussianSampler {
    /// The sampler of a sum: one for each channel.
    ///
    /// # Errors
    /// If a weight is negative, a variance no width, or the energy not above 0 and finite.
    pub fn new(sum: &GaussianSum) -> Result<Self, SamplerError> {
        let total = sum.energy();
        for term in &sum.terms {
            if term.weight < 0.0 {
                return Err(SamplerError::NegativeWeight { weight: term.weight });
            }
            if !VARIANCES_MM2.contains(&term.variance_mm2) {
                return Err(SamplerError::Variance { variance_mm2: term.variance_mm2 });
            }
        }
        if !(total > 0.0 && total.is_finite()) {
            return Err(SamplerError::Total { total });
        }
        let mut sum = GaussianSum::new(sum.terms.iter().copied().filter(|g| g.weight > 0.0).collect());
        sum.terms.iter_mut().for_each(|g| g.weight /= total);
        let mut to = 0.0;
        let mut choices: Vec<Choice> = Vec::with_capacity(sum.terms.len());
        for term in &sum.terms {
            to += term.weight;
            choices.push(Choice { to: to as f32, spread_mm: (2.0 * term.variance_mm2).sqrt() as f32 });
        }
        if let Some(last) = choices.last_mut() {
            last.to = 1.0; // Whatever the sum was rounded to.
        }
        Ok(Self { sum, choices })
    }

    #[inline(always)]
    fn radii(&self, xi: f32x8) -> f32x8 {
        let xi = unit(xi);
        let first = &self.choices[0];
        let (mut from, mut to) = (f32x8::ZERO, f32x8::splat(first.to));
        let mut spread_mm = f32x8::splat(first.spread_mm);
        for choice in &self.choices[1..] {
            let before = xi.simd_lt(to);
            from = before.select(from, to);
            spread_mm = before.select(spread_mm, f32x8::splat(choice.spread_mm));
            to = before.select(to, f32x8::splat(choice.to));
        }
        spread_mm * odds(xi, from, to).ln_1p().sqrt()
    }
}

impl RadialSampler for GaussianSampler {
    fn radius_mm(&self, xi: f32) -> f32 {
        self.radii(f32x8::splat(xi)).to_array()[0]
    }

    fn pdf_per_mm2(&self, radius_mm: f32) -> f32 {
        self.sum.at_mm(f64::from(radius_mm)) as f32
    }

    fn cdf(&self, radius_mm: f32) -> f32 {
        let square_mm2 = f64::from(radius_mm) * f64::from(radius_mm);
        let within = |g: &crate::Gaussian| -g.weight * (-0.5 * square_mm2 / g.variance_mm2).exp_m1();
        self.sum.terms.iter().map(within).sum::<f64>() as f32
    }

    fn radii_mm(&self, xi: &[f32], radii_mm: &mut [f32]) {
        in_lanes(xi, radii_mm, |xi| self.radii(xi));
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::Gaussian;
    use crate::sample::XI_MAX;

    fn sampler(terms: &[(f64, f64)]) -> Result<GaussianSampler, SamplerError> {
        let term = |&(weight, variance_mm2): &(f64, f64)| Gaussian { weight, variance_mm2 };
        GaussianSampler::new(&GaussianSum { terms: terms.iter().map(term).collect() })
    }

    #[test]
    fn one_gaussian_is_inverted() {
        for variance_mm2 in [1e-18, 0.4, 1e18] {
            let one = sampler(&[(0.3, variance_mm2)]).unwrap();
            for xi in [1e-30f32, 1e-6, 0.1, 0.5, 0.9, 0.999_999, XI_MAX] {
                let by_hand = (-2.0 * variance_mm2 * f64::from(-xi).ln_1p()).sqrt();
                let r = one.radius_mm(xi);
                // Half of the logarithm's last three digits, and those of the root and the product.
                let off = (f64::from(r) / by_hand - 1.0).abs();
                assert!(off < 4.0 * f64::from(f32::EPSILON), "{xi}: {r} against {by_hand}");
                assert!((one.cdf(r) - xi).abs() < 4.0 * f32::EPSILON, "{xi}: {}", one.cdf(r));
            }
        }
    }

    #[test]
    fn each_term_gets_its_share_of_xi() {
        let two = sampler(&[(0.5, 4.0), (0.25, 1.0), (0.0, 2.0), (0.25, 9.0)]).unwrap();
        // Sorted by variance: [0, 1/4) is the narrow one, [1/4, 3/4) the middle one; the middle of each is its median.
        let median = |variance: f32| (2.0 * variance * core::f32::consts::LN_2).sqrt();
        for (xi, variance) in [(0.125, 1.0), (0.5, 4.0), (0.875, 9.0)] {
            assert!((two.radius_mm(xi) / median(variance) - 1.0).abs() < 4.0 * f32::EPSILON, "{xi}");
        }
        assert_eq!([0.25, 0.75, 0.0].map(|xi| two.radius_mm(xi)), [0.0; 3]);
    }

    #[test]
    fn what_is_no_density_is_refused() {
        let refused = |terms: &[(f64, f64)]| sampler(terms).unwrap_err();
        assert_eq!(refused(&[(0.5, 1.0), (-0.1, 2.0)]), SamplerError::NegativeWeight { weight: -0.1 });
        assert_eq!(refused(&[(0.5, 0.0)]), SamplerError::Variance { variance_mm2: 0.0 });
        assert_eq!(refused(&[]), SamplerError::Total { total: 0.0 });
        assert!(matches!(refused(&[(f64::NAN, 1.0)]), SamplerError::Total { .. }));
        assert!(matches!(refused(&[(1.0, f64::NAN)]), SamplerError::Variance { .. }));
    }
}
