//! rho_dt: the light that the specular surface leaves for the body (d'Eon, Luebke & Enderton 2007, section 6).
//!
//! rho_dt(cos, m) = 1 - rho_s · S(cos, m), S the directional albedo of the lobe for rho_s = 1. Tabulated over the cosine
//! and the roughness; the mean over the cosine-weighted hemisphere, for light from all around, beside it.
//!
//! S is integrated over half vectors: with dω_l = 4 (V·H) dω_h and |L + V|² = 4 (V·H)², f cos_l dω_l becomes
//! D F (N·L) / (V·H) dω_h, and half vectors drawn with density D cos_h leave F (N·L) / ((V·H)(N·H)).

use crate::sampling::beckmann_half_vector;
use crate::specular_brdf::{MIN_ROUGHNESS, fresnel_schlick};
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Entries along the cosine. The albedo is smooth in sqrt(cos), which is what is sampled evenly.
pub const COSINES: usize = 64;
/// Entries along the roughness, from [`MIN_ROUGHNESS`] to 1.
pub const ROUGHNESSES: usize = 32;
/// Half vectors along each axis of the integral.
const NODES: u32 = 48;

/// The table for one F0.
#[derive(Debug, Clone)]
pub struct RhoDt {
    albedo: Vec<f32>,
    mean_albedo: Vec<f32>,
}

impl RhoDt {
    /// Integrates the lobe for reflectance `f0` at normal incidence.
    pub fn new(f0: f32) -> Self {
        let row = |r: usize| {
            let halves = half_vectors(roughness_of(r));
            (0..COSINES).map(|c| directional_albedo(cosine_of(c), &halves, f0)).collect::<Vec<f32>>()
        };
        let rows: Vec<Vec<f32>> = (0..ROUGHNESSES).into_par_iter().map(row).collect();
        let albedo = rows.concat();
        let mean_albedo =
            (0..ROUGHNESSES).map(|r| mean_over_hemisphere(&albedo[r * COSINES..][..COSINES])).collect();
        Self { albedo, mean_albedo }
    }

    /// Directional albedos, [`COSINES`] for each of [`ROUGHNESSES`]; even in the square root of the cosine.
    pub fn albedos(&self) -> &[f32] {
        &self.albedo
    }

    /// Their means over the hemisphere, one for each of [`ROUGHNESSES`].
    pub fn mean_albedos(&self) -> &[f32] {
        &self.mean_albedo
    }

    /// Directional albedo S of the lobe for rho_s = 1: the fraction of light from `cos` that it reflects.
    pub fn specular_albedo(&self, cos: f32, roughness: f32) -> f32 {
        let x = cos.clamp(0.0, 1.0).sqrt() * (COSINES - 1) as f32;
        let (row, fy) = roughness_row(roughness);
        let (column, fx) = ((x as usize).min(COSINES - 2), x - x.floor().min((COSINES - 2) as f32));
        let line = |r: usize| {
            let a = &self.albedo[r * COSINES + column..];
            a[0] + (a[1] - a[0]) * fx
        };
        line(row) + (line(row + 1) - line(row)) * fy
    }

    /// rho_dt for light (or the eye) at `cos` from the normal; never negative.
    pub fn at(&self, cos: f32, roughness: f32, rho_s: f32) -> f32 {
        (1.0 - rho_s * self.specular_albedo(cos, roughness)).max(0.0)
    }

    /// rho_dt for light that comes evenly from the whole hemisphere.
    pub fn mean(&self, roughness: f32, rho_s: f32) -> f32 {
        let (row, f) = roughness_row(roughness);
        let albedo = self.mean_albedo[row] + (self.mean_albedo[row + 1] - self.mean_albedo[row]) * f;
        (1.0 - rho_s * albedo).max(0.0)
    }
}

fn cosine_of(column: usize) -> f32 {
    (column as f32 / (COSINES - 1) as f32).powi(2)
}

fn roughness_of(row: usize) -> f32 {
    MIN_ROUGHNESS + (1.0 - MIN_ROUGHNESS) * row as f32 / (ROUGHNESSES - 1) as f32
}

/// Row at or below a roughness, and how far it is to the next.
fn roughness_row(roughness: f32) -> (usize, f32) {
    let y = (roughness.clamp(MIN_ROUGHNESS, 1.0) - MIN_ROUGHNESS) / (1.0 - MIN_ROUGHNESS)
        * (ROUGHNESSES - 1) as f32;
    let row = (y as usize).min(ROUGHNESSES - 2);
    (row, y - row as f32)
}

/// The nodes of the integral.
fn half_vectors(roughness: f32) -> Vec<Vec3> {
    let node = |i: u32| Vec2::new((i % NODES) as f32 + 0.5, (i / NODES) as f32 + 0.5) / NODES as f32;
    (0..NODES * NODES).map(|i| beckmann_half_vector(node(i), roughness)).collect()
}

fn directional_albedo(cos: f32, half_vectors: &[Vec3], f0: f32) -> f32 {
    let cos = cos.max(1e-4); // the limit at grazing; exactly 0 has no plane of incidence
    let dir_to_eye = Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
    let mut sum = 0.0f64;
    for half in half_vectors {
        let cos_difference = dir_to_eye.dot(*half);
        let cos_light = 2.0 * cos_difference * half.z - dir_to_eye.z;
        if cos_difference > 0.0 && cos_light > 0.0 {
            sum += f64::from(fresnel_schlick(cos_difference, f0) * cos_light / (cos_difference * half.z));
        }
    }
    (sum / half_vectors.len() as f64) as f32
}

/// 2 ∫ S(cos) cos dcos over the table's own cosines: with cos = x², 4 ∫ S x³ dx by the trapezoid rule in x.
fn mean_over_hemisphere(albedo: &[f32]) -> f32 {
    let step = 1.0 / (COSINES - 1) as f32;
    let value = |i: usize| 4.0 * albedo[i] * (i as f32 * step).powi(3);
    (0..COSINES - 1).map(|i| 0.5 * (value(i) + value(i + 1)) * step).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::specular_brdf::kelemen_szirmay_kalos_per_sr;

    /// The slow oracle: the lobe itself, integrated over light directions on a fine grid.
    fn albedo_by_quadrature(cos: f32, roughness: f32, f0: f32) -> f64 {
        let eye = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
        let (rings, sectors) = (1200, 600);
        let mut sum = 0.0;
        for i in 0..rings {
            let z = (i as f32 + 0.5) / rings as f32;
            for j in 0..sectors {
                // Half the circle is enough: the lobe is symmetric about the plane of incidence.
                let phi = (j as f32 + 0.5) / sectors as f32 * std::f32::consts::PI;
                let r = (1.0 - z * z).sqrt();
                let light = Vec3::new(r * phi.cos(), r * phi.sin(), z);
                let half = (light + eye).normalize();
                sum += f64::from(kelemen_szirmay_kalos_per_sr(half.z, eye.dot(half), roughness, f0) * z);
            }
        }
        sum * std::f64::consts::TAU / f64::from(rings * sectors)
    }

    #[test]
    fn table_agrees_with_quadrature_over_directions() {
        let table = RhoDt::new(0.028);
        for (cos, m) in [
            (1.0, 0.3),
            (0.7, 0.3),
            (0.33, 0.3),
            (0.12, 0.3),
            (0.9, 0.12),
            (0.41, 0.57),
            (0.2, 0.9),
            (0.55, 0.23),
        ] {
            let quadrature = albedo_by_quadrature(cos, m, 0.028);
            let tabulated = f64::from(table.specular_albedo(cos, m));
            assert!(
                (tabulated - quadrature).abs() < 1e-3,
                "cos {cos}, m {m}: {tabulated} against {quadrature}"
            );
        }
    }

    #[test]
    fn a_smooth_surface_reflects_what_fresnel_says() {
        let table = RhoDt::new(0.028);
        for cos in [1.0, 0.8, 0.5] {
            // A lobe of slope m = 0.02 widens the mirror by O(m²).
            assert!(
                (table.specular_albedo(cos, MIN_ROUGHNESS) - fresnel_schlick(cos, 0.028)).abs() < 2e-3,
                "{cos}"
            );
        }
    }

    #[test]
    fn nothing_is_gained_in_a_white_furnace() {
        // Light 1 from everywhere on a white body: what the surface reflects plus what enters and leaves again.
        for f0 in [0.0, 0.028, 0.04, 0.1] {
            let table = RhoDt::new(f0);
            for i in 0..=200 {
                let cos = i as f32 / 200.0;
                for j in 0..=50 {
                    let m = j as f32 / 50.0;
                    for rho_s in [0.0, 0.5, 1.0] {
                        let specular = rho_s * table.specular_albedo(cos, m);
                        let diffuse = table.mean(m, rho_s) * table.at(cos, m, rho_s);
                        let sum = specular + diffuse;
                        assert!(sum <= 1.0 + 1e-5, "cos {cos}, m {m}, rho_s {rho_s}, F0 {f0}: {sum}");
                        assert!(table.at(cos, m, rho_s) >= 0.0);
                    }
                }
            }
        }
    }
}
