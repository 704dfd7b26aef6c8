//! How good the diffusion is: energy kept, light that does not match across seams, and how wide its texels are.

use crate::passes::atlas::charts_that_hold_light;
use crate::passes::diffusion::Diffused;
use crate::passes::object_maps::ObjectMaps;
use crate::passes::texel_widths::TexelWidths;
use cutis_scene::Object;
use cutis_scene::charts::Seam;
use glam::{Vec2, Vec3};

/// Places along every seam edge at which both sides are compared.
const PLACES: usize = 4;

/// What the diffusion did to the light, as numbers.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct DiffusionReport {
    /// Name of the object.
    pub object: String,
    /// Total energy before, summed over red, green and blue of the kernel's total, W/m² times mm².
    pub energy_before_w_per_m2_mm2: f64,
    /// Total energy after.
    pub energy_after_w_per_m2_mm2: f64,
    /// Change of the total, as a fraction of what was there.
    pub energy_change: f64,
    /// Seam edges compared.
    pub seam_edges: usize,
    /// Mean mismatch of diffused light across seams, relative to its mean there.
    pub seam_error_mean: f64,
    /// The same, 99th percentile.
    pub seam_error_p99: f64,
    /// Widths of the light's texels on the surface.
    pub texels: TexelWidths,
}

/// Measures an object's diffused light.
pub fn diffusion_report(object: &Object, maps: &ObjectMaps) -> DiffusionReport {
    let before =
        energy(object, |uv, chart| maps.kernel.total() * maps.diffused.sample(0, 0, uv, chart).truncate());
    let after = energy(object, |uv, chart| diffused(&maps.diffused, &maps.kernel.weights, uv, chart));
    let [mean, p99] = seam_errors(object, maps);
    DiffusionReport {
        object: object.name.clone(),
        energy_before_w_per_m2_mm2: before,
        energy_after_w_per_m2_mm2: after,
        energy_change: if before > 0.0 { after / before - 1.0 } else { 0.0 },
        seam_edges: object.charts.seams.len(),
        seam_error_mean: mean,
        seam_error_p99: p99,
        texels: TexelWidths::new(object, maps.atlas.size),
    }
}

fn diffused(maps: &Diffused, weights: &[Vec3], uv: Vec2, chart: u32) -> Vec3 {
    maps.weighted_sum(weights, uv, chart)
}

/// Light times area over the surface, by several points in every triangle.
fn energy(object: &Object, light: impl Fn(Vec2, u32) -> Vec3) -> f64 {
    const SPLITS: usize = 6;
    let mesh = &object.mesh;
    let per_triangle = |t: usize| {
        let [a, b, c] = mesh.corner_atlas_uvs(t);
        let chart = object.charts.of_triangle[t];
        let mut sum = 0.0f64;
        // Centres of the small triangles of a regular subdivision, upright and turned.
        for i in 0..SPLITS {
            for j in 0..SPLITS - i {
                let at = |o: f32| {
                    let (u, v) = ((i as f32 + o) / SPLITS as f32, (j as f32 + o) / SPLITS as f32);
                    f64::from(light(a + (b - a) * u + (c - a) * v, chart).element_sum())
                };
                sum += at(1.0 / 3.0);
                if i + j + 1 < SPLITS {
                    sum += at(2.0 / 3.0);
                }
            }
        }
        sum * f64::from(mesh.area_mm2(t)) / (SPLITS * SPLITS) as f64
    };
    (0..mesh.triangles.len()).map(per_triangle).sum()
}

/// Mean and 99th percentile of |a - b| over the mean of all a and b, where both charts are large enough to hold light.
fn seam_errors(object: &Object, maps: &ObjectMaps) -> [f64; 2] {
    let holds_light = charts_that_hold_light(object, maps.atlas.size);
    let compared = |seam: &&Seam| {
        seam.triangles.iter().all(|&t| holds_light[object.charts.of_triangle[t as usize] as usize])
    };
    let seams = object.charts.seams.iter().filter(compared);
    let pairs: Vec<[f64; 2]> = seams.flat_map(|seam| sides(object, maps, seam)).collect();
    if pairs.is_empty() {
        return [0.0; 2];
    }
    let mean = pairs.iter().map(|[a, b]| 0.5 * (a + b)).sum::<f64>() / pairs.len() as f64;
    let mut errors: Vec<f64> =
        pairs.iter().map(|[a, b]| (a - b).abs() / mean.max(f64::MIN_POSITIVE)).collect();
    errors.sort_by(f64::total_cmp);
    let p99 = errors[(errors.len() - 1) * 99 / 100];
    [errors.iter().sum::<f64>() / errors.len() as f64, p99]
}

/// Diffused light on both sides at a few places along a seam edge.
fn sides(object: &Object, maps: &ObjectMaps, seam: &Seam) -> Vec<[f64; 2]> {
    let at = |side: usize, f: f32| {
        let [from, to] = seam.uvs[side];
        let chart = object.charts.of_triangle[seam.triangles[side] as usize];
        f64::from(diffused(&maps.diffused, &maps.kernel.weights, from.lerp(to, f), chart).element_sum())
    };
    (0..PLACES).map(|i| (i as f32 + 0.5) / PLACES as f32).map(|f| [at(0, f), at(1, f)]).collect()
}
