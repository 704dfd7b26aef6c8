//! Light that comes through the body: the translucent shadow map's part of the final pass
//! (d'Eon, Luebke & Enderton 2007, sections 5.2 and 5.4).
//!
//! Equation 16: a slab of thickness d transmits R(sqrt(r² + d²)) = Σ w_i exp(-d²/(2 v_i)) G(v_i, r), so the blurred
//! irradiance of the light-facing side, weighted anew, is what arrives. (The paper prints exp(-d²/v_i); with its own
//! Gaussian, equation 8, the 2 belongs there.)
//!
//! Every Gaussian reads the distance blurred by the Gaussian before it, and fades out where the light-facing place is so
//! near in the texture that the blur along the surface has already brought its light.
//!
//! Where the paper does this for every pixel, it is done here for every second texel and smoothed: the place where a ray
//! towards the light leaves the body jumps from one surface to another, the light that comes through does not.

use crate::passes::atlas::NO_CHART;
use crate::passes::diffusion::{Diffused, median_texel_mm};
use crate::passes::irradiance::distance_slot;
use crate::passes::object_maps::ObjectMaps;
use crate::passes::smooth::smoothed;
use crate::passes::visibility::{LightFacing, faces, light_facing_surface};
use crate::prepare::Kernel;
use crate::progress::Progress;
use cutis_scene::{Bvh, Object, Scene, SurfacePoint};
use glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;

/// Distance in the surface, in standard deviations of a Gaussian, below which it begins to fade (paper, section 5.2).
pub const FADE_DEVIATIONS: f32 = 6.0;

/// Below a millionth of the light nothing shows, and a look-up can be saved.
pub const VISIBLE: f32 = 1e-6;

/// Binomial weights: a standard deviation of one step.
pub const BINOMIAL: [f32; 3] = [6.0, 4.0, 1.0];
/// Standard deviation of the smoothing, mm: less than light spreads on its way through anything but the thinnest parts.
const SMOOTH_MM: f32 = 1.0;

/// Light that has come through one object: radiant exitance under its surface, W/m², at half the size of the irradiance.
pub struct Transmission {
    map: Vec<Vec4>,
}

impl Transmission {
    /// Exitance at a place of the object that `maps` belong to, W/m².
    pub fn at(&self, maps: &ObjectMaps, uv: Vec2, chart: u32) -> Vec3 {
        maps.half_charts.sample(&self.map, uv, chart).map_or(Vec3::ZERO, Vec4::truncate)
    }
}

/// What light comes through a scene's bodies is found from.
#[derive(Clone, Copy)]
pub struct Bodies<'a> {
    /// The whole scene.
    pub scene: &'a Scene,
    /// Rays against it.
    pub bvh: &'a Bvh,
    /// Textures and tables of each object.
    pub maps: &'a [ObjectMaps],
}

impl Bodies<'_> {
    /// Fills the map of one object.
    pub fn transmission(&self, object: &Object, maps: &ObjectMaps, progress: &dyn Progress) -> Transmission {
        let charts = &maps.half_charts;
        progress.begin("transmission", charts.size as u64);
        let mut map: Vec<Vec4> = bytemuck::zeroed_vec(charts.chart.len());
        map.par_chunks_mut(charts.size).enumerate().for_each(|(y, row)| {
            for (x, texel) in row.iter_mut().enumerate() {
                let chart = charts.chart[y * charts.size + x];
                let uv = (Vec2::new(x as f32, y as f32) + 0.5) / charts.size as f32;
                if chart != NO_CHART && self.may_come_through(maps, uv, chart) {
                    let point = maps.atlas.point_under(object, chart, [x, y], 2);
                    *texel = point.map_or(Vec4::ZERO, |p| self.through(maps, &p, chart).extend(0.0));
                }
            }
            progress.advance(1);
        });
        let texel_mm = 2.0 * median_texel_mm(&maps.atlas.charts, &maps.stretch_mm);
        for step in smoothing_steps(texel_mm) {
            map = smoothed(charts, &map, BINOMIAL, step);
        }
        Transmission { map }
    }

    /// Whether any light is behind a body that is not opaque there. Most places can be told from their distances.
    fn may_come_through(&self, maps: &ObjectMaps, uv: Vec2, chart: u32) -> bool {
        (0..self.scene.lights.len()).any(|l| {
            let (layer, component) = distance_slot(l);
            maps.diffused.sample(0, layer, uv, chart)[component] > 0.0
                && slab_weights(&maps.kernel, &maps.diffused, l, uv, chart).is_some()
        })
    }

    fn through(&self, maps: &ObjectMaps, point: &SurfacePoint, chart: u32) -> Vec3 {
        let mut sum = Vec3::ZERO;
        for (l, light) in self.scene.lights.iter().enumerate() {
            if faces(point, light) {
                continue;
            }
            let Some(slab) = slab_weights(&maps.kernel, &maps.diffused, l, point.atlas_uv, chart) else {
                continue;
            };
            let Some(there) = light_facing_surface(self.scene, self.bvh, point, light) else { continue };
            let share = self.share(l, &there);
            if share > 0.0 {
                let apart_mm = self.apart_mm(maps, point, chart, &there);
                let lit = &self.maps[there.object].diffused;
                sum += transmitted(&maps.kernel, &slab, apart_mm, lit, &there) * share;
            }
        }
        sum
    }

    /// Share of a light in what falls on its light-facing side, so that light counted once is not counted again.
    pub fn share(&self, l: usize, there: &LightFacing) -> f32 {
        let maps = &self.maps[there.object];
        match maps.shares.get(l) {
            Some(shares) => maps.atlas.charts.sample(shares, there.atlas_uv, there.chart).unwrap_or(0.0),
            None => 1.0,
        }
    }

    /// Distance along the surface to the light-facing place, mm. Within a chart the texture tells. Between charts no blur
    /// has brought its light here if it lies on the other side of a thin part (opposite normals: infinitely far); around
    /// an edge (like normals) it is a neighbour beyond the seam, as far away as it looks.
    fn apart_mm(&self, maps: &ObjectMaps, point: &SurfacePoint, chart: u32, there: &LightFacing) -> f32 {
        if std::ptr::eq(maps, &self.maps[there.object]) && chart == there.chart {
            return maps.along_surface_mm(point.atlas_uv, there.atlas_uv);
        }
        let opposite = (-there.normal.dot(point.normal)).clamp(0.0, 1.0);
        // 1e-6 keeps the quotient finite; a micrometre over it is a metre.
        there.distance_mm / (1.0 - opposite).max(1e-6)
    }
}

/// Steps in texels of the rounds of smoothing, each twice as long as the one before, until the variance is nearly reached.
pub fn smoothing_steps(texel_mm: f32) -> Vec<usize> {
    let (mut step, mut variance_mm2) = (1, 0.0);
    let mut steps = Vec::new();
    while variance_mm2 + 0.5 * (step as f32 * texel_mm).powi(2) < SMOOTH_MM * SMOOTH_MM {
        steps.push(step);
        variance_mm2 += (step as f32 * texel_mm).powi(2);
        step *= 2;
    }
    steps
}

/// What the body lets through at a place from light number `light`, for every Gaussian, before any fading. `None` if
/// nothing comes through that could be seen, so that no ray need be cast.
fn slab_weights(kernel: &Kernel, maps: &Diffused, light: usize, uv: Vec2, chart: u32) -> Option<Vec<f32>> {
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
fn transmitted(kernel: &Kernel, slab: &[f32], apart_mm: f32, maps: &Diffused, there: &LightFacing) -> Vec3 {
    let mut sum = Vec3::ZERO;
    for (i, (&variance_mm2, &weight)) in kernel.variances_mm2.iter().zip(&kernel.weights).enumerate() {
        let through = slab[i] * fade_out(apart_mm, variance_mm2);
        if through > VISIBLE {
            sum += weight * through * maps.sample(i + 1, 0, there.atlas_uv, there.chart).truncate();
        }
    }
    sum
}

/// exp(-d²/2v): what a slab of thickness d leaves of a Gaussian of variance v.
fn slab_weight(d_mm: f32, variance_mm2: f32) -> f32 {
    if variance_mm2 <= 0.0 {
        return 0.0;
    }
    (-d_mm * d_mm / (2.0 * variance_mm2)).exp()
}

/// 0 where both places are one, 1 from six standard deviations on.
fn fade_out(apart_mm: f32, variance_mm2: f32) -> f32 {
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
