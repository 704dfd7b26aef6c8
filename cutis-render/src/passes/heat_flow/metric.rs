//! How far apart texels are on the surface: the metric of the unrolled surface.
//!
//! Symbols: X the surface over texels, mm; E = Xu·Xu, F = Xu·Xv, G = Xv·Xv the metric g; a = sqrt(det g) g^-1 what heat flows
//! by between texels; sqrt(det g) the area of a texel, mm².

use crate::passes::atlas::{Atlas, NO_CHART};
use crate::passes::stretch::derivatives_mm;
use cutis_scene::Object;
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Heat crosses texels narrower than this part of the usual one as if they were that wide: slivers would set the pace for all
/// others. Their areas, and what flows along them, are true.
pub const SMALLEST: f32 = 0.63;
/// Part of that pace which is left to texels with longer steps ([`super::strides`]).
const BESIDE_STRIDES: f32 = 0.5;

/// Across no direction that many slivers have: neither an axis nor a diagonal.
const AHEAD: Vec2 = Vec2::new(0.9, 0.4);

/// The metric under one texel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Metric {
    /// a11, a12 and a22, no unit.
    pub a: Vec3,
    /// Area of the texel, mm².
    pub area_mm2: f32,
}

impl Metric {
    /// The same where heat flows that much better.
    pub fn conducting(self, factor: f32) -> Self {
        Self { a: self.a * factor, ..self }
    }

    /// From the derivatives along both axes, mm per texel.
    pub fn new([xu, xv]: [Vec3; 2]) -> Self {
        let (e, f, g) = (xu.length_squared(), xu.dot(xv), xv.length_squared());
        let area_mm2 = (e * g - f * f).max(0.0).sqrt();
        // Without an area nothing can be said, and nothing flows.
        let per_area = if area_mm2 > 0.0 { area_mm2.recip() } else { 0.0 };
        let a = Vec3::new(g, -f, e) * per_area;
        if a.is_finite() && area_mm2.is_finite() { Self { a, area_mm2 } } else { Self::default() }
    }

    /// What may flow from texel to texel, where the usual one is `texel_mm` wide: with longer steps beside it half as much.
    pub fn cut(self, has_strides: bool, texel_mm: f32) -> Self {
        let part = if has_strides { BESIDE_STRIDES } else { 1.0 };
        Self { a: at_most(self.a, part * self.area_mm2 / (SMALLEST * texel_mm).powi(2)), ..self }
    }

    /// The shortest way across a texel, mm; 0 where there is none.
    pub fn narrowest_mm(&self) -> f32 {
        (self.area_mm2 / largest(self.a).max(f32::MIN_POSITIVE)).sqrt()
    }

    /// The longest way across it, mm.
    pub fn widest_mm(&self) -> f32 {
        let low = self.a.x + self.a.z - largest(self.a);
        (self.area_mm2 / low.max(f32::MIN_POSITIVE)).sqrt()
    }

    /// The direction in the texture in which the shortest way leads.
    pub fn narrow_direction(&self) -> Vec2 {
        let Vec3 { x, y, z } = self.a;
        let low = x + z - largest(self.a);
        // Both columns of what is left without the smaller eigenvalue; the longer one is less of a rounding.
        let (one, other) = (Vec2::new(x - low, y), Vec2::new(y, z - low));
        let longer = if one.length_squared() > other.length_squared() { one } else { other };
        // Neighbours agree which way it points, unless it lies across [`AHEAD`].
        let towards = if longer.dot(AHEAD) < 0.0 { -longer } else { longer };
        towards.try_normalize().unwrap_or(Vec2::X)
    }

    /// The most energy that light on the four corners of a square has, by the sum of its squares. Slopes have that of a; the wave
    /// that alternates has a third of its trace, which is less than the larger eigenvalue.
    pub fn strength(&self) -> f32 {
        largest(self.a)
    }
}

/// The larger eigenvalue of a symmetric matrix, by its entries 11, 12 and 22.
fn largest(a: Vec3) -> f32 {
    0.5 * (a.x + a.z) + (0.25 * (a.x - a.z).powi(2) + a.y * a.y).sqrt()
}

/// The same matrix with eigenvalues of at most `most`.
fn at_most(a: Vec3, most: f32) -> Vec3 {
    let (high, trace) = (largest(a), a.x + a.z);
    let low = trace - high;
    if high <= most {
        return a;
    }
    // a = low + (high - low) d dᵀ with the direction d of the larger one.
    let along = if high > low { (a - Vec3::new(low, 0.0, low)) / (high - low) } else { Vec3::ZERO };
    let low = low.min(most);
    Vec3::new(low, 0.0, low) + along * (most - low)
}

/// The metric of every triangle as far as heat flows by it from texel to texel; those that are `narrow` have longer steps, too.
/// Nothing for those that have no area in the texture.
pub fn metrics(object: &Object, size: usize, narrow: &[bool], texel_mm: f32) -> Vec<Metric> {
    let of =
        |t: usize| derivatives_mm_per_texel(object, t, size).map(|x| Metric::new(x).cut(narrow[t], texel_mm));
    (0..object.mesh.triangles.len()).into_par_iter().map(|t| of(t).unwrap_or_default()).collect()
}

/// How much better heat flows under a place of the material's maps than by the medium: the factor on its mean free path,
/// squared.
pub fn conductivity(object: &Object, map_uv: Vec2) -> f32 {
    object.material.mean_free_path_scale_at(map_uv).powi(2)
}

/// Its mean over the texels of charts.
pub fn usual_conductivity(object: &Object, atlas: &Atlas) -> f32 {
    let add = |a: (f64, f64), b: (f64, f64)| (a.0 + b.0, a.1 + b.1);
    let (sum, count) =
        conductivities(object, atlas).map(|own| (f64::from(own), 1.0)).reduce(|| (0.0, 0.0), add);
    if count > 0.0 { (sum / count) as f32 } else { 1.0 }
}

/// The largest over the texels of charts.
pub fn best_conductivity(object: &Object, atlas: &Atlas) -> f32 {
    conductivities(object, atlas).reduce(|| 0.0, f32::max)
}

/// Those of all texels of charts; where it is the same everywhere, that one.
fn conductivities(object: &Object, atlas: &Atlas) -> impl ParallelIterator<Item = f32> {
    let varies = object.material.mean_free_path_scale.texture.is_some();
    let count = if varies { atlas.surface.len() } else { 0 };
    let everywhere = (!varies).then(|| conductivity(object, Vec2::ZERO));
    let of = |i: usize| atlas.map_uv_under(object, i).map(|uv| conductivity(object, uv));
    (0..count).into_par_iter().filter_map(of).chain(everywhere)
}

/// The metric under every texel that a chart covers, and how well heat flows there; nothing elsewhere.
pub fn metrics_of_texels(object: &Object, atlas: &Atlas, of_triangles: &[Metric]) -> Vec<Metric> {
    let even = object.material.mean_free_path_scale.texture.is_none();
    let everywhere = conductivity(object, Vec2::ZERO);
    let of = |i: usize| {
        let triangle = atlas.surface[i].triangle;
        if triangle == NO_CHART {
            return Metric::default();
        }
        let factor =
            if even { None } else { atlas.map_uv_under(object, i).map(|uv| conductivity(object, uv)) };
        of_triangles[triangle as usize].conducting(factor.unwrap_or(everywhere))
    };
    (0..atlas.surface.len()).into_par_iter().map(of).collect()
}

/// dX/du and dX/dv of a triangle, mm per texel. `None` if it has no area in the texture.
pub fn derivatives_mm_per_texel(object: &Object, triangle: usize, size: usize) -> Option<[Vec3; 2]> {
    let derivatives = derivatives_mm(object, triangle)?.map(|d| d / size as f32);
    derivatives.iter().all(|d| d.is_finite()).then_some(derivatives)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Texels of a tenth of the usual width, however they lie: light flows along them as it should, across as if they were wider.
    #[test]
    fn slivers_are_widened_across_whatever_their_direction() {
        for turn in 0..24 {
            let angle = turn as f32 * std::f32::consts::TAU / 24.0;
            let [along, across] = [Vec2::from_angle(angle), Vec2::from_angle(angle).perp()];
            // One millimetre along, a tenth of that across.
            let x = [along.x, along.y].map(|part| Vec3::new(part, 0.0, 0.0));
            let y = [across.x, across.y].map(|part| Vec3::new(0.0, 0.1 * part, 0.0));
            let metric = Metric::new([x[0] + y[0], x[1] + y[1]]);
            assert!((metric.narrowest_mm() - 0.1).abs() < 1e-5, "{turn}: {metric:?}");
            assert!(metric.narrow_direction().dot(across).abs() > 1.0 - 1e-5, "{turn}: {metric:?}");
            let Metric { a, area_mm2 } = metric.cut(false, 1.0);
            let flow = |d: Vec2| a.x * d.x * d.x + 2.0 * a.y * d.x * d.y + a.z * d.y * d.y;
            assert!((area_mm2 - 0.1).abs() < 1e-5, "{turn}: {area_mm2}");
            assert!((flow(along) - 0.1).abs() < 1e-4, "{turn}: {a}");
            assert!((flow(across) - 0.1 / (SMALLEST * SMALLEST)).abs() < 1e-4, "{turn}: {a}");
        }
    }

    /// Axes that nearly coincide, and are a thousand times as long as the texel is wide: what bounds hold by must hold for rounded
    /// numbers, too.
    #[test]
    fn no_sliver_is_stronger_than_its_area_allows() {
        for turn in 0..2000 {
            let along = Vec2::from_angle(turn as f32 * 0.37);
            let apart = 10f32.powf(-6.0 + 0.004 * turn as f32);
            let xu = Vec3::new(along.x, along.y, 0.3) * 100.0;
            let xv = xu * 1.3 + Vec3::new(-along.y, along.x, 0.0) * apart;
            let metric = Metric::new([xu, xv]).cut(false, 6.7);
            let most = metric.area_mm2 / (SMALLEST * 6.7).powi(2);
            assert!(metric.strength() <= 1.001 * most, "{apart}: {metric:?} {most}");
        }
    }

    /// The energy of any light on a square of unit texels, by its links, is at most its strength; the waves that reach it are known.
    #[test]
    fn no_light_on_a_square_has_more_energy_than_its_strength() {
        for a in [Vec3::new(1.0, 0.0, 1.0), Vec3::new(2.0, 0.6, 0.7), Vec3::new(0.5, -0.4, 3.0)] {
            let strength = Metric { a, area_mm2: 1.0 }.strength();
            let [east, north] = [a.x / 3.0 - a.z / 6.0, a.z / 3.0 - a.x / 6.0];
            let [rising, falling] = [0.5, -0.5].map(|part| (a.x + a.z) / 6.0 + part * a.y);
            let links =
                [(0, 1, east), (2, 3, east), (0, 2, north), (1, 3, north), (0, 3, rising), (1, 2, falling)];
            let energy = |u: [f32; 4]| {
                let sum: f32 = links.iter().map(|&(i, j, link)| link * (u[i] - u[j]).powi(2)).sum();
                sum / u.iter().map(|u| u * u).sum::<f32>()
            };
            let slope = |d: Vec2| [-d.x - d.y, d.x - d.y, d.y - d.x, d.x + d.y];
            let slopes = (0..360).map(|turn| energy(slope(Vec2::from_angle((turn as f32).to_radians()))));
            let most = slopes.fold(energy([1.0, -1.0, -1.0, 1.0]), f32::max);
            assert!((most / strength - 1.0).abs() < 1e-3, "{a}: {most} {strength}");
        }
    }
}
