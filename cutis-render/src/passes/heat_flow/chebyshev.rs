//! Heat after a time as a sum of Chebyshev polynomials of the exchange: f(L) = Σ c_k T_k(1 - 2 L/λ), λ the fastest rate.
//!
//! The terms fall as exp(-k²/2z) with z = t λ/2, so that their number grows with the square root of the variance. Unlike
//! Runge–Kutta–Chebyshev steps, which are exact for slow waves only, the sum is within twice [`ERROR`] for all, and one row of
//! polynomials serves every time.

use std::f64::consts::PI;

/// Part of a wave that is left out of the sum; as the rest is brought back to 1, waves may be missed by twice that.
const ERROR: f64 = 1e-3;
/// Waves on texels of width h fall at k² (1 - k² h²/12), not k²; this gives that part back.
const LAG: f64 = 1.0 / 12.0;

/// Coefficients for one time, which sum to 1: even light stays even. `texel_mm` is the usual width of a texel.
pub fn coefficients(time_mm2: f64, fastest_rate_per_mm2: f64, texel_mm: f64) -> Vec<f32> {
    let lag_mm2 = LAG * texel_mm * texel_mm;
    let fall = |rate: f64| (-time_mm2 * (rate + lag_mm2 * rate * rate)).exp();
    let z = 0.5 * time_mm2 * fastest_rate_per_mm2 * (1.0 + 2.0 * lag_mm2 * fastest_rate_per_mm2);
    let places = 2 * (2.0 * z * (2.0 / ERROR).ln()).sqrt().ceil() as usize + 32;
    let angle = |n: usize| PI * (n as f64 + 0.5) / places as f64;
    let values: Vec<f64> =
        (0..places).map(|n| fall(0.5 * fastest_rate_per_mm2 * (1.0 - angle(n).cos()))).collect();
    let of = |k: usize| {
        let sum: f64 = values.iter().enumerate().map(|(n, value)| value * (k as f64 * angle(n)).cos()).sum();
        if k == 0 { sum / places as f64 } else { 2.0 * sum / places as f64 }
    };
    let mut all: Vec<f64> = (0..places / 2 + 12).map(of).collect();
    let mut left_out = 0.0;
    while let Some(last) = all.last().filter(|last| left_out + last.abs() < ERROR) {
        left_out += last.abs();
        all.pop();
    }
    let sum: f64 = all.iter().sum();
    all.into_iter().map(|c| (c / sum) as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every wave, from the slowest to the fastest, falls by its own exponential.
    #[test]
    fn all_waves_fall_as_they_should() {
        for time in [1e-6, 1e-3, 0.1, 1.0, 10.0, 400.0] {
            let all = coefficients(time, 8.0, 0.3);
            for i in 0..=200 {
                let rate = 8.0 * f64::from(i) / 200.0;
                let x = 1.0 - 2.0 * rate / 8.0;
                let terms = all.iter().enumerate().map(|(k, &c)| f64::from(c) * (k as f64 * x.acos()).cos());
                let exact = (-time * (rate + rate * rate * 0.09 / 12.0)).exp();
                let found = terms.sum::<f64>();
                assert!((found - exact).abs() < 2.0 * ERROR, "{time}, {rate}: {found} {exact}");
            }
            let growth = all.len() as f64 / (time * 8.0f64).sqrt().max(1.0);
            assert!(growth < 16.0, "{time}: {} polynomials", all.len());
        }
    }
}
