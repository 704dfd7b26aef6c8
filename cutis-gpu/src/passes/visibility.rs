//! What every texel sees of the lights, and how far it is through the body towards each. Where cutis-render traces rays
//! (`visibility`, `half_size`), this reads the maps of the lights.

use crate::Gpu;
use crate::map::{Map, View};
use crate::passes::atlas::AtlasMaps;
use crate::passes::over_charts;
use crate::passes::shadow::ShadowMaps;
use crate::pipeline::{Blueprint, Bound, Pipeline};
use crate::scene::charts::ChartTexture;
use crate::shaders;
use crate::step::Step;
use bytemuck::{Pod, Zeroable};
use wgpu::TextureFormat as Format;

/// Some lights and what is asked about them; the twin of `Group`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Group {
    /// Number of the first light.
    pub first_light: u32,
    /// Up to four.
    pub light_count: u32,
    /// Number of the object.
    pub object: u32,
    /// Places on a light's disc that are tried.
    pub samples: u32,
    /// Distance beyond which nothing comes through, mm.
    pub opaque_mm: f32,
    /// Factor on distances through the body.
    pub thickness_scale: f32,
    /// Fills up the struct.
    pub pad0: u32,
    /// Fills up the struct.
    pub pad1: u32,
}

/// The pass's pipeline.
#[derive(Debug)]
pub struct VisibilityPass {
    soft: Pipeline,
    sharp: Pipeline,
}

impl VisibilityPass {
    /// Compiles it.
    pub fn new(gpu: &Gpu) -> Self {
        let pipeline = |entry| {
            let entries = ["cover_run", entry];
            let (name, source) = ("shadows", shaders::VISIBILITY);
            let targets = &[Format::Rgba8Unorm, Format::Rgba16Float];
            Pipeline::new(gpu, &Blueprint { name, source, entries, targets, additive: false, depth: false })
        };
        Self { soft: pipeline("see_lights"), sharp: pipeline("see_sharp_lights") }
    }

    /// Looks at up to four lights, of which `any_extent` says whether one has an extent; `targets` are the fractions seen and
    /// the distances.
    pub fn step(
        &self,
        gpu: &Gpu,
        (group, any_extent): (Group, bool),
        (lights, shadows): (&wgpu::Buffer, &ShadowMaps),
        atlas: &AtlasMaps,
        charts: &ChartTexture,
        targets: [&View; 2],
    ) -> Step {
        let numbers = gpu.uniform("group of lights", &group);
        let bound = [
            (1, Bound::Buffer(lights)),
            (2, Bound::Buffer(&numbers)),
            (3, Bound::Texture(atlas.places.view())),
            (4, Bound::Texture(atlas.stretch.view())),
            (5, Bound::Texture(&shadows.depths.array)),
            (6, Bound::Texture(&shadows.surfaces.array)),
            (7, Bound::Texture(charts.map.view())),
        ];
        let pipeline = if any_extent { &self.soft } else { &self.sharp };
        over_charts(gpu, pipeline, charts, &bound, &targets, false)
    }
}

/// Fractions of the lights that are seen, four to a layer.
pub fn visibility_map(gpu: &Gpu, size: u32, lights: usize) -> Map {
    let layers = lights.div_ceil(super::LIGHTS_TOGETHER).max(1) as u32;
    Map::square(gpu, "visibility", size, layers, Format::Rgba8Unorm)
}
