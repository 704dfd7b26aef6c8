//! Henyey–Greenstein phase function: sampling without loss of digits at any g.
//! Symbols: `g` mean cosine; `mu` cosine between travel directions, forward = +1.
//! Source: Henyey & Greenstein 1941, doi:10.1086/144246 (not opened).
//!
//! The textbook inversion mu = (1 + g² - t²)/(2g), t = (1 - g²)/(1 + g u), u = 2 xi - 1, divides a difference that vanishes
//! by a g that vanishes. Since t - (1 - g) = (1 - g) g (1 - u)/(1 + g u), the same number is
//! 1 - mu = (1 - g)(1 - u)(t + 1 - g)/(2 (1 + g u)): no difference, no division by g, and all digits near forward.

use super::lanes::{Lanes, splat};

/// 1 - mu of one scattering event for mean cosine `g` and a uniform `unit` in (0, 1).
pub fn scattered_one_minus_cos(g: f64, unit: f64) -> f64 {
    sample_one_minus_cos(splat(g), splat(unit)).to_array()[0]
}

/// 1 - mu for uniform `unit` in (0, 1).
#[inline(always)]
pub(super) fn sample_one_minus_cos(g: Lanes, unit: Lanes) -> Lanes {
    let one = splat(1.0);
    let backwards = one - g;
    let per_denominator = one / (g + g).mul_add(unit, backwards);
    let t = g.mul_neg_add(g, one) * per_denominator;
    // 1 - u = 2 (1 - unit).
    backwards * (one - unit) * (t + backwards) * per_denominator
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::chi_square_is_plausible;
    use crate::simulate::lanes::{LANES, mask_of, ranks_of};
    use crate::simulate::random::{Random, unit};

    use super::scattered_one_minus_cos as one_minus_cos;

    /// Share of the light with a cosine below `mu`, the integral of the phase function.
    fn below(g: f64, mu: f64) -> f64 {
        if g == 0.0 {
            return 0.5 * (1.0 + mu);
        }
        let root = (1.0 + g * g - 2.0 * g * mu).sqrt();
        (1.0 - g * g) / (2.0 * g) * (1.0 / root - 1.0 / (1.0 + g))
    }

    #[test]
    fn samples_follow_the_phase_function() {
        for g in [-0.95, -0.3, 0.0, 0.3, 0.75, 0.99] {
            let bins = 50;
            let edge = |i: usize| -1.0 + 2.0 * i as f64 / bins as f64;
            let shares: Vec<f64> = (0..bins).map(|i| below(g, edge(i + 1)) - below(g, edge(i))).collect();
            let mut counts = vec![0u64; bins];
            let mut random = Random::new(3);
            random.begin(mask_of(0xFF), ranks_of(0xFF));
            for _ in 0..200_000 / LANES {
                for one_minus_mu in sample_one_minus_cos(splat(g), unit(random.bits())).to_array() {
                    let share = 1.0 - 0.5 * one_minus_mu;
                    counts[((share * bins as f64) as usize).min(bins - 1)] += 1;
                }
            }
            chi_square_is_plausible(&counts, &shares);
        }
    }

    #[test]
    fn sampling_is_the_inverse_of_the_integral() {
        for g in [-0.9, -0.5, 0.2, 0.5, 0.9, 0.99] {
            for i in 1..100 {
                let unit = f64::from(i) / 100.0;
                let back = below(g, 1.0 - one_minus_cos(g, unit));
                // The integral itself loses a factor 1/(1 - |g|) of digits.
                assert!((back - unit).abs() < 1e-12, "g {g}: {unit} came back as {back}");
            }
        }
    }

    #[test]
    fn nothing_is_lost_as_g_vanishes_or_nears_one() {
        for unit in [1e-9, 0.25, 0.5, 0.9] {
            // Isotropic: 1 - mu = 2 (1 - unit); to first order in g times 1 - 3 g unit, whose mean gives the cosine g.
            for g in [0.0, 1e-16, 1e-12, 1e-8] {
                let expected = 2.0 * (1.0 - unit) * (1.0 - 3.0 * g * unit);
                let got = one_minus_cos(g, unit);
                assert!((got / expected - 1.0).abs() < 1e-14 + 20.0 * g * g, "g {g}, unit {unit}");
            }
        }
        // As g nears 1 the angle scales with 1 - g: 1 - mu = (1 - g)² (1/unit² - 1)/2 to first order, at unit 1/4 times
        // 1 - 2.2 (1 - g). Rounding 1 - gap moves the gap by up to EPSILON/4, its square by twice that part of it.
        for gap in [1e-4, 1e-8, 1e-12] {
            let got = one_minus_cos(1.0 - gap, 0.25) / (gap * gap);
            assert!((got / 7.5 - 1.0).abs() < 2.3 * gap + 0.6 * f64::EPSILON / gap, "{gap}: {got}");
        }
    }
}
