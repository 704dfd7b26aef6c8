//! Heat after a time as a sum of Chebyshev polynomials of the exchange: exp(-t L) = Σ c_k(t) T_k(1 - 2 L/λ), λ the fastest rate.
//!
//! With z = t λ/2, c_0 = e^-z I_0(z) and c_k = 2 e^-z I_k(z), modified Bessel functions; they fall as exp(-k²/2z), so that the
//! number of polynomials grows with the square root of the variance. Unlike Runge–Kutta–Chebyshev steps, which are exact for slow
//! waves only, the sum is within [`ERROR`] for all, and one row of polynomials serves every time.

/// Part of a wave by which the sum may miss it.
const ERROR: f64 = 1e-4;

/// Coefficients for one time, which sum to 1: even light stays even.
pub fn coefficients(time_mm2: f64, fastest_rate_per_mm2: f64) -> Vec<f32> {
    let z = 0.5 * time_mm2 * fastest_rate_per_mm2;
    let most = (2.0 * z * (2.0 / ERROR).ln()).sqrt().ceil() as usize + 12;
    // Upwards the functions vanish among rounding; downwards from far out they come up (Miller's recurrence).
    let start = most + 16;
    let (mut above, mut at) = (0.0f64, 1e-300f64);
    let mut values = vec![0.0; most + 1];
    let mut sum = 0.0;
    for k in (0..=start).rev() {
        if k <= most {
            values[k] = at;
        }
        sum += if k == 0 { at } else { 2.0 * at };
        let below = if k == 0 { 0.0 } else { above + 2.0 * k as f64 / z.max(1e-12) * at };
        (above, at) = (at, below);
        if at > 1e200 {
            (above, at, sum) = (above * 1e-200, at * 1e-200, sum * 1e-200);
            values.iter_mut().for_each(|value| *value *= 1e-200);
        }
    }
    let mut all: Vec<f64> = values
        .iter()
        .enumerate()
        .map(|(k, value)| if k == 0 { value / sum } else { 2.0 * value / sum })
        .collect();
    while all.len() > 1 && all.last().is_some_and(|last| *last < 0.1 * ERROR) {
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
            let all = coefficients(time, 8.0);
            for i in 0..=200 {
                let rate = 8.0 * f64::from(i) / 200.0;
                let x = 1.0 - 2.0 * rate / 8.0;
                let terms = all.iter().enumerate().map(|(k, &c)| f64::from(c) * (k as f64 * x.acos()).cos());
                let (found, exact) = (terms.sum::<f64>(), (-rate * time).exp());
                assert!((found - exact).abs() < 2.0 * ERROR, "{time}, {rate}: {found} {exact}");
            }
            let growth = all.len() as f64 / (time * 8.0f64).sqrt().max(1.0);
            assert!(growth < 16.0, "{time}: {} polynomials", all.len());
        }
    }
}
