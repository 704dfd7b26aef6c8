//! Slow, obvious integrals that the tests compare the closed forms with, and how far samples may stray from a density.
//! Nothing here shares code with what is tested.

/// Composite Simpson rule over `[from, to]`; `intervals` is even.
pub(crate) fn simpson(from: f64, to: f64, intervals: usize, f: impl Fn(f64) -> f64) -> f64 {
    let step = (to - from) / intervals as f64;
    let inner: f64 =
        (1..intervals).map(|i| if i % 2 == 1 { 4.0 } else { 2.0 } * f(from + step * i as f64)).sum();
    step / 3.0 * (f(from) + inner + f(to))
}

/// Bessel function J0 from its integral (1/pi) ∫ cos(x sin θ) dθ over [0, pi].
/// The integrand is periodic and entire: the trapezoid rule errs like J_{2n}(x), nothing once 2n > x + 40.
pub(crate) fn bessel_j0(x: f64) -> f64 {
    let n = 20 + (0.5 * x.abs()).ceil() as usize;
    let angle = |i: usize| core::f64::consts::PI * i as f64 / n as f64;
    (0..n).map(|i| (x * angle(i).sin()).cos()).sum::<f64>() / n as f64
}

/// Hankel transform 2 pi ∫ f(r) J0(k r) r dr, by Simpson in ln r between two radii.
/// In ln r one step serves the peak near r = 0 and the long tail alike.
pub(crate) fn hankel(k_per_mm: f64, from_mm: f64, to_mm: f64, f: impl Fn(f64) -> f64) -> f64 {
    let integrand = |t: f64| {
        let r = t.exp();
        core::f64::consts::TAU * f(r) * bessel_j0(k_per_mm * r) * r * r
    };
    simpson(from_mm.ln(), to_mm.ln(), 4000, integrand)
}

/// Fails if counts stray from their shares farther than chance lets them in one of 100,000 tests.
pub(crate) fn chi_square_is_plausible(counts: &[u64], shares: &[f64]) {
    let total = counts.iter().sum::<u64>() as f64;
    let (mut chi2, mut degrees) = (0.0, -1.0);
    let mut rest = (0.0, 0.0);
    for (&count, &share) in counts.iter().zip(shares) {
        // Bins that expect fewer than ten are taken together.
        rest = (rest.0 + count as f64, rest.1 + share * total);
        if rest.1 >= 10.0 {
            chi2 += (rest.0 - rest.1).powi(2) / rest.1;
            degrees += 1.0;
            rest = (0.0, 0.0);
        }
    }
    // Wilson & Hilferty: the cube root is nearly normal; 4.3 deviations are 1 in 100,000.
    let spread = 2.0 / (9.0 * degrees);
    let deviations = ((chi2 / degrees).cbrt() - (1.0 - spread)) / f64::sqrt(spread);
    assert!(deviations < 4.3, "chi² {chi2} at {degrees} degrees of freedom");
}

mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;

    #[test]
    fn bessel_j0_meets_tabulated_values() {
        // Abramowitz & Stegun table 9.1, ten figures of it.
        for (x, value) in [(1.0, 0.765_197_686_6), (5.0, -0.177_596_771_3), (10.0, -0.245_935_764_5)] {
            assert!((bessel_j0(x) - value).abs() < 1e-10, "J0({x}) = {}", bessel_j0(x));
        }
    }
}
