//! Light that comes through thin parts into the light map. The twin of cutis-render's `thin_parts`.

use crate::Gpu;
use crate::map::{Map, View};
use crate::passes::atlas::AtlasMaps;
use crate::passes::over_charts;
use crate::passes::shadow::ShadowMaps;
use crate::pipeline::{Blueprint, Bound, Pipeline};
use crate::scene::charts::ChartPyramid;
use crate::shaders;
use crate::step::Step;
use bytemuck::{Pod, Zeroable};
use wgpu::TextureFormat as Format;

/// A body; its twin has the same name.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Body {
    /// How far the material spreads light, mm.
    pub deviation_mm: [f32; 3],
    /// Factor on distances through the body.
    pub thickness_scale: f32,
    /// Number of the object.
    pub object: u32,
    /// 1 if every light has a share of its own.
    pub many_lights: u32,
    /// Fills up the struct.
    pub pad0: u32,
    /// Fills up the struct.
    pub pad1: u32,
}

/// Everything the pass reads.
#[derive(Debug, Clone, Copy)]
pub struct ThinPartsInputs<'a> {
    /// All lights.
    pub lights: &'a wgpu::Buffer,
    /// The object's unrolled surface.
    pub atlas: &'a AtlasMaps,
    /// Its charts.
    pub charts: &'a ChartPyramid,
    /// What the lights see.
    pub shadows: &'a ShadowMaps,
    /// Share of each light; none with a single one.
    pub shares: Option<&'a Map>,
    /// The light map.
    pub light: &'a Map,
}

/// The pass's pipeline.
#[derive(Debug)]
pub struct ThinPartsPass {
    pipeline: Pipeline,
}

impl ThinPartsPass {
    /// Compiles it.
    pub fn new(gpu: &Gpu) -> Self {
        let blueprint = Blueprint {
            name: "transmission",
            source: shaders::THIN_PARTS,
            entries: ["cover_run", "come_through"],
            targets: &[Format::Rgba16Float],
            additive: false,
            depth: false,
        };
        Self { pipeline: Pipeline::new(gpu, &blueprint) }
    }

    /// Fills a map of half the size; all of `body` counts but `many_lights`, which follows.
    pub fn step(&self, gpu: &Gpu, body: Body, inputs: &ThinPartsInputs, target: &View) -> Step {
        let body = Body { many_lights: u32::from(inputs.shares.is_some()), ..body };
        let numbers = gpu.uniform("body", &body);
        // A single light's share is not read; something has to be bound.
        let shares = inputs.shares.map_or(&inputs.light.array, |shares| &shares.array);
        let bound = [
            (1, Bound::Buffer(&numbers)),
            (2, Bound::Buffer(inputs.lights)),
            (3, Bound::Texture(&inputs.charts.all)),
            (4, Bound::Texture(&inputs.light.layers[0])),
            (5, Bound::Texture(inputs.atlas.places.view())),
            (6, Bound::Texture(&inputs.shadows.depths.array)),
            (7, Bound::Texture(&inputs.shadows.surfaces.array)),
            (8, Bound::Texture(shares)),
        ];
        over_charts(gpu, &self.pipeline, &inputs.charts.sizes[1], &bound, &[target], false)
    }
}
