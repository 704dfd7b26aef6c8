//! Each light's share of the irradiance, where there are several: light that comes through is counted once for every light.

use crate::Gpu;
use crate::map::View;
use crate::passes::irradiance::IrradianceInputs;
use crate::passes::{SLIDES, over_charts};
use crate::pipeline::{Blueprint, Bound, Pipeline};
use crate::shaders;
use crate::step::Step;
use bytemuck::{Pod, Zeroable};
use wgpu::TextureFormat as Format;

/// Some lights; the twin of `Group` in the shader.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct ShareGroup {
    /// Number of the first of four lights.
    pub first_light: u32,
    /// Fills up the struct.
    pub pad0: u32,
    /// Fills up the struct.
    pub pad1: u32,
    /// Fills up the struct.
    pub pad2: u32,
}

/// The pass's pipeline.
#[derive(Debug)]
pub struct SharesPass {
    pipeline: Pipeline,
}

impl SharesPass {
    /// Compiles it.
    pub fn new(gpu: &Gpu) -> Self {
        let blueprint = Blueprint {
            name: "shares",
            source: shaders::SHARES,
            entries: ["cover_run", "share_lights"],
            targets: &[Format::Rgba16Float],
            additive: false,
            depth: false,
        };
        Self { pipeline: Pipeline::new(gpu, &blueprint) }
    }

    /// Fills the shares of four lights.
    pub fn step(&self, gpu: &Gpu, group: ShareGroup, inputs: &IrradianceInputs, target: &View) -> Step {
        let numbers = gpu.uniform("group of lights", &group);
        let bound = [
            (1, Bound::Buffer(inputs.lights)),
            (2, Bound::Buffer(&numbers)),
            (3, Bound::Buffer(&inputs.material.numbers)),
            (4, Bound::Texture(inputs.atlas.places.view())),
            (5, Bound::Texture(inputs.atlas.reliefs.view())),
            (6, Bound::Texture(&inputs.visibility.array)),
            (7, Bound::Texture(inputs.rho_dt.view())),
            (8, Bound::Texture(inputs.material.rho_s.view())),
            (9, Bound::Texture(inputs.material.roughness.view())),
            (10, Bound::Sampler(&inputs.samplers.linear)),
            (11, Bound::Sampler(&inputs.samplers.repeating)),
            (12, Bound::Texture(inputs.atlas.coordinates.view())),
            (SLIDES, Bound::Buffer(inputs.slides)),
        ];
        over_charts(gpu, &self.pipeline, inputs.charts, &bound, &[target], false)
    }
}
