//! What lights see of the irradiance, and the profiles that samples follow: what the technique `image-space` keeps of a scene.

use super::SceneError;
use super::object::ObjectMaps;
use super::shared::Shared;
use crate::Gpu;
use crate::map::Map;
use crate::passes::Passes;
use crate::passes::irradiance_image::{IrradianceImages, depth_buffer};
use crate::passes::sample_profile::Profiles;
use crate::passes::shadow::Drawn;
use crate::step::Step;
use bytemuck::Zeroable;
use cutis_render::Settings;
use cutis_render::technique::image_space::{LIGHT_VIEW_TEXELS, MAX_LIGHT_VIEWS};
use cutis_scene::Scene;

/// Images of the lights, and all profiles.
#[derive(Debug)]
pub struct Images {
    /// What the lights see, one layer each.
    pub of_lights: IrradianceImages,
    /// Profiles of all objects.
    pub profiles: Profiles,
    lights: Vec<u32>,
    depth: Map,
    smooth_plane: bool,
}

impl Images {
    /// Empty images for those of the first lights that have a map.
    ///
    /// # Errors
    /// If a material has no profile that can be sampled.
    pub fn new(gpu: &Gpu, shared: &Shared, scene: &Scene, settings: &Settings) -> Result<Self, SceneError> {
        let lights = (0..).zip(&shared.layers).take(MAX_LIGHT_VIEWS).filter(|(_, layer)| layer.is_some());
        let wanted = settings.techniques.image_space.light_views;
        let lights: Vec<u32> = lights.map(|(light, _)| light).filter(|_| wanted).collect();
        let side = LIGHT_VIEW_TEXELS as u32;
        Ok(Self {
            of_lights: IrradianceImages::new(gpu, [side, side], lights.len() as u32),
            profiles: Profiles::new(gpu, scene, settings, &lights)?,
            depth: depth_buffer(gpu, side),
            smooth_plane: !settings.techniques.image_space.jacobian,
            lights,
        })
    }

    /// How an image shows an object.
    pub fn drawn(&self, object: u32) -> Drawn {
        Drawn { object, smooth_plane: u32::from(self.smooth_plane), ..Drawn::zeroed() }
    }

    /// Draws what the lights see, in every frame after the light has entered.
    pub fn steps(&self, gpu: &Gpu, passes: &Passes, shared: &Shared, objects: &[ObjectMaps]) -> Vec<Step> {
        let mut steps = Vec::new();
        for (layer, &light) in (0..).zip(&self.lights) {
            for (object, maps) in (0..).zip(objects) {
                let drawn = Drawn { light, ..self.drawn(object) };
                let inputs = maps.resolve_inputs(passes, shared, None);
                let into = (layer, &self.depth);
                steps.push(passes.irradiance_image.light_step(gpu, &inputs, drawn, &self.of_lights, into));
            }
        }
        steps
    }
}
