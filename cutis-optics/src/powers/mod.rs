//! Layers as polynomials: sums of Gaussians whose variances are multiples of one (d'Eon, Luebke & Enderton 2007, equations
//! 13 to 15).
//!
//! With Gaussians {G(v), G(2v), G(3v), …} convolution is multiplication of polynomials, so that layers combine without any
//! transform: R12+ = R1+ + T1+ R2+ T1- (1 + X + X² + …), X = R2+ R1-. The series of reflections to and fro ends when what it
//! still misses of the closed total is below epsilon (eq. 13).
//! The weights need no fit: a pole is an integral over Gaussians of every variance ([`crate::Pole`]), and the trapezoid rule
//! with step v is all there is to do. The integrand and all its derivatives vanish at variance 0, so the rule errs only by
//! about 2 e^(-z sqrt(2 pi/v)) of a pole at depth z (Poisson summation), here spread over all terms so that every total stays
//! the closed one.

mod layers;

pub(crate) use layers::of_half_space;
pub use layers::{PowersError, PowersFit, PowersSettings};

use crate::{Gaussian, GaussianSum, Pole};

/// A sum of Gaussians of variances unit, 2 unit, 3 unit, …
#[derive(Debug, Clone, PartialEq)]
pub struct Powers {
    /// The variance that all others are multiples of, mm².
    pub unit_mm2: f64,
    /// Weights; the first is that of the unit itself.
    pub weights: Vec<f64>,
}

impl Powers {
    /// Poles by the trapezoid rule. `poles_at` gives those that count at a variance; `total` is that of all together, and
    /// `beyond` the weight of everything wider than the last term, which that one takes.
    pub(crate) fn of_poles<P: IntoIterator<Item = Pole>>(
        unit_mm2: f64,
        terms: usize,
        poles_at: impl Fn(f64) -> P,
        beyond: impl Fn(f64) -> f64,
        total: f64,
    ) -> Self {
        let weight = |n: usize| {
            let variance_mm2 = n as f64 * unit_mm2;
            unit_mm2 * poles_at(variance_mm2).into_iter().map(|p| p.weight_per_mm2(variance_mm2)).sum::<f64>()
        };
        let mut weights: Vec<f64> = (1..=terms).map(weight).collect();
        let tail = beyond((terms as f64 + 0.5) * unit_mm2);
        let sum = weights.iter().sum::<f64>();
        if sum != 0.0 {
            weights.iter_mut().for_each(|w| *w *= (total - tail) / sum);
        }
        // What is wider than all terms; that is all of it where the terms do not reach the nearest source.
        let rest = total - weights.iter().sum::<f64>();
        if let Some(last) = weights.last_mut() {
            *last += rest;
        }
        Self { unit_mm2, weights }
    }

    /// One after the other, cut after `terms_max` terms; what lies beyond is taken by the last.
    pub fn convolved(&self, other: &Self, terms_max: usize) -> Self {
        let (short, long) = if self.weights.len() < other.weights.len() {
            (&self.weights, &other.weights)
        } else {
            (&other.weights, &self.weights)
        };
        let length = if short.is_empty() { 0 } else { (short.len() + long.len()).min(terms_max) };
        let mut weights = multiplied(short, long, length);
        let missing = self.energy() * other.energy() - weights.iter().sum::<f64>();
        if let Some(last) = weights.last_mut() {
            *last += missing;
        }
        Self { unit_mm2: self.unit_mm2, weights }
    }

    /// Both together.
    pub fn plus(&self, other: &Self) -> Self {
        let (mut longer, shorter) = if self.weights.len() < other.weights.len() {
            (other.clone(), self)
        } else {
            (self.clone(), other)
        };
        longer.weights.iter_mut().zip(&shorter.weights).for_each(|(a, b)| *a += b);
        longer
    }

    /// Sum of all weights.
    pub fn energy(&self) -> f64 {
        self.weights.iter().sum()
    }

    /// As a sum of Gaussians; terms without weight are left out.
    pub fn sum(&self) -> GaussianSum {
        let term =
            |(i, &weight): (usize, &f64)| Gaussian { weight, variance_mm2: (i + 1) as f64 * self.unit_mm2 };
        GaussianSum { terms: self.weights.iter().enumerate().map(term).filter(|g| g.weight != 0.0).collect() }
    }
}

/// Rows of a product that are added at a time: each sum is loaded and stored once for so many of them.
const ROWS: usize = 4;

/// The first `length` weights of a product: (i + 1) + (j + 1) units stand at index i + j + 1.
fn multiplied(short: &[f64], long: &[f64], length: usize) -> Vec<f64> {
    let margin = [0.0; ROWS - 1];
    let padded = [&margin, long, &margin].concat();
    let mut weights = vec![0.0; length];
    for (block, factors) in short.chunks(ROWS).enumerate() {
        let mut f = [0.0; ROWS];
        f[..factors.len()].copy_from_slice(factors);
        let Some(places) = weights.get_mut(block * ROWS + 1..) else { break };
        let count = places.len().min(long.len() + ROWS - 1);
        let [a, b, c, d] = [3, 2, 1, 0].map(|shift| &padded[shift..shift + count]);
        for (j, place) in places[..count].iter_mut().enumerate() {
            *place += f[0] * a[j] + f[1] * b[j] + f[2] * c[j] + f[3] * d[j];
        }
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Profile;

    fn powers(weights: &[f64]) -> Powers {
        Powers { unit_mm2: 0.1, weights: weights.to_vec() }
    }

    #[test]
    fn convolution_is_the_product_of_polynomials() {
        // Longer than a block of rows, in both orders.
        let a = powers(&[0.3, -0.1, 0.2, 0.05, 0.4, 0.01, 0.3]);
        let b = powers(&[0.5, 0.25, 0.1, -0.05, 0.2]);
        for (a, b) in [(&a, &b), (&b, &a)] {
            let product = a.convolved(b, 100);
            let slow = a.sum().convolved(&b.sum()).merged(1e-9);
            assert_eq!(product.weights[0], 0.0);
            assert_eq!(product.sum().terms.len(), slow.terms.len());
            for k in [0.0, 1.0, 5.0] {
                assert!((product.sum().spectrum(k) - slow.spectrum(k)).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn what_is_cut_off_goes_to_the_last_term() {
        let a = powers(&[0.3, 0.1, 0.2, 0.05]);
        let cut = a.convolved(&a, 5);
        assert_eq!(cut.weights.len(), 5);
        assert!((cut.energy() - a.energy() * a.energy()).abs() < 1e-15);
        assert_eq!(cut.weights[..4], a.convolved(&a, 100).weights[..4]);
        assert!(a.convolved(&powers(&[]), 5).weights.is_empty());
    }

    #[test]
    fn a_pole_is_met_as_well_as_the_trapezoid_rule_promises() {
        let pole = Pole { power: 1.0, depth_mm: 1.0, sigma_tr_per_mm: 0.5 };
        for (unit_mm2, digits) in [(0.25, 0.0134), (0.125, 0.00168), (0.0625, 8.9e-5)] {
            let terms = (60.0 / unit_mm2) as usize;
            let powers =
                Powers::of_poles(unit_mm2, terms, |_| [pole], |v| pole.weight_beyond(v), pole.total());
            assert!((powers.energy() - pole.total()).abs() < 1e-15);
            for k in [0.3f64, 1.0, 2.0] {
                let exact = 0.5 * (-k.hypot(0.5)).exp();
                // 2 e^(-z sqrt(2 pi/v)), which is the number beside the unit, of half the pole's power; it is met twice, at k
                // and, by the scaling, at 0.
                let off = (powers.sum().spectrum(k) - exact).abs();
                assert!(off < digits, "{unit_mm2}, {k}: {off:e}");
            }
        }
    }
}
