//! From spatial frequency back to the radius, where there is no closed form.

use core::f64::consts::{PI, TAU};

/// Pairs of steps it takes at least.
const STEPS: f64 = 2048.0;
/// Steps to a turn of the Bessel function: Simpson's rule then errs by 1e-6 of what cancels there.
const STEPS_PER_TURN: f64 = 16.0;

/// f(r) = 1/(2 pi) ∫ F(k) J0(k r) k dk by Simpson's rule, for a spectrum that is negligible beyond `far_per_mm`. 1/mm².
pub(crate) fn inverse_hankel(r_mm: f64, far_per_mm: f64, spectrum: impl Fn(f64) -> f64) -> f64 {
    let steps = (far_per_mm * r_mm * STEPS_PER_TURN / TAU).max(STEPS).ceil() as usize * 2;
    let step = far_per_mm / steps as f64;
    let sum: f64 = (1..steps)
        .map(|i| {
            let k = i as f64 * step;
            let weight = if i % 2 == 1 { 4.0 } else { 2.0 };
            weight * spectrum(k) * libm::j0(k * r_mm) * k
        })
        .sum();
    sum * step / (3.0 * 2.0 * PI)
}
