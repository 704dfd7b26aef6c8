//! Irradiance under the surface, in texture space. The twin of cutis-render's `irradiance`.

use crate::Gpu;
use crate::map::{Map, View};
use crate::passes::atlas::AtlasMaps;
use crate::passes::{SLIDES, Samplers, over_charts};
use crate::pipeline::{Blueprint, Bound, Pipeline};
use crate::scene::charts::ChartTexture;
use crate::scene::environment::EnvironmentMaps;
use crate::scene::material::MaterialMaps;
use crate::shaders;
use crate::step::Step;
use wgpu::TextureFormat as Format;

/// Everything the pass reads.
#[derive(Debug, Clone, Copy)]
pub struct IrradianceInputs<'a> {
    /// How textures are read.
    pub samplers: &'a Samplers,
    /// All lights.
    pub lights: &'a wgpu::Buffer,
    /// What projectors among them throw.
    pub slides: &'a wgpu::Buffer,
    /// What the surface is made of.
    pub material: &'a MaterialMaps,
    /// The filtered environment.
    pub environment: &'a EnvironmentMaps,
    /// The unrolled surface.
    pub atlas: &'a AtlasMaps,
    /// Its charts.
    pub charts: &'a ChartTexture,
    /// Fraction of each light that is seen.
    pub visibility: &'a Map,
    /// Distances through the body in the first channel, for a single light.
    pub distances_mm: &'a Map,
    /// Openness, and the charts of its smaller map.
    pub ambient: (&'a Map, &'a ChartTexture),
    /// Table of what the surface lets through.
    pub rho_dt: &'a Map,
}

/// The pass's pipeline.
#[derive(Debug)]
pub struct IrradiancePass {
    pipeline: Pipeline,
}

impl IrradiancePass {
    /// Compiles it.
    pub fn new(gpu: &Gpu) -> Self {
        let blueprint = Blueprint {
            name: "irradiance",
            source: shaders::IRRADIANCE,
            entries: ["cover_run", "light_texel"],
            targets: &[Format::Rgba16Float],
            additive: false,
            depth: false,
        };
        Self { pipeline: Pipeline::new(gpu, &blueprint) }
    }

    /// Fills the texture.
    pub fn step(&self, gpu: &Gpu, inputs: &IrradianceInputs, target: &View) -> Step {
        let IrradianceInputs { samplers, material, environment, atlas, .. } = inputs;
        let bound = [
            (1, Bound::Buffer(inputs.lights)),
            (2, Bound::Buffer(&material.numbers)),
            (3, Bound::Buffer(&environment.numbers)),
            (4, Bound::Texture(atlas.places.view())),
            (5, Bound::Texture(atlas.reliefs.view())),
            (6, Bound::Texture(inputs.charts.map.view())),
            (7, Bound::Texture(&inputs.visibility.array)),
            (8, Bound::Texture(&inputs.distances_mm.array)),
            (9, Bound::Texture(inputs.ambient.0.view())),
            (10, Bound::Texture(inputs.ambient.1.map.view())),
            (11, Bound::Texture(environment.irradiance.view())),
            (12, Bound::Texture(inputs.rho_dt.view())),
            (13, Bound::Texture(material.albedo.view())),
            (14, Bound::Texture(material.rho_s.view())),
            (15, Bound::Texture(material.roughness.view())),
            (16, Bound::Sampler(&samplers.linear)),
            (17, Bound::Sampler(&samplers.repeating)),
            (18, Bound::Sampler(&samplers.around_sky)),
            (19, Bound::Texture(atlas.coordinates.view())),
            (SLIDES, Bound::Buffer(inputs.slides)),
        ];
        over_charts(gpu, &self.pipeline, inputs.charts, &bound, &[target], false)
    }
}
