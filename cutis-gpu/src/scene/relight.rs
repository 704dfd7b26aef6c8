//! Other numbers for the same lights: no map, binding or step of the scene is made anew.

use super::GpuScene;
use super::lights::{GpuLight, NO_MAP};
use super::shared::gpu_lights;
use crate::Gpu;
use cutis_scene::Scene;
use std::sync::atomic::Ordering;

impl GpuScene {
    /// Lights the scene anew from the next frame on. `scene` is the one this was made from, in the pose it had then, with
    /// other lights; and with its environment turned or of another strength, but of the same map.
    ///
    /// Tells whether it could be done. Nothing has changed where not: lights of another number or kind, a projector with
    /// another image, one that gets or loses its shadow map, the first or last one with an extent, and an environment that comes, goes or is hidden take a
    /// scene of their own.
    pub fn set_lights(&mut self, gpu: &Gpu, scene: &Scene) -> bool {
        let lights = gpu_lights(scene, self.shared.growth_mm());
        if !self.posing.is_lit_like(&lights)
            || any_extent(&lights) != self.shared.any_extent
            || !self.shared.slides.serve(scene)
            || !self.shared.environment.serves(scene.environment.as_ref())
        {
            return false;
        }
        if !self.posing.set_lights(gpu, &self.shared, scene, lights) {
            return false;
        }
        if let Some(environment) = &scene.environment {
            self.shared.environment.set(gpu, environment);
        }
        self.lit.store(false, Ordering::Relaxed);
        true
    }
}

/// Whether any light has an extent.
pub fn any_extent(lights: &[GpuLight]) -> bool {
    lights.iter().any(|light| light.extent > 0.0)
}

/// Layer of the maps of each light, if it has one.
pub fn layers(lights: &[GpuLight]) -> Vec<Option<u32>> {
    lights.iter().map(|l| (l.map_layer != NO_MAP).then_some(l.map_layer)).collect()
}

/// Whether lights are drawn by the same steps as others.
pub fn are_alike(lights: &[GpuLight], others: &[GpuLight]) -> bool {
    let kinds = |lights: &[GpuLight]| lights.iter().map(|light| light.kind).collect::<Vec<_>>();
    kinds(lights) == kinds(others) && layers(lights) == layers(others)
}
