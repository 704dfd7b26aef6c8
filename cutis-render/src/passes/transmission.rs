//! Light that comes through the body: the translucent shadow map's part of the final pass
//! (d'Eon, Luebke & Enderton 2007, sections 5.2 and 5.4).
//!
//! Equation 16: a slab of thickness d transmits R(sqrt(r² + d²)) = Σ w_i exp(-d²/(2 v_i)) G(v_i, r), so the blurred
//! irradiance of the light-facing side, weighted anew, is what arrives. (The paper prints exp(-d²/v_i); with its own
//! Gaussian, equation 8, the 2 belongs there.)
//!
//! Every Gaussian reads the distance blurred by the Gaussian before it, and fades out where the light-facing place is so
//! near in the texture that the blur along the surface has already brought its light.

use crate::passes::diffusion::Diffused;
use crate::passes::irradiance::distance_slot;
use crate::passes::visibility::LightFacing;
use crate::prepare::Kernel;
use glam::{Vec2, Vec3};

/// Distance in the surface, in standard deviations of a Gaussian, below which it begins to fade (paper, section 5.2).
const FADE_DEVIATIONS: f32 = 6.0;

/// The shadowed place and what is known of it.
#[derive(Debug, Clone, Copy)]
pub struct ShadowedPlace {
    /// Its texture coordinates.
    pub uv: Vec2,
    /// Its chart.
    pub chart: u32,
    /// Distance along the surface to the light-facing place, mm; infinite if another chart or object holds that.
    pub apart_mm: f32,
}

/// Radiant exitance under the surface at `here` from light number `light` through the body, W/m².
pub fn transmitted(
    kernel: &Kernel,
    light: usize,
    (here_maps, here): (&Diffused, &ShadowedPlace),
    (there_maps, there): (&Diffused, &LightFacing),
) -> Vec3 {
    let (layer, component) = distance_slot(light);
    let mut sum = Vec3::ZERO;
    for (i, (&variance_mm2, &weight)) in kernel.variances_mm2.iter().zip(&kernel.weights).enumerate() {
        let d_mm = here_maps.sample(i, layer, here.uv, here.chart)[component];
        let through = slab_weight(d_mm, variance_mm2) * fade_out(here.apart_mm, variance_mm2);
        // Below a millionth nothing shows, and the look-up can be saved.
        if through > 1e-6 {
            sum += weight * through * there_maps.sample(i + 1, 0, there.uv, there.chart).truncate();
        }
    }
    sum
}

/// exp(-d²/2v): what a slab of thickness d leaves of a Gaussian of variance v.
pub fn slab_weight(d_mm: f32, variance_mm2: f32) -> f32 {
    if variance_mm2 <= 0.0 {
        return 0.0;
    }
    (-d_mm * d_mm / (2.0 * variance_mm2)).exp()
}

/// 0 where both places are one, 1 from six standard deviations on.
pub fn fade_out(apart_mm: f32, variance_mm2: f32) -> f32 {
    let start_mm = FADE_DEVIATIONS * variance_mm2.sqrt();
    if apart_mm >= start_mm { 1.0 } else { apart_mm / start_mm }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slab_weight_is_the_third_dimension_of_the_gaussian() {
        // G3(r, d)/G3(r, 0) for an isotropic Gaussian of variance 2 mm² at d = 2 mm: exp(-1).
        assert!((slab_weight(2.0, 2.0) - (-1.0f32).exp()).abs() < 1e-6);
        assert_eq!(slab_weight(0.0, 1.0), 1.0);
        assert_eq!(slab_weight(1.0, 0.0), 0.0);
    }

    #[test]
    fn the_fade_reaches_its_ends() {
        assert_eq!(fade_out(0.0, 1.0), 0.0);
        assert_eq!(fade_out(6.0, 1.0), 1.0);
        assert_eq!(fade_out(f32::INFINITY, 1.0), 1.0);
        assert!((fade_out(3.0, 1.0) - 0.5).abs() < 1e-6);
    }
}
