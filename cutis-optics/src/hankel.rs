//! From spatial frequency back to the radius, where there is no closed form.

use core::f64::consts::{PI, TAU};

/// Step in u, k = k_half sinh u: Simpson's rule errs by its fourth power.
const STEP: f64 = 0.005;
/// Steps to a turn of the Bessel function: Simpson's rule then errs by 1e-6 of what cancels there.
const STEPS_PER_TURN: f64 = 16.0;
/// Most steps, so that no radius takes for ever. Where more were needed, the fastest waves are met by too few of them.
const STEPS_MAX: f64 = 400_000.0;
/// Where k F(k) has fallen to this part of its size at half height, it ends.
const NEGLIGIBLE: f64 = 1e-13;

/// f(r) = 1/(2 pi) ∫ F(k) J0(k r) k dk, for a spectrum that falls from its total to nothing. 1/mm².
///
/// Layers have details of very different size: sinh u is even in k below the scale of the whole and in ln k above.
pub(crate) fn inverse_hankel(r_mm: f64, spectrum: impl Fn(f64) -> f64) -> f64 {
    let Some((half_per_mm, far_per_mm)) = scales_per_mm(&spectrum) else { return 0.0 };
    let fastest_step = TAU / (STEPS_PER_TURN * far_per_mm * r_mm);
    let end = (far_per_mm / half_per_mm).asinh();
    let pairs = (end / STEP.min(fastest_step)).min(STEPS_MAX).ceil() as usize / 2 + 1;
    let step = end / (2 * pairs) as f64;
    let sum: f64 = (1..2 * pairs)
        .map(|i| {
            let u = i as f64 * step;
            let k = half_per_mm * u.sinh();
            let weight = if i % 2 == 1 { 4.0 } else { 2.0 };
            weight * spectrum(k) * libm::j0(k * r_mm) * k * half_per_mm * u.cosh()
        })
        .sum();
    sum * step / (3.0 * 2.0 * PI)
}

/// Where a spectrum has fallen to half, and where it ends, 1/mm; none for one that is nothing.
fn scales_per_mm(spectrum: &impl Fn(f64) -> f64) -> Option<(f64, f64)> {
    let total = spectrum(0.0);
    let octaves = || (-120..120).map(|i| 2_f64.powf(0.5 * f64::from(i)));
    let half = octaves().find(|&k| spectrum(k).abs() <= 0.5 * total.abs())?;
    let limit = NEGLIGIBLE * half * total.abs();
    let small = |k: f64| (k * spectrum(k)).abs() <= limit;
    let far = octaves().filter(|&k| k > half).find(|&k| small(k) && small(1.2 * k))?;
    (total != 0.0).then_some((half, far))
}
