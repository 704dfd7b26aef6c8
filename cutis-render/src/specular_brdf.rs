//! The specular lobe of skin: Kelemen & Szirmay-Kalos 2001 with a Beckmann distribution and Schlick's Fresnel term.
//!
//! f(V, L) = rho_s · PH(N·H, m) · F(V·H) / |L + V|², with PH the *normalised* Beckmann density
//! exp(-tan²/m²) / (pi m² cos⁴). The listing in GPU Gems 3, chapter 14, leaves out the 1/pi and goes with rho_s = 0.18;
//! here rho_s = 1 is the physical lobe, so a rho_s of that listing is worth rho_s · pi here.
//! Symbols: m root-mean-square slope of the microfacets; F0 reflectance at normal incidence; H half vector.
//! Not modelled: shadowing and masking beyond the 1/|L + V|² form, inter-reflection between facets.
//! Sources: Kelemen & Szirmay-Kalos 2001 (Eurographics short papers, eq. not checked); d'Eon, Luebke & Enderton 2007,
//! section 5.4.

use std::f32::consts::PI;

/// Roughness below which the lobe is narrower than any picture shows; keeps 1/m² finite.
pub const MIN_ROUGHNESS: f32 = 0.02;

/// Beckmann's density of half vectors, 1/sr; times the cosine it integrates to 1 over the hemisphere.
pub fn beckmann_per_sr(cos_half: f32, roughness: f32) -> f32 {
    if cos_half <= 0.0 {
        return 0.0;
    }
    let m2 = roughness.max(MIN_ROUGHNESS).powi(2);
    let cos2 = cos_half * cos_half;
    let tan2 = (1.0 - cos2).max(0.0) / cos2;
    (-tan2 / m2).exp() / (PI * m2 * cos2 * cos2)
}

/// Schlick's approximation of the Fresnel reflectance.
pub fn fresnel_schlick(cos_incidence: f32, f0: f32) -> f32 {
    f0 + (1.0 - f0) * (1.0 - cos_incidence.clamp(0.0, 1.0)).powi(5)
}

/// The lobe for rho_s = 1, in 1/sr. `cos_half` is N·H, `cos_difference` is V·H = L·H.
pub fn kelemen_szirmay_kalos_per_sr(cos_half: f32, cos_difference: f32, roughness: f32, f0: f32) -> f32 {
    // |L + V| = 2 V·H. The floor bounds the lobe where light and eye are opposite and the cosine factor is 0 anyway.
    let sum_length2 = (4.0 * cos_difference * cos_difference).max(1e-4);
    beckmann_per_sr(cos_half, roughness) * fresnel_schlick(cos_difference, f0) / sum_length2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beckmann_integrates_to_one_with_the_cosine() {
        for m in [0.05f64, 0.1, 0.3, 0.6, 1.0] {
            let n = 20_000;
            let step = std::f64::consts::FRAC_PI_2 / f64::from(n);
            let sum: f64 = (0..n)
                .map(|i| {
                    let theta = (f64::from(i) + 0.5) * step;
                    let d = f64::from(beckmann_per_sr(theta.cos() as f32, m as f32));
                    d * theta.cos() * theta.sin() * step * std::f64::consts::TAU
                })
                .sum();
            // Midpoint rule error ~ (step/m)²; the rest is f32 rounding of the density.
            assert!((sum - 1.0).abs() < 1e-4, "m = {m}: {sum}");
        }
    }

    #[test]
    fn fresnel_meets_its_ends() {
        assert!((fresnel_schlick(1.0, 0.028) - 0.028).abs() < 1e-7);
        assert!((fresnel_schlick(0.0, 0.028) - 1.0).abs() < 1e-7);
    }

    #[test]
    fn retro_reflection_has_the_hand_computed_value() {
        // V = L = N, m = 0.3, F0 = 0.028: 1/(pi 0.09) * 0.028 / 4 = 0.024757.
        assert!((kelemen_szirmay_kalos_per_sr(1.0, 1.0, 0.3, 0.028) - 0.024_757).abs() < 1e-5);
    }
}
