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

/// Below a millionth of the light nothing shows, and a look-up can be saved.
const VISIBLE: f32 = 1e-6;

/// What the body lets through at a place from light number `light`, for every Gaussian, before any fading. `None` if
/// nothing comes through that could be seen, so that no ray need be cast.
pub fn slab_weights(
    kernel: &Kernel,
    maps: &Diffused,
    light: usize,
    uv: Vec2,
    chart: u32,
) -> Option<Vec<f32>> {
    let (layer, component) = distance_slot(light);
    let weight = |(i, &v): (usize, &f32)| slab_weight(maps.sample(i, layer, uv, chart)[component], v);
    // Narrow Gaussians pass less than wide ones unless the distance varies wildly: most places end with the widest.
    let last = kernel.variances_mm2.len() - 1;
    if weight((last, &kernel.variances_mm2[last])) < VISIBLE && kernel.variances_mm2[last] > 0.0 {
        return None;
    }
    let weights: Vec<f32> = kernel.variances_mm2.iter().enumerate().map(weight).collect();
    weights.iter().any(|&w| w > VISIBLE).then_some(weights)
}

/// Radiant exitance under the surface from the light-facing place, `apart_mm` away along the surface, W/m².
pub fn transmitted(
    kernel: &Kernel,
    slab: &[f32],
    apart_mm: f32,
    maps: &Diffused,
    there: &LightFacing,
) -> Vec3 {
    let mut sum = Vec3::ZERO;
    for (i, (&variance_mm2, &weight)) in kernel.variances_mm2.iter().zip(&kernel.weights).enumerate() {
        let through = slab[i] * fade_out(apart_mm, variance_mm2);
        if through > VISIBLE {
            sum += weight * through * maps.sample(i + 1, 0, there.uv, there.chart).truncate();
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
