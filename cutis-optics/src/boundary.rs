//! Reflection of diffuse light back into the medium at its surface.
//!
//! Symbols: `eta_inside_over_outside` ratio of refractive indices, between two layers the *ratio* of both; `Fdr` share of
//! isotropic internal light that the surface reflects back; `A` = (1 + Fdr) / (1 - Fdr), which moves the virtual source.
//! Source: the polynomial is that of Egan & Hilgeman as used by Jensen et al. 2001 and, for eta < 1, Donner & Jensen 2005,
//! doi:10.1145/1073204.1073308 (neither opened; coefficients checked against Fresnel's equations in the tests).
//! Unpolarised light. A rough surface is known by the share of diffuse light that it lets in, whatever its distribution of
//! facets; see [`Boundary::Rough`].

use crate::simulate::fresnel_reflectance;
use gauss_quad::GaussLegendre;
use std::sync::LazyLock;

/// What light under a face of a medium meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Boundary {
    /// A smooth surface.
    Smooth {
        /// Ratio of refractive indices.
        eta_inside_over_outside: f64,
    },
    /// A rough one.
    ///
    /// By reciprocity, what a lossless surface lets out of isotropic light is what it lets in, times the ratio of what the
    /// two half-spaces hold, 1/eta²: Fdr = 1 - rho_dt / eta². A smooth surface obeys it too.
    Rough {
        /// Ratio of refractive indices.
        eta_inside_over_outside: f64,
        /// Share of isotropic light from outside that enters: the mean of rho_dt over the hemisphere, in (0, 1].
        rho_dt_mean: f64,
    },
}

impl Boundary {
    /// A smooth surface.
    pub fn smooth(eta_inside_over_outside: f64) -> Self {
        Self::Smooth { eta_inside_over_outside }
    }

    /// Ratio of refractive indices.
    pub fn eta_inside_over_outside(self) -> f64 {
        match self {
            Self::Smooth { eta_inside_over_outside } | Self::Rough { eta_inside_over_outside, .. } => {
                eta_inside_over_outside
            }
        }
    }

    /// Share Fdr of isotropic light from inside that is reflected. Below 0 only where a rough surface is said to let in more
    /// than there is room for outside.
    pub fn diffuse_reflectance(self) -> f64 {
        match self {
            Self::Smooth { eta_inside_over_outside } => diffuse_reflectance(eta_inside_over_outside),
            Self::Rough { eta_inside_over_outside: eta, rho_dt_mean } => 1.0 - rho_dt_mean / (eta * eta),
        }
    }

    /// Boundary factor A = (1 + Fdr) / (1 - Fdr).
    pub fn reflection_parameter(self) -> f64 {
        let fdr = self.diffuse_reflectance();
        (1.0 + fdr) / (1.0 - fdr)
    }
}

/// Angular moments of what a smooth surface reflects back, exactly.
///
/// Source: the notation is that of d'Eon & Irving 2011, doi:10.1145/1964921.1964951 (not opened). There they are
/// polynomials; here Fresnel's equations are integrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FresnelMoments {
    /// 2 C1 = 2 ∫ F(mu) mu dmu: the diffuse reflectance Fdr.
    pub two_c1: f64,
    /// 3 C2 = 3 ∫ F(mu) mu² dmu.
    pub three_c2: f64,
}

/// Nodes over the outer cosine: Fresnel's equations are analytic there but for the square root that the other side's cosine
/// is, and so many of them are far more than enough: the tests hold them to 1e-9.
const NODES: usize = 48;

static LEGENDRE: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| {
    let nodes = core::num::NonZeroUsize::new(NODES).expect("is not 0");
    // From [-1, 1] to [0, 1].
    GaussLegendre::new(nodes).iter().map(|&(x, w)| (0.5 * (x + 1.0), 0.5 * w)).collect()
});

/// Nodes and weights of Gauss and Legendre's rule on [0, 1].
pub(crate) fn unit_nodes() -> impl Iterator<Item = (f64, f64)> {
    LEGENDRE.iter().copied()
}

/// ∫ f over [0, 1] by that rule.
pub(crate) fn integral_over_unit(f: impl Fn(f64) -> f64) -> f64 {
    unit_nodes().map(|(x, weight)| weight * f(x)).sum()
}

/// Cosine inside a medium for one outside, at a ratio of indices of at least 1.
pub(crate) fn cos_inside(eta_inside_over_outside: f64, cos_outside: f64) -> f64 {
    (1.0 - (1.0 - cos_outside * cos_outside) / (eta_inside_over_outside * eta_inside_over_outside)).sqrt()
}

/// The moments for a ratio of indices of at least 1; where it is exactly 1 nothing is reflected.
///
/// What gets out is integrated over the *outer* cosine (mu dmu = mu_o dmu_o / eta²), which has no square root at the critical
/// angle.
pub fn fresnel_moments(eta_inside_over_outside: f64) -> FresnelMoments {
    let eta = eta_inside_over_outside;
    let passes = |outside: f64| 1.0 - fresnel_reflectance(1.0, eta, outside).0;
    let first = integral_over_unit(|outside| passes(outside) * outside);
    let second = integral_over_unit(|outside| passes(outside) * outside * cos_inside(eta, outside));
    FresnelMoments { two_c1: 1.0 - 2.0 * first / (eta * eta), three_c2: 1.0 - 3.0 * second / (eta * eta) }
}

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
    fn moments_meet_the_known_exact_values() {
        // Six decimals; the third is A = (1 + 3 C2)/(1 - 2 C1) with five.
        for (eta, two_c1, three_c2, a) in [
            (1.3, 0.444_457, 0.300_267, 2.34053),
            (1.38, 0.513_622, 0.372_149, 2.82116),
            (1.4, 0.528_985, 0.388_783, 2.94849),
            (1.5, 0.596_346, 0.464_431, 3.62793),
            (1.55, 0.625_001, 0.497_907, 3.99443),
        ] {
            let m = fresnel_moments(eta);
            assert!((m.two_c1 - two_c1).abs() < 6e-7, "{eta}: {m:?}");
            assert!((m.three_c2 - three_c2).abs() < 6e-7, "{eta}: {m:?}");
            assert!(((1.0 + m.three_c2) / (1.0 - m.two_c1) - a).abs() < 6e-6, "{eta}: {m:?}");
            assert!((m.two_c1 - fdr_exact(eta)).abs() < 1e-9, "{eta}: {m:?}");
        }
        let matched = fresnel_moments(1.0);
        assert!(matched.two_c1.abs() < 1e-15 && matched.three_c2.abs() < 1e-15, "{matched:?}");
    }

    #[test]
    fn a_rough_boundary_without_roughness_is_the_smooth_one() {
        for eta in [1.1, 1.3, 1.4, 1.5, 2.0] {
            // What a smooth surface lets in: 1 - 2 ∫ F(mu_o) mu_o dmu_o, from outside.
            let lets_in = 1.0
                - 2.0
                    * simpson(0.0, 1.0, 20_000, |outside| {
                        fresnel(1.0 / eta, outside, cos_inside(eta, outside)) * outside
                    });
            let rough = Boundary::Rough { eta_inside_over_outside: eta, rho_dt_mean: lets_in };
            assert!((rough.diffuse_reflectance() - fdr_exact(eta)).abs() < 1e-8, "{eta}");
        }
        // A surface that lets everything in lets out what fits through the cone of total reflection, and no more.
        let open = Boundary::Rough { eta_inside_over_outside: 1.5, rho_dt_mean: 1.0 };
        assert!((open.diffuse_reflectance() - (1.0 - 1.0 / 2.25)).abs() < 1e-15);
        assert!(open.reflection_parameter() < Boundary::smooth(1.5).reflection_parameter());
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
