//! AgX by Troy Sobotka (github.com/sobotka/AgX and AgX-S2O3): its base look on an sRGB screen.
//!
//! Three steps: colours move towards white (the *inset* of the primaries), each channel goes through a sigmoid over
//! the logarithm of the light, and the inset is undone. The result is an encoded value for a screen with exponent
//! 2.2, decoded here. The sigmoid is the closed form of the published generator (slope 2, toe power 3, shoulder power
//! 3.25, pivot at middle grey 10/16.5 of the way from -10 to +6.5 EV), not one of the polynomials fitted to it.
//! The matrices are those of Benjamin Wrensch's "Minimal AgX Implementation" (iolite-engine.com, 2023), where they
//! are printed with all their digits; their rows sum to 1 only within 1.7e-4, so that greys gain a tint of that size.

use glam::{Mat3, Vec3};

/// Darkest and brightest light of the logarithmic scale, EV about middle grey.
const EV_RANGE: [f32; 2] = [-10.0, 6.5];

/// Light of a grey card.
const MIDDLE_GREY: f32 = 0.18;

/// Slope of the sigmoid at its pivot.
const SLOPE: f32 = 2.0;

/// How suddenly the curve bends towards black and towards white.
const TOE_POWER: f32 = 3.0;
const SHOULDER_POWER: f32 = 3.25;

/// Encoded value at the pivot.
const PIVOT_OUT: f32 = 0.5;

/// Rec. 709 to the inset primaries, by columns.
const INSET: [[f32; 3]; 3] = [
    [0.842_479_06, 0.042_328_242, 0.042_375_655],
    [0.078_433_6, 0.878_468_6, 0.078_433_6],
    [0.079_223_745, 0.079_166_13, 0.879_143],
];

/// The inverse of the inset, by columns.
const OUTSET: [[f32; 3]; 3] = [
    [1.196_879, -0.052_896_852, -0.052_971_636],
    [-0.098_020_88, 1.151_903_1, -0.098_043_45],
    [-0.099_029_74, -0.098_961_18, 1.151_073_7],
];

pub(super) fn map(light: Vec3) -> Vec3 {
    let inset = Mat3::from_cols_array_2d(&INSET) * light;
    let encoded = inset.to_array().map(|c| sigmoid(logarithmic(c)));
    let outset = Mat3::from_cols_array_2d(&OUTSET) * Vec3::from_array(encoded);
    Vec3::from_array(outset.to_array().map(|c| c.max(0.0).powf(2.2)))
}

/// Place on the logarithmic scale, 0..=1.
fn logarithmic(light: f32) -> f32 {
    // log2(0) is -inf, which the clamp takes to 0.
    let ev = (light / MIDDLE_GREY).log2();
    ((ev - EV_RANGE[0]) / (EV_RANGE[1] - EV_RANGE[0])).clamp(0.0, 1.0)
}

/// The curve through (0, 0), the pivot and (1, 1).
fn sigmoid(x: f32) -> f32 {
    if x <= 0.0 {
        return 0.0; // the formula would leave a rounding error in the black
    }
    let pivot_in = -EV_RANGE[0] / (EV_RANGE[1] - EV_RANGE[0]);
    let (reach_in, reach_out, power) = if x < pivot_in {
        (pivot_in, PIVOT_OUT, TOE_POWER)
    } else {
        (1.0 - pivot_in, 1.0 - PIVOT_OUT, SHOULDER_POWER)
    };
    // d / (1 + |d / s|^p)^(1/p) has slope 1 at 0 and the limit s; s is chosen so that the end of the reach is met.
    let end = SLOPE * reach_in;
    let limit = end / ((end / reach_out).powf(power) - 1.0).powf(1.0 / power);
    let d = SLOPE * (x - pivot_in);
    (PIVOT_OUT + d / (1.0 + (d / limit).abs().powf(power)).powf(1.0 / power)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_meets_its_ends_and_its_pivot() {
        assert!(sigmoid(0.0) < 4.0 * f32::EPSILON);
        assert!(sigmoid(1.0) > 1.0 - 4.0 * f32::EPSILON);
        assert!((sigmoid(10.0 / 16.5) - 0.5).abs() < 4.0 * f32::EPSILON);
        let slope = (sigmoid(10.0 / 16.5 + 1e-2) - sigmoid(10.0 / 16.5 - 1e-2)) / 2e-2;
        // The bend takes (d/s)^3 / 3 of the slope: 1e-4 at this step, and rounding 1e-5.
        assert!((slope - SLOPE).abs() < 1e-3, "{slope}");
    }

    #[test]
    fn middle_grey_is_half_the_encoded_range() {
        // By construction of AgX: y_pivot = 0.5 at 0.18, shown as 0.5^2.2. The rows of the outset miss 1 by 1.7e-4,
        // times the exponent.
        let shown = map(Vec3::splat(0.18));
        let relative = shown / 0.5f32.powf(2.2) - 1.0;
        assert!(relative.abs().max_element() < 2.2 * 1.8e-4, "{shown}");
    }

    #[test]
    fn the_curve_agrees_with_the_published_polynomial() {
        // Wrensch's sixth-order fit of the same curve; he states a mean squared error of 3.7e-6 (root 0.002), and
        // a fit of this order is at worst three times its root mean square off.
        for i in 0..=100 {
            let x = i as f32 / 100.0;
            let fit =
                ((((15.5 * x - 40.14) * x + 31.96) * x - 6.868) * x + 0.4298) * x * x + 0.1191 * x - 0.002_32;
            assert!((sigmoid(x) - fit).abs() < 0.006, "{x}: {} and {fit}", sigmoid(x));
        }
    }

    #[test]
    fn the_outset_undoes_the_inset() {
        let both = Mat3::from_cols_array_2d(&OUTSET) * Mat3::from_cols_array_2d(&INSET);
        assert!(both.abs_diff_eq(Mat3::IDENTITY, 1e-6), "{both}");
    }

    #[test]
    fn a_bright_saturated_light_fades_to_white() {
        let shown = map(Vec3::new(1000.0, 1.0, 1.0));
        assert!(shown.min_element() > 0.6, "{shown}");
    }
}
