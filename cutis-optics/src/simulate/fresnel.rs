//! Fresnel's equations for unpolarised light.

use super::lanes::{Lanes, splat};

/// Share of the light that an interface reflects, and the cosine behind it (0 where all is reflected).
/// `cos` is that of the angle to the normal on the side the light comes from, in [0, 1].
pub fn fresnel_reflectance(index_from: f64, index_to: f64, cos: f64) -> (f64, f64) {
    let (reflectance, cos_to) = fresnel_lanes(splat(index_from / index_to), splat(cos));
    (reflectance.to_array()[0], cos_to.to_array()[0])
}

/// The same for all lanes, from the ratio of the index before the interface to the one behind it.
///
/// cos_to² = 1 - ratio² (1 - cos²) = (1 - ratio²) + ratio² cos² loses no digits at grazing angles, and with equal indices
/// gives cos itself, so that nothing at all is reflected.
#[inline(always)]
pub(super) fn fresnel_lanes(index_from_over_to: Lanes, cos: Lanes) -> (Lanes, Lanes) {
    let ratio2 = index_from_over_to * index_from_over_to;
    let cos2_to = ratio2.mul_add(cos * cos, splat(1.0) - ratio2);
    let cos_to = cos2_to.fast_max(splat(0.0)).sqrt();
    let (from, to) = (index_from_over_to * cos, index_from_over_to * cos_to);
    // Amplitudes (from - cos_to)/(from + cos_to) and (to - cos)/(to + cos), squared, over one common denominator. Where
    // all is reflected both numerators are the denominator's root: exactly 1, if no product is rounded on its own.
    let (s_sum, p_sum) = (from + cos_to, to + cos);
    let (s, p) = ((from - cos_to) * p_sum, (to - cos) * s_sum);
    let sums = s_sum * p_sum;
    (splat(0.5) * (s * s + p * p) / (sums * sums), cos_to)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_normal_incidence_it_is_the_squared_ratio() {
        // ((1.5 - 1)/(1.5 + 1))² = 0.04.
        assert!((fresnel_reflectance(1.0, 1.5, 1.0).0 - 0.04).abs() < 1e-15);
        assert!((fresnel_reflectance(1.5, 1.0, 1.0).0 - 0.04).abs() < 1e-15);
    }

    #[test]
    fn equal_indices_let_everything_pass_straight() {
        for cos in [1e-70, 1e-9, 0.1, 0.7, 1.0 - f64::EPSILON, 1.0] {
            assert_eq!(fresnel_reflectance(1.4, 1.4, cos), (0.0, cos));
        }
    }

    #[test]
    fn both_polarisations_meet_the_textbook() {
        for (from, to) in [(1.0, 1.5), (1.4, 1.38), (1.5, 1.0)] {
            for i in 1..=100 {
                let cos = f64::from(i) / 100.0;
                let sin_to = from / to * (1.0 - cos * cos).sqrt();
                if sin_to > 0.999 {
                    continue;
                }
                let cos_to = (1.0 - sin_to * sin_to).sqrt();
                let s = (from * cos - to * cos_to) / (from * cos + to * cos_to);
                let p = (from * cos_to - to * cos) / (from * cos_to + to * cos);
                let (got, got_cos) = fresnel_reflectance(from, to, cos);
                // The textbook's own cosine loses up to 1/cos_to = 22 roundings.
                assert!((got - 0.5 * (s * s + p * p)).abs() < 1e-13, "{from} {to} {cos}");
                assert!((got_cos - cos_to).abs() < 1e-14, "{from} {to} {cos}");
            }
        }
    }

    #[test]
    fn beyond_the_critical_angle_all_is_reflected_and_before_it_both_ways_are_equal() {
        let critical = (1.0f64 - 1.0 / (1.4 * 1.4)).sqrt();
        assert_eq!(fresnel_reflectance(1.4, 1.0, critical - 1e-9), (1.0, 0.0));
        for cos in [0.72, 0.8, 0.9, 0.99] {
            let (there, cos_out) = fresnel_reflectance(1.4, 1.0, cos);
            let (back, cos_in) = fresnel_reflectance(1.0, 1.4, cos_out);
            assert!((there - back).abs() < 1e-14 && (cos_in - cos).abs() < 1e-14, "{cos}");
        }
    }

    #[test]
    fn parallel_light_vanishes_at_brewster_s_angle() {
        // tan = n: only the crossed polarisation is left, ((n² - 1)/(n² + 1))²/2.
        let n = 1.5f64;
        let cos = 1.0 / (1.0 + n * n).sqrt();
        let expected = 0.5 * ((n * n - 1.0) / (n * n + 1.0)).powi(2);
        assert!((fresnel_reflectance(1.0, n, cos).0 - expected).abs() < 1e-15);
    }
}
