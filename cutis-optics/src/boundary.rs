//! Reflection of diffuse light back into the medium at its surface.
//!
//! Symbols: `eta_inside_over_outside` ratio of refractive indices, between two layers the *ratio* of both; `Fdr` share of
//! isotropic internal light that the surface reflects back; `A` = (1 + Fdr) / (1 - Fdr), which moves the virtual source.
//! Source: the polynomial is that of Egan & Hilgeman as used by Jensen et al. 2001 and, for eta < 1, Donner & Jensen 2005,
//! doi:10.1145/1073204.1073308 (neither opened; coefficients checked against Fresnel's equations in the tests).
//! Unpolarised light, smooth surface.

/// Diffuse internal reflectance Fdr of a smooth surface, by polynomial, for 0.5 ≤ eta ≤ 3. A matched boundary gives exactly 0.
///
/// Largest error against Fresnel's equations: 0.0010 for 1.05 ≤ eta ≤ 2, 0.0012 for 0.7 ≤ eta ≤ 0.95 (both in Fdr).
/// The polynomial itself leaves 0.0017 at eta = 1, hence a small jump there.
pub fn diffuse_reflectance(eta_inside_over_outside: f64) -> f64 {
    let eta = eta_inside_over_outside;
    if eta > 1.0 {
        -1.4399 / (eta * eta) + 0.7099 / eta + 0.6681 + 0.0636 * eta
    } else if eta < 1.0 {
        -0.4399 + 0.7099 / eta - 0.3319 / (eta * eta) + 0.0636 / (eta * eta * eta)
    } else {
        0.0
    }
}

/// Boundary factor A = (1 + Fdr) / (1 - Fdr), no unit; exactly 1 for a matched boundary.
///
/// Against the exact values 2.60008 (1.3), 3.24615 (1.4), 3.95474 (1.5) the polynomial is off by +0.10 %, +0.16 %, +0.14 %.
pub fn reflection_parameter(eta_inside_over_outside: f64) -> f64 {
    let fdr = diffuse_reflectance(eta_inside_over_outside);
    (1.0 + fdr) / (1.0 - fdr)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::oracle::simpson;

    /// Fresnel reflectance of unpolarised light from the cosines on both sides.
    fn fresnel(eta: f64, cos_inside: f64, cos_outside: f64) -> f64 {
        let s = (eta * cos_inside - cos_outside) / (eta * cos_inside + cos_outside);
        let p = (eta * cos_outside - cos_inside) / (eta * cos_outside + cos_inside);
        0.5 * (s * s + p * p)
    }

    /// Fdr = 2 ∫ F(mu) mu dmu over the inner hemisphere. Where the light gets out the integral runs over the *outer*
    /// cosine (mu dmu = mu_o dmu_o / eta²), which has no square root at the critical angle.
    fn fdr_exact(eta: f64) -> f64 {
        if eta >= 1.0 {
            let inner = |outer: f64| (1.0 - (1.0 - outer * outer) / (eta * eta)).sqrt();
            let passing = simpson(0.0, 1.0, 2000, |outer| fresnel(eta, inner(outer), outer) * outer);
            1.0 - 1.0 / (eta * eta) + 2.0 * passing / (eta * eta)
        } else {
            let outer = |inner: f64| (1.0 - eta * eta * (1.0 - inner * inner)).sqrt();
            2.0 * simpson(0.0, 1.0, 2000, |inner| fresnel(eta, inner, outer(inner)) * inner)
        }
    }

    fn a_exact(eta: f64) -> f64 {
        (1.0 + fdr_exact(eta)) / (1.0 - fdr_exact(eta))
    }

    #[test]
    fn quadrature_meets_the_known_exact_values() {
        // Known to five decimals: half a unit of the last one, plus Simpson's own 1e-9.
        for (eta, a) in [(1.3, 2.60008), (1.4, 3.24615), (1.5, 3.95474)] {
            assert!((a_exact(eta) - a).abs() < 6e-6, "A({eta}) = {}", a_exact(eta));
        }
    }

    #[test]
    fn polynomial_error_is_as_stated() {
        for (eta, percent) in [(1.3, 0.10), (1.4, 0.16), (1.5, 0.14)] {
            let ours = 100.0 * (reflection_parameter(eta) / a_exact(eta) - 1.0);
            // Stated to two decimals.
            assert!((ours - percent).abs() < 0.005, "{eta}: {ours} %");
        }
        let worst = |from: f64, to: f64| {
            (0..=100)
                .map(|i| from + (to - from) * f64::from(i) / 100.0)
                .fold(0.0, |worst: f64, eta| worst.max((diffuse_reflectance(eta) - fdr_exact(eta)).abs()))
        };
        let (above, below) = (worst(1.05, 2.0), worst(0.7, 0.95));
        assert!(above < 0.0010, "{above}");
        assert!(below < 0.0012, "{below}");
    }

    #[test]
    fn matched_boundary_reflects_nothing() {
        assert_eq!((diffuse_reflectance(1.0), reflection_parameter(1.0)), (0.0, 1.0));
        // Both branches meet at 1 with the 0.0017 the polynomials leave there; slope below 2, so 2e-9 more at 1e-9 away.
        for eta in [1.0 - 1e-9, 1.0 + 1e-9] {
            assert!((diffuse_reflectance(eta) - 0.0017).abs() < 3e-9, "{eta}");
        }
    }

    #[test]
    fn stays_a_reflectance_over_the_accepted_range() {
        for i in 0..=250 {
            let fdr = diffuse_reflectance(0.5 + 0.01 * f64::from(i));
            assert!((0.0..1.0).contains(&fdr), "{fdr} at {i}");
        }
    }
}
