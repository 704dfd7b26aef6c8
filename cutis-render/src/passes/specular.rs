//! Light reflected by the surface itself (d'Eon, Luebke & Enderton 2007, section 5.4, last line of the final pass).

use crate::prepare::{FilteredEnvironment, RhoDt};
use crate::specular_brdf::kelemen_szirmay_kalos_per_sr;
use cutis_scene::LightSample;
use glam::Vec3;

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

    /// Radiance reflected from the environment, of which the fraction `open` is not hidden, W/(m² sr).
    pub fn from_environment(&self, environment: &FilteredEnvironment, rho_dt: &RhoDt, open: f32) -> Vec3 {
        let cos_eye = self.normal.dot(self.dir_to_eye).max(0.0);
        let mirrored = self.normal * (2.0 * self.normal.dot(self.dir_to_eye)) - self.dir_to_eye;
        let albedo = self.rho_s * rho_dt.specular_albedo(cos_eye, self.roughness);
        environment.reflection(mirrored, self.roughness)
            * (albedo * specular_openness(cos_eye, open, self.roughness))
    }
}

/// Occlusion of a specular lobe from that of the whole hemisphere (Lagarde & de Rousiers 2014, "Moving Frostbite to
/// PBR", section 4.10.2): narrow lobes see past what hides much of the hemisphere, until nearly all is hidden.
fn specular_openness(cos_eye: f32, open: f32, roughness: f32) -> f32 {
    let exponent = (-16.0 * roughness - 1.0).exp2();
    ((cos_eye + open).powf(exponent) - 1.0 + open).clamp(0.0, 1.0)
}
