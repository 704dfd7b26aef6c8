//! The look of ACES 1.0 on an sRGB screen: Stephen Hill's fit of the reference rendering transform followed by the
//! output transform for sRGB, as published in Baking Lab (`BakingLab/ACES.hlsl` at
//! github.com/TheRealMJP/BakingLab, MIT licence; the constants are those printed there).
//!
//! Into a space near ACEScg with the transform's desaturation, a rational curve per channel, and back. No exposure
//! is added: middle grey 0.18 comes out near 0.1, as in the cinema (some renderers brighten by 1/0.6 or 1.8 before).
//! The fit does not reproduce the transform's hue modifiers (red, glow).

use glam::{Mat3, Vec3};

/// Linear Rec. 709 to the space of the curve, by rows.
const CURVE_FROM_REC709: [[f32; 3]; 3] =
    [[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]];

/// The space of the curve to linear Rec. 709, by rows.
const REC709_FROM_CURVE: [[f32; 3]; 3] =
    [[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]];

pub(super) fn map(light: Vec3) -> Vec3 {
    let inner = Mat3::from_cols_array_2d(&CURVE_FROM_REC709).transpose() * light;
    let shown = Vec3::new(curve(inner.x), curve(inner.y), curve(inner.z));
    Mat3::from_cols_array_2d(&REC709_FROM_CURVE).transpose() * shown
}

/// The rational fit; below 0.0033 it is slightly negative, which counts as black.
fn curve(v: f32) -> f32 {
    let above = v * (v + 0.024_578_6) - 0.000_090_537;
    let below = v * (0.983_729 * v + 0.432_951) + 0.238_081;
    (above / below).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn middle_grey_comes_out_at_a_tenth_of_white() {
        // ACES 1.0: the tone scale takes 0.18 to 4.8 cd/m² of the cinema's 48 (middle point of
        // `segmented_spline_c9`, ODT_48nits), 0.10 of white. The fit is 6 % above it.
        let shown = map(Vec3::splat(0.18));
        assert!((shown - Vec3::splat(0.10)).abs().max_element() < 0.007, "{shown}");
    }

    #[test]
    fn the_curve_agrees_with_the_other_published_fit() {
        // Narkowicz 2016, "ACES Filmic Tone Mapping Curve": a fit by eye of the same transform, brightened by 1/0.6.
        // The two differ most at 0.5, by 6.4 % of white (evaluated by hand); a wrong constant shows as more.
        let narkowicz = |x: f32| (x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14);
        for x in [0.1f32, 0.18, 0.5, 1.0, 2.0, 4.0] {
            let difference = curve(x) - narkowicz(0.6 * x);
            assert!(difference.abs() < 0.065, "{x}: {difference}");
        }
    }

    #[test]
    fn the_matrices_keep_grey() {
        for row in CURVE_FROM_REC709.iter().chain(&REC709_FROM_CURVE) {
            // Five printed digits: three roundings of half a unit in the last place.
            assert!((row.iter().sum::<f32>() - 1.0).abs() < 1.6e-5, "{row:?}");
        }
    }
}
