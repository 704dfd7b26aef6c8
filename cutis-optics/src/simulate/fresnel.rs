//! Fresnel's equations for unpolarised light.

/// Share of the light that an interface reflects, and the cosine behind it (0 where all is reflected).
/// `cos` is that of the angle to the normal on the side the light comes from, in [0, 1].
#[inline]
pub fn fresnel_reflectance(index_from: f64, index_to: f64, cos: f64) -> (f64, f64) {
    if index_from == index_to {
        return (0.0, cos);
    }
    let ratio = index_from / index_to;
    let sin2_to = ratio * ratio * (1.0 - cos * cos);
    if sin2_to >= 1.0 {
        return (1.0, 0.0);
    }
    let cos_to = (1.0 - sin2_to).sqrt();
    let s = (index_from * cos - index_to * cos_to) / (index_from * cos + index_to * cos_to);
    let p = (index_from * cos_to - index_to * cos) / (index_from * cos_to + index_to * cos);
    (0.5 * (s * s + p * p), cos_to)
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
    fn beyond_the_critical_angle_all_is_reflected_and_before_it_both_ways_are_equal() {
        let critical = (1.0f64 - 1.0 / (1.4 * 1.4)).sqrt();
        assert_eq!(fresnel_reflectance(1.4, 1.0, critical - 1e-9).0, 1.0);
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
