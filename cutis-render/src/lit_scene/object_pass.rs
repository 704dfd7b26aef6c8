//! From lights to irradiance: the passes that fill one object's textures, but for those that spread its light.

use super::clock::Clock;
use super::kernel::{chosen_kernel, opaque_mm};
use super::wanted;
use crate::passes::ambient::Ambient;
use crate::passes::atlas::Atlas;
use crate::passes::diffusion::{Diffused, Level};
use crate::passes::half_size::{HalfSize, Rays};
use crate::passes::irradiance::{IrradianceInputs, irradiance};
use crate::passes::object_maps::ObjectMaps;
use crate::passes::stretch::stretch_mm_per_texel;
use crate::prepare::{FilteredEnvironment, RhoDt};
use crate::settings::Settings;
use crate::{Progress, RenderError};
use cutis_scene::{Bvh, Object, Scene};
use std::sync::Arc;

/// These passes.
pub(super) struct ObjectPass<'a> {
    pub scene: &'a Scene,
    pub settings: &'a Settings,
    pub bvh: &'a Bvh,
    pub environment: Option<&'a FilteredEnvironment>,
    pub object: &'a Object,
}

impl ObjectPass<'_> {
    /// Of the light under the surface there is only what has not been spread.
    pub fn run(
        &self,
        size: usize,
        clock: &mut Clock,
        progress: &dyn Progress,
    ) -> Result<ObjectMaps, RenderError> {
        let (object, settings) = (self.object, self.settings);
        let kernel = clock.time("kernel", || chosen_kernel(&object.material, settings))?;
        let rho_dt = clock.time("rho_dt", || RhoDt::new(object.material.f0));
        let atlas = clock.time("atlas", || Atlas::new(object, size));
        let stretch_mm = clock.time("stretch", || stretch_mm_per_texel(object, &atlas));
        let samples = if self.environment.is_some() { settings.ambient_samples } else { 0 };
        let half_charts = clock.time("atlas", || atlas.charts.halved());
        let ambient = clock.time("ambient occlusion", || {
            Ambient::new(object, &atlas, half_charts.halved(), self.bvh, samples, settings.seed, progress)
        });
        wanted(progress)?;
        let thickness_scale = object.material.thickness_scale;
        let opaque_mm = opaque_mm(&kernel);
        let rays = Rays { scene: self.scene, bvh: self.bvh, settings, opaque_mm, thickness_scale };
        let half_size = clock.time("shadows", || HalfSize::new(rays, object, &atlas, &half_charts, progress));
        wanted(progress)?;
        let inputs = IrradianceInputs {
            rays,
            object,
            atlas: &atlas,
            half_size: &half_size,
            ambient: &ambient,
            environment: self.environment,
            rho_dt: &rho_dt,
        };
        let lit = clock.time("irradiance", || irradiance(&inputs, progress));
        wanted(progress)?;
        let sharp = Level { charts: Arc::clone(&atlas.charts), layers: Arc::new(lit.layers) };
        let diffused = Diffused { levels: vec![sharp] };
        Ok(ObjectMaps {
            atlas,
            half_charts,
            stretch_mm,
            ambient,
            diffused,
            visibility: lit.visibility,
            shares: lit.shares,
            tried: lit.tried,
            kernel,
            rho_dt,
        })
    }
}
