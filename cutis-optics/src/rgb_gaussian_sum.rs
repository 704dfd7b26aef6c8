//! Three channels over shared variances: one blur serves red, green and blue (d'Eon, Luebke & Enderton 2007, section 5.1).

use crate::{Gaussian, GaussianSum};

/// A profile of red, green and blue over shared variances: what the blur passes of a renderer need.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RgbGaussianSum {
    /// Variances along one axis, growing, mm².
    pub variances_mm2: Vec<f64>,
    /// Weights of red, green and blue for each variance.
    pub weights: Vec<[f64; 3]>,
}

impl RgbGaussianSum {
    /// Rows of `(variance in mm², weights of red, green, blue)`, sorted by variance.
    pub fn from_rows(mut rows: Vec<(f64, [f64; 3])>) -> Self {
        rows.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (variances_mm2, weights) = rows.into_iter().unzip();
        Self { variances_mm2, weights }
    }

    /// Three sums over different variances: the union of their terms, equal variances becoming one row. Exact, but three
    /// times as many blurs as a joint fit needs ([`crate::fit_rgb`]).
    pub fn from_channels(channels: &[GaussianSum; 3]) -> Self {
        let row = |channel: usize, g: &Gaussian| {
            let mut weights = [0.0; 3];
            weights[channel] = g.weight;
            (g.variance_mm2, weights)
        };
        let terms = (0..3).flat_map(|c| channels[c].terms.iter().map(move |g| row(c, g)));
        Self::from_rows(terms.collect()).merged(0.0)
    }

    /// Number of Gaussians.
    pub fn len(&self) -> usize {
        self.variances_mm2.len()
    }

    /// True without any Gaussian.
    pub fn is_empty(&self) -> bool {
        self.variances_mm2.is_empty()
    }

    /// Rows of variance (mm²) and weights.
    pub fn rows(&self) -> impl Iterator<Item = (f64, [f64; 3])> + '_ {
        self.variances_mm2.iter().copied().zip(self.weights.iter().copied())
    }

    /// One channel (0 red, 1 green, 2 blue) as a sum of its own; terms of weight 0 are left out.
    ///
    /// # Panics
    /// If `channel` is above 2.
    pub fn channel(&self, channel: usize) -> GaussianSum {
        let term =
            |(variance_mm2, weights): (f64, [f64; 3])| Gaussian { weight: weights[channel], variance_mm2 };
        GaussianSum { terms: self.rows().map(term).filter(|g| g.weight != 0.0).collect() }
    }

    /// Sum of the weights of each channel: its total diffuse reflectance.
    pub fn totals(&self) -> [f64; 3] {
        self.weights.iter().fold([0.0; 3], |sum, w| [sum[0] + w[0], sum[1] + w[1], sum[2] + w[2]])
    }

    /// The same shapes with every total 1, for a renderer that takes the colour from a texture. A channel whose total is 0
    /// stays as it is.
    pub fn normalised_to_white(&self) -> Self {
        let factors = self.totals().map(|total| if total == 0.0 { 1.0 } else { total.recip() });
        self.scaled(factors)
    }

    /// Each channel's weights times its factor.
    pub fn scaled(&self, factors: [f64; 3]) -> Self {
        let scale = |w: &[f64; 3]| [w[0] * factors[0], w[1] * factors[1], w[2] * factors[2]];
        Self { variances_mm2: self.variances_mm2.clone(), weights: self.weights.iter().map(scale).collect() }
    }

    /// Every channel's profile widened by its own factor (above 0) on lengths, weights kept. As many terms as before: the
    /// variances are spread over what the narrowest and the widest channel need, and terms between two of them are shared.
    pub fn widened(&self, factors: [f64; 3]) -> Self {
        let least = factors.iter().copied().fold(f64::INFINITY, f64::min).powi(2);
        let most = factors.iter().copied().fold(0.0, f64::max).powi(2);
        let last = self.len().saturating_sub(1).max(1) as f64;
        let spread = |(i, v): (usize, &f64)| v * least * (most / least).powf(i as f64 / last);
        let variances_mm2: Vec<f64> = self.variances_mm2.iter().enumerate().map(spread).collect();
        if self.is_empty() {
            return self.clone();
        }
        let channels: [GaussianSum; 3] = core::array::from_fn(|c| {
            let widen =
                |(v, w): (f64, [f64; 3])| Gaussian { weight: w[c], variance_mm2: v * factors[c].powi(2) };
            // A hair narrower: rounding must not push the widest term beyond the last variance.
            let widest = variances_mm2[variances_mm2.len() - 1];
            let inside = |g: Gaussian| Gaussian { variance_mm2: g.variance_mm2.min(widest), ..g };
            GaussianSum::new(self.rows().map(widen).map(inside).collect()).on_variances(&variances_mm2)
        });
        let weights =
            (0..self.len()).map(|i| core::array::from_fn(|c| channels[c].terms[i].weight)).collect();
        Self { variances_mm2, weights }
    }

    /// Rows whose variances differ by at most `relative_tolerance` become one, at the mean variance weighted by the sum of
    /// the three weights; totals are kept.
    pub fn merged(&self, relative_tolerance: f64) -> Self {
        let mut merged: Vec<(f64, [f64; 3])> = Vec::with_capacity(self.len());
        for (variance_mm2, weights) in self.rows() {
            match merged.last_mut() {
                Some(last) if variance_mm2 <= last.0 * (1.0 + relative_tolerance) => {
                    *last = joined(*last, (variance_mm2, weights));
                }
                _ => merged.push((variance_mm2, weights)),
            }
        }
        Self::from_rows(merged)
    }

    /// Weights left behind `thickness_mm` of the material, row by row: w e^(-d²/2v) (d'Eon et al. 2007, eq. 16, corrected;
    /// see [`Gaussian::slab_weight`]).
    pub fn slab(&self, thickness_mm: f64) -> Self {
        let d2 = thickness_mm * thickness_mm;
        let row = |(v, w): (f64, [f64; 3])| (v, w.map(|w| w * (-0.5 * d2 / v).exp()));
        Self::from_rows(self.rows().map(row).collect())
    }
}

fn joined(a: (f64, [f64; 3]), b: (f64, [f64; 3])) -> (f64, [f64; 3]) {
    let sum = |w: [f64; 3]| w[0] + w[1] + w[2];
    let weights = [a.1[0] + b.1[0], a.1[1] + b.1[1], a.1[2] + b.1[2]];
    let total = sum(weights);
    // Equal variances need no mean, and weights that cancel have none.
    let variance = if total == 0.0 || a.0 == b.0 { a.0 } else { (a.0 * sum(a.1) + b.0 * sum(b.1)) / total };
    (variance, weights)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::Profile;

    fn sum(terms: &[(f64, f64)]) -> GaussianSum {
        GaussianSum::new(
            terms.iter().map(|&(weight, variance_mm2)| Gaussian { weight, variance_mm2 }).collect(),
        )
    }

    fn three() -> [GaussianSum; 3] {
        [sum(&[(0.1, 1.0), (0.2, 3.0)]), sum(&[(0.3, 1.0)]), sum(&[(0.25, 0.5), (0.25, 3.0), (0.125, 9.0)])]
    }

    #[test]
    fn union_gives_each_channel_back() {
        let rgb = RgbGaussianSum::from_channels(&three());
        assert_eq!(rgb.variances_mm2, [0.5, 1.0, 3.0, 9.0]);
        for (c, expected) in three().iter().enumerate() {
            assert_eq!(&rgb.channel(c), expected);
        }
    }

    #[test]
    fn white_has_unit_totals_and_the_same_shape() {
        let rgb = RgbGaussianSum::from_channels(&three());
        let white = rgb.normalised_to_white();
        // Four roundings of sums of order 1.
        assert!(white.totals().iter().all(|t| (t - 1.0).abs() < 4.0 * f64::EPSILON));
        let ratio = |r: f64| white.channel(0).at_mm(r) / rgb.channel(0).at_mm(r);
        assert!((ratio(0.1) / ratio(4.0) - 1.0).abs() < 8.0 * f64::EPSILON);
    }

    #[test]
    fn white_leaves_a_black_channel_black() {
        let rgb = RgbGaussianSum::from_rows(vec![(1.0, [0.5, 0.0, 0.25])]);
        assert_eq!(rgb.normalised_to_white().totals(), [1.0, 0.0, 1.0]);
    }

    #[test]
    fn merging_keeps_totals() {
        let rgb = RgbGaussianSum::from_rows(vec![(1.0, [0.5, 0.25, 0.0]), (1.01, [0.125, 0.0, 0.125])]);
        let merged = rgb.merged(0.02);
        assert_eq!((merged.len(), merged.totals()), (1, rgb.totals()));
        // Weighted mean by hand: (1 * 0.75 + 1.01 * 0.25) / 1.
        assert!((merged.variances_mm2[0] - 1.0025).abs() < 1e-12);
    }

    #[test]
    fn slab_agrees_with_each_channel() {
        let rgb = RgbGaussianSum::from_channels(&three());
        for c in 0..3 {
            assert_eq!(rgb.slab(0.7).channel(c), rgb.channel(c).slab(0.7));
        }
    }

    #[test]
    fn widening_keeps_weights_and_scales_every_channel_s_variance() {
        let kernel = crate::presets::find("three-layer-skin").unwrap().kernel(6).unwrap();
        let mean = |sum: &RgbGaussianSum, c: usize| sum.rows().map(|(v, w)| v * w[c]).sum::<f64>();
        for factors in [[2.0, 2.0, 2.0], [3.0, 1.0, 0.5], [0.1, 0.2, 10.0]] {
            let widened = kernel.widened(factors);
            assert_eq!(widened.len(), kernel.len());
            for c in 0..3 {
                let (before, after) = (mean(&kernel, c) * factors[c].powi(2), mean(&widened, c));
                // Sharing terms keeps weight and mean variance; only sums are rounded.
                assert!(
                    (after / before - 1.0).abs() < 1e-12,
                    "{factors:?} channel {c}: {after} for {before}"
                );
                assert!((widened.totals()[c] - kernel.totals()[c]).abs() < 1e-12);
            }
        }
        let even = kernel.widened([2.0; 3]);
        for ((v, w), (before, weights)) in even.rows().zip(kernel.rows()) {
            assert!((v / (4.0 * before) - 1.0).abs() < 1e-12);
            (0..3).for_each(|c| assert!((w[c] - weights[c]).abs() < 1e-9));
        }
    }
}
