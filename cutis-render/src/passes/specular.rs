//! Light reflected by the surface itself (d'Eon, Luebke & Enderton 2007, section 5.4, last line of the final pass).

use crate::prepare::{FilteredEnvironment, RhoDt};
use crate::specular_brdf::{MIN_ROUGHNESS, kelemen_szirmay_kalos_per_sr};
use cutis_scene::LightSample;
use glam::Vec3;
use std::f32::consts::FRAC_PI_2;

/// The surface's shine at one point.
#[derive(Debug, Clone, Copy)]
pub struct Shine {
    /// Shading normal.
    pub normal: Vec3,
    /// Unit vector to the eye.
    pub dir_to_eye: Vec3,
    /// Specular intensity rho_s.
    pub rho_s: f32,
    /// Beckmann roughness m.
    pub roughness: f32,
    /// Fresnel reflectance at normal incidence.
    pub f0: f32,
}

impl Shine {
    /// Radiance reflected from a light that is visible, W/(m² sr).
    pub fn from_light(&self, light: &LightSample) -> Vec3 {
        let cos_light = self.normal.dot(light.dir_to_light);
        if cos_light <= 0.0 {
            return Vec3::ZERO;
        }
        let half = (light.dir_to_light + self.dir_to_eye).normalize_or(self.normal);
        let (cos_half, cos_difference) = (self.normal.dot(half), self.dir_to_eye.dot(half));
        let lobe_per_sr = kelemen_szirmay_kalos_per_sr(cos_half, cos_difference, self.roughness, self.f0);
        light.irradiance_w_per_m2 * (self.rho_s * lobe_per_sr * cos_light)
    }

    /// Radiance reflected from the environment, of which the fraction `open` is not hidden, `bent` being the middle of that,
    /// W/(m² sr).
    pub fn from_environment(
        &self,
        environment: &FilteredEnvironment,
        rho_dt: &RhoDt,
        (bent, open): (Vec3, f32),
    ) -> Vec3 {
        let cos_eye = self.normal.dot(self.dir_to_eye).max(0.0);
        let mirrored = self.normal * (2.0 * self.normal.dot(self.dir_to_eye)) - self.dir_to_eye;
        let albedo = self.rho_s * rho_dt.specular_albedo(cos_eye, self.roughness);
        let seen = lobe_openness([self.normal.dot(mirrored), bent.dot(mirrored)], self.roughness, open);
        environment.reflection(mirrored, self.roughness) * (albedo * seen)
    }
}

/// Share of a specular lobe that is not hidden, by cosines of its mirror direction with the normal and with the bent normal:
/// the lobe and what is open are taken for cones, and only what the surface itself does not hide counts
/// (Jimenez et al. 2016, "Practical Real-Time Strategies for Accurate Indirect Occlusion", section 5).
fn lobe_openness([cos_normal, cos_bent]: [f32; 2], roughness: f32, open: f32) -> f32 {
    // Half vectors turn by half as much as directions.
    let lobe_rad = 2.0 * roughness.max(MIN_ROUGHNESS).atan();
    // A cone around the normal that is all there is to see lets in the square of its sine.
    let open_rad = open.clamp(0.0, 1.0).sqrt().asin();
    let whole = shared_by_caps(lobe_rad, FRAC_PI_2, cos_normal.clamp(0.0, 1.0).acos());
    (shared_by_caps(lobe_rad, open_rad, cos_bent.clamp(-1.0, 1.0).acos()) / whole).min(1.0)
}

/// Solid angle over 2π that two spherical caps of some angular radii share, `apart_rad` between their middles: the smaller
/// cap where one holds the other, and a smooth step to nothing (Oat & Sander 2007, "Ambient aperture lighting").
fn shared_by_caps(a_rad: f32, b_rad: f32, apart_rad: f32) -> f32 {
    let smaller = 1.0 - a_rad.min(b_rad).cos();
    let (inside, outside) = ((a_rad - b_rad).abs(), a_rad + b_rad);
    let t = ((outside - apart_rad) / (outside - inside).max(1e-6)).clamp(0.0, 1.0);
    smaller * t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{r2_point, random2};
    use glam::Vec2;

    #[test]
    fn nothing_is_hidden_where_all_is_open_and_all_where_nothing_is() {
        for cos in [0.0, 0.02, 0.3, 0.9, 1.0] {
            for roughness in [0.0, 0.1, 0.3, 1.0] {
                assert!((lobe_openness([cos, cos], roughness, 1.0) - 1.0).abs() < 1e-5, "{cos}, {roughness}");
                assert_eq!(lobe_openness([cos, cos], roughness, 0.0), 0.0);
            }
        }
    }

    #[test]
    fn more_is_seen_through_a_wider_opening_and_nearer_to_its_middle() {
        let seen = |cos_bent: f32, open: f32| lobe_openness([0.5, cos_bent], 0.3, open);
        for i in 0..20 {
            let (less, more) = (i as f32 / 20.0, (i + 1) as f32 / 20.0);
            assert!(seen(0.5, less) <= seen(0.5, more));
            assert!(seen(less, 0.5) <= seen(more, 0.5));
        }
        assert_eq!(seen(-0.5, 0.5), 0.0, "what opens to the other side shows nothing");
    }

    /// The smooth step stands for a formula with three arc cosines, and is off by less than a tenth of the smaller cap.
    #[test]
    fn caps_share_what_points_on_the_sphere_find_in_both() {
        let shift = random2(0, 0, 7, 1);
        let points: Vec<_> = (0..200_000).map(|i| on_sphere(r2_point(i, shift))).collect();
        for (a, b, apart) in [(0.5f32, 1.2f32, 0.9f32), (0.5, 0.4, 0.5), (1.0, 1.57, 1.3), (0.3, 1.0, 0.2)] {
            let other = Vec3::new(apart.sin(), 0.0, apart.cos());
            let both = points.iter().filter(|p| p.z > a.cos() && p.dot(other) > b.cos()).count();
            let exact = 2.0 * both as f32 / points.len() as f32;
            let smaller = 1.0 - a.min(b).cos();
            let off = (shared_by_caps(a, b, apart) - exact) / smaller;
            assert!(off.abs() < 0.1, "{a}, {b}, {apart}: off by {off}");
        }
    }

    fn on_sphere(p: Vec2) -> Vec3 {
        let z = 2.0 * p.x - 1.0;
        let aside = (1.0 - z * z).sqrt();
        let angle_rad = std::f32::consts::TAU * p.y;
        Vec3::new(aside * angle_rad.cos(), aside * angle_rad.sin(), z)
    }
}
