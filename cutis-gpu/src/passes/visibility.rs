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

/// What counts are kept as: numbers up to 2048 are exact, and can be added up.
pub const COUNTS: Format = Format::Rgba16Float;

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
    count: Pipeline,
}

impl VisibilityPass {
    /// Compiles it.
    pub fn new(gpu: &Gpu) -> Self {
        let pipeline = |entry, targets: &[Format], additive| {
            let entries = ["cover_run", entry];
            let (name, source) = ("shadows", shaders::VISIBILITY);
            Pipeline::new(gpu, &Blueprint { name, source, entries, targets, additive, depth: false })
        };
        let seen = [Format::Rgba8Unorm, Format::Rgba16Float];
        Self {
            soft: pipeline("see_lights", &seen, false),
            sharp: pipeline("see_sharp_lights", &seen, false),
            count: pipeline("count_places", &[COUNTS], true),
        }
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
        let pipeline = if any_extent { &self.soft } else { &self.sharp };
        over_charts(gpu, pipeline, charts, &bound(&numbers, lights, shadows, atlas, charts), &targets, false)
    }

    /// Adds up how many places of up to four lights are tried.
    pub fn count_step(
        &self,
        gpu: &Gpu,
        group: Group,
        (lights, shadows): (&wgpu::Buffer, &ShadowMaps),
        atlas: &AtlasMaps,
        charts: &ChartTexture,
        counts: &Map,
    ) -> Step {
        let numbers = gpu.uniform("group of lights", &group);
        let bound = bound(&numbers, lights, shadows, atlas, charts);
        over_charts(gpu, &self.count, charts, &bound, &[counts.view()], group.first_light == 0)
    }
}

fn bound<'a>(
    numbers: &'a wgpu::Buffer,
    lights: &'a wgpu::Buffer,
    shadows: &'a ShadowMaps,
    atlas: &'a AtlasMaps,
    charts: &'a ChartTexture,
) -> [(u32, Bound<'a>); 7] {
    [
        (1, Bound::Buffer(lights)),
        (2, Bound::Buffer(numbers)),
        (3, Bound::Texture(atlas.places.view())),
        (4, Bound::Texture(atlas.stretch.view())),
        (5, Bound::Texture(&shadows.depths.array)),
        (6, Bound::Texture(&shadows.surfaces.array)),
        (7, Bound::Texture(charts.map.view())),
    ]
}

/// Fractions of the lights that are seen, four to a layer.
pub fn visibility_map(gpu: &Gpu, size: u32, lights: usize) -> Map {
    let layers = lights.div_ceil(super::LIGHTS_TOGETHER).max(1) as u32;
    Map::square(gpu, "visibility", size, layers, Format::Rgba8Unorm)
}
