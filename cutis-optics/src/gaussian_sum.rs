//! Radial profiles as sums of Gaussians (d'Eon, Luebke & Enderton 2007, section 4).
//!
//! Symbols: G(v, r) = e^(-r²/2v) / (2 pi v) of unit total, `v` variance along one axis, `w` weight.
//! In spatial frequency G is e^(-v k²/2). Convolution over the plane adds variances (eq. 11).

use crate::Profile;
use core::f64::consts::TAU;

/// One term: `weight * G(variance, r)`, with G(v, r) = exp(-r²/2v) / (2 pi v) of unit total.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Gaussian {
    /// Share of the energy.
    pub weight: f64,
    /// Variance along one axis, mm².
    pub variance_mm2: f64,
}

/// A profile of one channel.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct GaussianSum {
    /// Terms by growing variance.
    pub terms: Vec<Gaussian>,
}

impl Gaussian {
    /// Value at distance `r_mm`, 1/mm².
    pub fn at_mm(&self, r_mm: f64) -> f64 {
        let v = self.variance_mm2;
        self.weight * (-0.5 * r_mm * r_mm / v).exp() / (TAU * v)
    }

    /// Hankel transform w e^(-v k²/2) at `k_per_mm`, no unit.
    pub fn spectrum(&self, k_per_mm: f64) -> f64 {
        self.weight * (-0.5 * self.variance_mm2 * k_per_mm * k_per_mm).exp()
    }

    /// Weight left when the light has crossed `thickness_mm` on its way: w e^(-d²/2v).
    ///
    /// d'Eon et al. 2007, eq. 16: G(v, sqrt(r² + d²)) = e^(-d²/2v) G(v, r). The paper prints e^(-d²/v), which does not
    /// follow from its own G (eq. 8).
    pub fn slab_weight(&self, thickness_mm: f64) -> f64 {
        self.weight * (-0.5 * thickness_mm * thickness_mm / self.variance_mm2).exp()
    }
}

impl GaussianSum {
    /// A sum of the given terms, sorted by variance.
    pub fn new(mut terms: Vec<Gaussian>) -> Self {
        terms.sort_by(|a, b| a.variance_mm2.total_cmp(&b.variance_mm2));
        Self { terms }
    }

    /// The profile after both scatterings, one over the other: all pairs of terms, weights multiplied, variances added
    /// (d'Eon et al. 2007, eq. 12). The number of terms is the product of both.
    pub fn convolved(&self, other: &Self) -> Self {
        let pair = |a: &Gaussian, b: &Gaussian| Gaussian {
            weight: a.weight * b.weight,
            variance_mm2: a.variance_mm2 + b.variance_mm2,
        };
        Self::new(self.terms.iter().flat_map(|a| other.terms.iter().map(move |b| pair(a, b))).collect())
    }

    /// The profile seen through `thickness_mm` of the material, R(sqrt(r² + d²)) (see [`Gaussian::slab_weight`]).
    pub fn slab(&self, thickness_mm: f64) -> Self {
        let through = |g: &Gaussian| Gaussian { weight: g.slab_weight(thickness_mm), ..*g };
        Self { terms: self.terms.iter().map(through).collect() }
    }

    /// Neighbouring terms whose variances differ by at most `relative_tolerance` become one, at the weighted mean variance
    /// (kept weight and second moment); with a tolerance of 0 only equal ones.
    pub fn merged(&self, relative_tolerance: f64) -> Self {
        let mut merged: Vec<Gaussian> = Vec::with_capacity(self.terms.len());
        for term in &Self::new(self.terms.clone()).terms {
            match merged.last_mut() {
                Some(last) if term.variance_mm2 <= last.variance_mm2 * (1.0 + relative_tolerance) => {
                    last.absorb(term);
                }
                _ => merged.push(*term),
            }
        }
        Self { terms: merged }
    }

    /// At most `count` terms: where there are more, each becomes a mixture of its two neighbours in a sparser set that keeps
    /// its weight and its variance (d'Eon, Luebke & Enderton 2007, section 5.1). The set is a geometric sequence from the
    /// variance below which a hundredth of the weight lies to that beyond which a thousandth does; what little lies outside
    /// is taken by its ends.
    pub fn sparse(&self, count: usize) -> Self {
        if self.terms.len() <= count || count == 0 {
            return self.clone();
        }
        let (from, to) = (self.quantile_mm2(0.01), self.quantile_mm2(0.999));
        let place = |i: usize| if count == 1 { 1.0 } else { i as f64 / (count - 1) as f64 };
        let variances: Vec<f64> = (0..count).map(|i| from * (to / from).powf(place(i))).collect();
        self.on_variances(&variances)
    }

    /// The same weight and variance, term by term, on given variances (mm², growing). A term outside their range becomes the
    /// first or the last of them and keeps its weight only.
    ///
    /// # Panics
    /// If there are no variances.
    pub fn on_variances(&self, variances_mm2: &[f64]) -> Self {
        let mut terms: Vec<Gaussian> =
            variances_mm2.iter().map(|&variance_mm2| Gaussian { weight: 0.0, variance_mm2 }).collect();
        let last = terms.len() - 1;
        for &Gaussian { weight, variance_mm2 } in &self.terms {
            let upper = variances_mm2.partition_point(|&v| v <= variance_mm2);
            if upper == 0 || upper > last {
                terms[upper.min(last)].weight += weight;
                continue;
            }
            let (a, b) = (variances_mm2[upper - 1], variances_mm2[upper]);
            let share = (variance_mm2 - a) / (b - a);
            terms[upper - 1].weight += weight * (1.0 - share);
            terms[upper].weight += weight * share;
        }
        Self { terms }
    }

    /// The variance below which a share of all weight (signs left out) lies, mm².
    fn quantile_mm2(&self, share: f64) -> f64 {
        let all: f64 = self.terms.iter().map(|g| g.weight.abs()).sum();
        let mut below = 0.0;
        let first = self.terms.iter().find(|g| {
            below += g.weight.abs();
            below >= share * all
        });
        first.or(self.terms.last()).map_or(0.0, |g| g.variance_mm2)
    }

    /// Sum of all weights: the energy.
    pub fn energy(&self) -> f64 {
        self.terms.iter().map(|g| g.weight).sum()
    }
}

impl Gaussian {
    fn absorb(&mut self, other: &Self) {
        let weight = self.weight + other.weight;
        // Weights that cancel have no mean variance: keep the narrower one, with weight 0. Equal ones need no mean.
        if weight != 0.0 && self.variance_mm2 != other.variance_mm2 {
            let moment = self.weight * self.variance_mm2 + other.weight * other.variance_mm2;
            self.variance_mm2 = moment / weight;
        }
        self.weight = weight;
    }
}

impl Profile for GaussianSum {
    fn spectrum(&self, k_per_mm: f64) -> f64 {
        self.terms.iter().map(|g| g.spectrum(k_per_mm)).sum()
    }

    fn at_mm(&self, r_mm: f64) -> f64 {
        self.terms.iter().map(|g| g.at_mm(r_mm)).sum()
    }

    fn total(&self) -> f64 {
        self.energy()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::oracle::{hankel, simpson};
    use proptest::prelude::*;

    fn sum(terms: &[(f64, f64)]) -> GaussianSum {
        GaussianSum::new(
            terms.iter().map(|&(weight, variance_mm2)| Gaussian { weight, variance_mm2 }).collect(),
        )
    }

    #[test]
    fn spectrum_is_the_hankel_transform() {
        let s = sum(&[(0.2, 0.05), (0.5, 0.4), (-0.1, 3.0)]);
        for k in [0.0, 0.3, 1.0, 3.0] {
            // r stops at 9 standard deviations of the widest (e^-40), starts where the disc left out is 1e-14.
            let slow = hankel(k, 1e-8, 9.0 * 3_f64.sqrt(), |r| s.at_mm(r));
            assert!((s.spectrum(k) - slow).abs() < 1e-9, "{k}: {} against {slow}", s.spectrum(k));
        }
    }

    #[test]
    fn convolution_meets_the_plane_integral() {
        let (a, b) = (sum(&[(0.7, 0.3), (0.2, 1.5)]), sum(&[(0.6, 0.5)]));
        // ∫∫ a(|x|) b(|x - (0.8, 0)|) dx dy on a square: Simpson, 9 standard deviations either way.
        let line = |y: f64| simpson(-12.0, 12.0, 400, |x| a.at_mm(x.hypot(y)) * b.at_mm((x - 0.8).hypot(y)));
        let slow = simpson(-12.0, 12.0, 400, line);
        let ours = a.convolved(&b).at_mm(0.8);
        assert!((ours / slow - 1.0).abs() < 1e-9, "{ours} against {slow}");
    }

    #[test]
    fn slab_is_the_profile_at_the_slanted_distance() {
        let s = sum(&[(0.2, 0.05), (0.5, 0.4)]);
        for (r, d) in [(0.0_f64, 0.3_f64), (0.5, 0.2), (1.0, 1.0)] {
            let (ours, direct) = (s.slab(d).at_mm(r), s.at_mm(r.hypot(d)));
            // Rounding of an exponent near 20 (r² + d² over 2v): 20 ulps on the value, twice.
            assert!((ours / direct - 1.0).abs() < 60.0 * f64::EPSILON, "{ours} against {direct}");
        }
    }

    #[test]
    fn merging_keeps_weight_and_second_moment() {
        let s = sum(&[(0.3, 1.0), (0.1, 1.05), (0.2, 1.0), (0.4, 2.0)]);
        assert_eq!(s.merged(0.0).terms.len(), 3);
        let m = s.merged(0.1);
        assert_eq!(m.terms.len(), 2);
        let moment = |s: &GaussianSum| s.terms.iter().map(|g| g.weight * g.variance_mm2).sum::<f64>();
        assert!((m.energy() - 1.0).abs() < 4.0 * f64::EPSILON);
        assert!((moment(&m) - moment(&s)).abs() < 8.0 * f64::EPSILON);
    }

    #[test]
    fn a_sparser_set_keeps_weight_and_variance() {
        let dense =
            sum(&[(0.05, 0.1), (0.3, 0.2), (0.2, 0.5), (0.1, 0.9), (0.05, 1.7), (-0.02, 2.0), (0.1, 4.0)]);
        for count in [2, 3, 5] {
            let sparse = dense.sparse(count);
            assert_eq!(sparse.terms.len(), count);
            let moment = |s: &GaussianSum| s.terms.iter().map(|g| g.weight * g.variance_mm2).sum::<f64>();
            assert!((sparse.energy() - dense.energy()).abs() < 1e-15);
            assert!((moment(&sparse) - moment(&dense)).abs() < 1e-14, "{count}");
        }
        assert_eq!(dense.sparse(7), dense);
        assert!((dense.sparse(1).energy() - dense.energy()).abs() < 1e-15);
        // On its own variances it is itself; what lies outside goes to the ends.
        let own: Vec<f64> = dense.terms.iter().map(|g| g.variance_mm2).collect();
        assert_eq!(dense.on_variances(&own), dense);
        let ends = dense.on_variances(&[0.3, 1.0]);
        assert!((ends.energy() - dense.energy()).abs() < 1e-15);
        assert!(ends.terms[0].weight > 0.35, "{ends:?}");
    }

    proptest! {
        #[test]
        fn convolution_multiplies_spectra(v1 in 1e-3..10.0_f64, v2 in 1e-3..10.0_f64, k in 0.0..3.0_f64) {
            let (a, b) = (sum(&[(0.4, v1), (0.3, v2)]), sum(&[(0.9, v2), (0.1, 0.5 * v1)]));
            let product = a.spectrum(k) * b.spectrum(k);
            // Exponents up to 90: an ulp of the exponent is 90 ulps of the value; a few such.
            prop_assert!((a.convolved(&b).spectrum(k) - product).abs() <= 400.0 * f64::EPSILON * product.abs());
        }
    }
}
