//! Absorption over the distance that light travels through the body, as a depth map tells it (Green 2004, GPU Gems,
//! chapter 16, section 16.3).
//!
//! Symbols: d_i and d_o distances of the light from where it enters and where it leaves, s = d_o - d_i; what comes through is
//! e^(-s sigma_t) of what entered. The processor casts rays where the paper reads maps.

use super::{Exitance, Inside};
use crate::RenderError;
use crate::lit_scene::Lit;
use crate::passes::irradiance::from_environment;
use crate::passes::resolve::Place;
use crate::passes::visibility::{faces, light_facing_surface};
use crate::prepare::ColourRamp;
use crate::prepare::kernel::kernel_of;
use crate::settings::within;
use glam::Vec3;
use std::fmt;
use std::sync::Arc;

/// Numbers of the technique `depth-absorption`.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthAbsorptionSettings {
    /// What a distance through the body leaves of the light.
    pub fall_off: FallOff,
    /// How far the body is grown along its normals in the depth map, mm, 0 to 1000: against the background at its edges.
    pub growth_mm: f32,
    /// What is known of the place where light enters.
    pub entry: EntryPoint,
    /// Places on the light's side that are looked at for a point, 1 to 64: features of the back show through less.
    pub samples: u32,
    /// Radius of the disc that these are spread over, mm, 0 to 1000.
    pub filter_radius_mm: f32,
    /// Surfaces along the light's way that are told apart, 1 to 16; 1 takes all behind the nearest surface for flesh, as in
    /// the paper.
    pub layers: u32,
}

/// What a distance through the body leaves of the light.
#[derive(Debug, Clone, PartialEq)]
pub enum FallOff {
    /// e^(-s sigma_t), sigma_t one over the distance that the material spreads light by.
    Material,
    /// The same with an extinction for each channel, 1/mm.
    Exponential(Vec3),
    /// A colour for each distance.
    Ramp(Arc<ColourRamp>),
}

/// What is known of the place where light enters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EntryPoint {
    /// How far it is (listing 16-4): light enters as if it were faced.
    Distance,
    /// Its normal and its colour, too (section 16.3.1).
    Surface,
}

impl EntryPoint {
    /// All of them.
    pub const ALL: [EntryPoint; 2] = [EntryPoint::Distance, EntryPoint::Surface];
}

impl fmt::Display for EntryPoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            EntryPoint::Distance => "distance",
            EntryPoint::Surface => "surface",
        })
    }
}

impl Default for DepthAbsorptionSettings {
    fn default() -> Self {
        Self {
            fall_off: FallOff::Material,
            growth_mm: 0.5,
            entry: EntryPoint::Surface,
            samples: 8,
            filter_radius_mm: 1.0,
            layers: 1,
        }
    }
}

impl DepthAbsorptionSettings {
    /// Checks every number against its range.
    ///
    /// # Errors
    /// Names the first that is out of its range.
    pub fn check(&self) -> Result<(), RenderError> {
        if let FallOff::Exponential(sigma_t) = self.fall_off {
            let bad = |s: &f32| !(*s >= 0.0 && s.is_finite());
            let worst = sigma_t.to_array().into_iter().find(bad).unwrap_or(0.0);
            within("sigma_t", worst, "not negative and finite, in 1/mm", !bad(&worst))?;
        }
        let lengths_mm = [("growth", self.growth_mm), ("radius of the filter", self.filter_radius_mm)];
        for (name, length_mm) in lengths_mm {
            within(name, length_mm, "0 to 1000 mm", (0.0..=1000.0).contains(&length_mm))?;
        }
        within("samples of the depth map", self.samples as f32, "1 to 64", (1..=64).contains(&self.samples))?;
        within("layers of the depth map", self.layers as f32, "1 to 16", (1..=16).contains(&self.layers))
    }
}

/// Light that is absorbed on its straight way through the bodies of a scene.
pub struct Absorbed<'a> {
    lit: Lit<'a>,
    /// Of every object, in order.
    sigma_t_per_mm: Vec<Vec3>,
}

impl<'a> Absorbed<'a> {
    /// Prepares the numbers of every object.
    ///
    /// # Errors
    /// If a material has no kernel.
    pub fn new(lit: Lit<'a>) -> Result<Self, RenderError> {
        let given = &lit.settings.techniques.depth_absorption.fall_off;
        let sigma_t = |object: &cutis_scene::Object| match given {
            FallOff::Exponential(sigma_t) => Ok(*sigma_t),
            _ => Ok(kernel_of(&object.material, lit.settings.gaussians)?.deviation_mm().recip()),
        };
        let sigma_t_per_mm = lit.scene.objects.iter().map(sigma_t).collect::<Result<_, RenderError>>()?;
        Ok(Self { lit, sigma_t_per_mm })
    }

    fn from_light(&self, place: &Place, l: usize) -> Exitance {
        let (point, light) = (&place.point, &self.lit.scene.lights[l]);
        let shine = place.shine();
        let towards = light.sample(point.position_mm);
        if faces(point, light) {
            let cos = place.normal.dot(towards.dir_to_light).max(0.0);
            let entered = cos * place.visible(l) * place.maps.rho_dt.at(cos, shine.roughness, shine.rho_s);
            return Exitance { local: towards.irradiance_w_per_m2 * entered, transmitted: Vec3::ZERO };
        }
        let Some(there) = light_facing_surface(self.lit.scene, self.lit.bvh, point, light) else {
            return Exitance::default();
        };
        let absorbed = (-self.sigma_t_per_mm[place.object_number] * there.distance_mm).exp();
        let cos = there.normal.dot(towards.dir_to_light).max(0.0);
        let maps = &self.lit.maps[there.object];
        let visible = maps.atlas.charts.sample(&maps.visibility[l], there.uv, there.chart).unwrap_or(0.0);
        let entered =
            towards.irradiance_w_per_m2 * (cos * visible * maps.rho_dt.at(cos, shine.roughness, shine.rho_s));
        Exitance { local: Vec3::ZERO, transmitted: entered * absorbed }
    }
}

impl Inside for Absorbed<'_> {
    fn exitance(&self, place: &Place) -> Exitance {
        let Place { maps, point, .. } = *place;
        let shine = place.shine();
        let around = from_environment(self.lit.environment, &maps.ambient, &point, place.normal, place.chart);
        let mut sum = Exitance {
            local: around * maps.rho_dt.mean(shine.roughness, shine.rho_s),
            ..Exitance::default()
        };
        for l in 0..self.lit.scene.lights.len() {
            let Exitance { local, transmitted } = self.from_light(place, l);
            sum.local += local;
            sum.transmitted += transmitted;
        }
        let colour = place.object.material.film_inwards(point.uv) * maps.kernel.total();
        Exitance { local: sum.local * colour, transmitted: sum.transmitted * colour }
    }
}
