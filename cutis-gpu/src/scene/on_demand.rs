//! Maps that no frame needs: they are made when a layer is asked for.

use super::GpuScene;
use super::object::ObjectMaps;
use crate::map::Map;
use crate::passes::visibility::{COUNTS, Group};
use crate::passes::{LIGHTS_TOGETHER, Passes};
use crate::readback::read_layer;
use crate::{Gpu, GpuError};
use bytemuck::Zeroable;
use glam::{Vec2, Vec4};

impl GpuScene {
    /// Where an object's charts meet, and how far the light of the frame drawn last is apart there.
    ///
    /// # Errors
    /// If the device is lost.
    pub(super) fn seams(&self, gpu: &Gpu, maps: &ObjectMaps) -> Result<Vec<Vec4>, GpuError> {
        let local = read_layer(gpu, &maps.local, 0)?;
        let charts = &maps.seams.charts;
        let light = |uv: Vec2, chart| charts.sample(&local, uv, chart).unwrap_or_default().truncate();
        Ok(maps.seams.map(light))
    }

    /// The same on the device.
    ///
    /// # Errors
    /// If the device is lost.
    pub(super) fn seams_as_a_map(&self, gpu: &Gpu, maps: &ObjectMaps) -> Result<Map, GpuError> {
        let size = maps.seams.charts.size as u32;
        Ok(Map::of_values(gpu, "seams", [size, size], self.seams(gpu, maps)?.into_iter()))
    }

    /// How many places of all lights are tried for each texel of object number `number`.
    pub(super) fn shadow_samples(&self, gpu: &Gpu, passes: &Passes, number: u32) -> Map {
        let (maps, shared) = (&self.objects[number as usize], &self.shared);
        let charts = &maps.stretch_level().charts;
        let counts = Map::square(gpu, "places of lights", charts.size, 1, COUNTS);
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        for first in (0..shared.light_count).step_by(LIGHTS_TOGETHER) {
            let group = Group {
                first_light: first as u32,
                light_count: (shared.light_count - first).min(LIGHTS_TOGETHER) as u32,
                object: number,
                samples: shared.shadow_samples,
                ..Group::zeroed()
            };
            let lights = (&shared.lights, &shared.shadows);
            let step = passes.visibility.count_step(gpu, group, lights, &maps.atlas, charts, &counts);
            step.encode(&mut encoder, None);
        }
        gpu.queue.submit([encoder.finish()]);
        counts
    }
}
