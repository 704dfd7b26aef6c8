//! Absorption over the distance that light travels through the body, as a depth map tells it (Green 2004, GPU Gems,
//! chapter 16, section 16.3).
//!
//! Symbols: d_i and d_o distances of the light from where it enters and where it leaves, s = d_o - d_i; what comes through is
//! e^(-s sigma_t) of what entered, or what a colour ramp says of s. The processor casts rays where the paper reads maps:
//! see [`way`].
//!
//! What faces the light is lit as any opaque surface. The paper's listing returns the exponential for the whole body and
//! leaves to others how it is combined with a lighting model; where it begins at the terminator it would leave a line. So
//! light that is known by its distance only spreads over the surface it leaves by, as a beam does: the cosine there is 0 at
//! the terminator, and no more light leaves than has entered. Where normal and colour of the entry are known (section
//! 16.3.1), the cosine there counts, and light fades in behind the terminator.

pub mod settings;
pub mod way;

use super::{Exitance, Inside};
use crate::RenderError;
use crate::lit_scene::Lit;
use crate::passes::irradiance::{from_environment, shading_normal};
use crate::passes::resolve::Place;
use crate::passes::visibility::{faces, scaled_mm};
use crate::prepare::kernel::kernel_of;
use crate::sampling::{disc, r2_point, random2};
use cutis_scene::{LightSample, Object};
use glam::{Vec2, Vec3, Vec4};
pub use settings::{DepthAbsorptionSettings, EntryPoint, FallOff};
use way::{Way, Ways};

/// Streams of random numbers: one per light from here on.
pub const STREAM: u32 = 0x300;
/// Cosine of the light on the far side up to which light whose entry is known fades in: growth and filter take it from
/// places that lie a little off the terminator.
pub const FADE_COS: f32 = 0.2;
/// Distance that the layer of distances shows where no way leads to the light, mm.
pub const NO_WAY_MM: f32 = 1e6;

/// Light that is absorbed on its straight way through the bodies of a scene.
pub struct Absorbed<'a> {
    lit: Lit<'a>,
    ways: Ways<'a>,
    /// Of every object, in order.
    sigma_t_per_mm: Vec<Vec3>,
}

impl<'a> Absorbed<'a> {
    /// Prepares the grown bodies, and the numbers of every object.
    ///
    /// # Errors
    /// If a material has no kernel.
    pub fn new(lit: Lit<'a>) -> Result<Self, RenderError> {
        let settings = &lit.settings.techniques.depth_absorption;
        let sigma_t = |object| sigma_t_per_mm(settings, object, lit.settings.gaussians);
        let sigma_t_per_mm = lit.scene.objects.iter().map(sigma_t).collect::<Result<_, RenderError>>()?;
        Ok(Self { lit, ways: Ways::new(lit.scene, lit.bvh, settings), sigma_t_per_mm })
    }

    fn settings(&self) -> &'a DepthAbsorptionSettings {
        &self.lit.settings.techniques.depth_absorption
    }

    /// Light that has entered close by, W/m².
    fn faced(&self, place: &Place, l: usize, towards: &LightSample) -> Vec3 {
        let shine = place.shine();
        let cos = place.normal.dot(towards.dir_to_light).max(0.0);
        let entered = cos * place.visible(l) * place.maps.rho_dt.at(cos, shine.roughness, shine.rho_s);
        towards.irradiance_w_per_m2 * entered * place.object.material.film_inwards(place.point.map_uv)
    }

    /// Light that comes through to a place that faces away, W/m²: the mean over the ways to places around it.
    fn through(&self, place: &Place, l: usize, towards: &LightSample) -> Vec3 {
        let (mut sum, mut count) = (Vec3::ZERO, 0);
        for way in self.around(place, l, towards) {
            sum += self.entered(place, &way, towards) * self.left(place, &way);
            count += 1;
        }
        let leaves = -place.point.normal.dot(towards.dir_to_light);
        let fade = if self.settings().entry == EntryPoint::Surface { fade(leaves) } else { 1.0 };
        towards.irradiance_w_per_m2 * sum * (fade / count.max(1) as f32)
    }

    /// Ways to places on a disc around one, across the light's direction.
    fn around(&self, place: &Place, l: usize, towards: &LightSample) -> impl Iterator<Item = Way> {
        let DepthAbsorptionSettings { samples, filter_radius_mm, .. } = *self.settings();
        let (light, middle_mm) = (&self.lit.scene.lights[l], place.point.position_mm);
        let (right, up) = towards.dir_to_light.any_orthonormal_pair();
        let [x, y] = place.sample;
        let shift = random2(x, y, STREAM + l as u32, self.lit.settings.seed);
        let samples = if filter_radius_mm > 0.0 { samples } else { 1 };
        (0..samples).filter_map(move |i| {
            let aside = if samples > 1 { disc(r2_point(i, shift)) * filter_radius_mm } else { Vec2::ZERO };
            self.ways.to(light, middle_mm + right * aside.x + up * aside.y)
        })
    }

    /// Share of a light's irradiance that has entered.
    fn entered(&self, place: &Place, way: &Way, towards: &LightSample) -> Vec3 {
        let of = |object: usize, uv, cos: f32, cos_entered: f32| {
            let material = &self.lit.scene.objects[object].material;
            let (roughness, rho_s) = (material.roughness.at(uv), material.rho_s.at(uv));
            let rho_dt = self.lit.maps[object].rho_dt.at(cos_entered, roughness, rho_s);
            material.film_inwards(uv) * (cos * rho_dt)
        };
        match self.settings().entry {
            EntryPoint::Distance => {
                let cos = -place.normal.dot(towards.dir_to_light);
                of(place.object_number, place.point.map_uv, cos.max(0.0), 1.0)
            }
            EntryPoint::Surface => {
                let normal = shading_normal(&self.lit.scene.objects[way.object], &way.entry);
                let cos = normal.dot(towards.dir_to_light).max(0.0);
                of(way.object, way.entry.map_uv, cos, cos)
            }
        }
    }

    /// Share of the light that the way through the bodies leaves.
    fn left(&self, place: &Place, way: &Way) -> Vec3 {
        let s_mm = scaled_mm(way.inside_mm, place.object.material.thickness_scale);
        match &self.settings().fall_off {
            FallOff::Ramp(ramp) => ramp.at_mm(s_mm),
            FallOff::Material | FallOff::Exponential(_) => {
                (-self.sigma_t_per_mm[place.object_number] * s_mm).exp()
            }
        }
    }
}

/// Extinction of an object's light, 1/mm; 0 where a ramp stands in for it.
///
/// # Errors
/// If its material has no kernel.
pub fn sigma_t_per_mm(
    settings: &DepthAbsorptionSettings,
    object: &Object,
    gaussians: usize,
) -> Result<Vec3, RenderError> {
    Ok(match settings.fall_off {
        FallOff::Ramp(_) => Vec3::ZERO,
        FallOff::Exponential(sigma_t) => sigma_t,
        // What spreads no light lets none through; infinity would make a number of no distance at all.
        FallOff::Material => {
            kernel_of(&object.material, gaussians)?.deviation_mm().recip().min(Vec3::splat(f32::MAX))
        }
    })
}

/// 0 at the terminator, 1 well behind it.
fn fade(cos: f32) -> f32 {
    let t = (cos / FADE_COS).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

impl Inside for Absorbed<'_> {
    fn exitance(&self, place: &Place) -> Exitance {
        let Place { maps, point, .. } = *place;
        let shine = place.shine();
        let around = from_environment(self.lit.environment, &maps.ambient, &point, place.normal, place.chart)
            * maps.rho_dt.mean(shine.roughness, shine.rho_s);
        let mut sum = Exitance {
            local: around * place.object.material.film_inwards(point.map_uv),
            ..Exitance::default()
        };
        for (l, light) in self.lit.scene.lights.iter().enumerate() {
            let towards = light.sample(point.position_mm);
            if faces(&point, light) {
                sum.local += self.faced(place, l, &towards);
            } else {
                sum.transmitted += self.through(place, l, &towards);
            }
        }
        let total = maps.kernel.total();
        Exitance { local: sum.local * total, transmitted: sum.transmitted * total }
    }

    fn distances_mm(&self, place: &Place) -> Option<Vec4> {
        let mut distances_mm = Vec4::ZERO;
        for (l, light) in self.lit.scene.lights.iter().enumerate().take(4) {
            if !faces(&place.point, light) {
                let way = self.ways.to(light, place.point.position_mm);
                let scale = place.object.material.thickness_scale;
                distances_mm[l] = way.map_or(NO_WAY_MM, |way| scaled_mm(way.inside_mm, scale));
            }
        }
        Some(distances_mm)
    }
}
