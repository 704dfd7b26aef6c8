//! The scene as each light sees it: shadow map and translucent shadow map in one
//! (d'Eon, Luebke & Enderton 2007, section 5.2).

use crate::Gpu;
use crate::map::Map;
use crate::pipeline::{Blueprint, Bound, DEPTH, Pipeline};
use crate::scene::geometry::Geometry;
use crate::shaders;
use crate::step::{Draw, Step};
use bytemuck::{Pod, Zeroable};
use wgpu::TextureFormat as Format;

/// Depth where nothing is, mm.
const NOTHING_MM: f64 = 1e30;

/// Which light sees which object; the twin of `Drawn`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Drawn {
    /// Number of the light.
    pub light: u32,
    /// Number of the object.
    pub object: u32,
    /// For images of the irradiance: 1 if they hold normals of the smooth surface.
    pub smooth_plane: u32,
    /// Fills up the struct.
    pub pad0: u32,
}

/// Maps of all lights that have one, one layer each.
#[derive(Debug)]
pub struct ShadowMaps {
    /// Depth away from the light, mm.
    pub depths: Map,
    /// Place in the atlas, chart and object of the surface that faces the light.
    pub surfaces: Map,
    depth_buffer: Map,
}

impl ShadowMaps {
    /// Of `size` texels for so many lights.
    pub fn new(gpu: &Gpu, size: u32, lights: u32) -> Self {
        Self {
            depths: Map::square(gpu, "shadow depths", size, lights.max(1), Format::R32Float),
            surfaces: Map::square(gpu, "translucent shadows", size, lights.max(1), Format::Rg32Uint),
            depth_buffer: Map::square(gpu, "shadow depth buffer", size, 1, DEPTH),
        }
    }
}

/// The pass's pipeline.
#[derive(Debug)]
pub struct ShadowPass {
    pipeline: Pipeline,
}

impl ShadowPass {
    /// Compiles it.
    pub fn new(gpu: &Gpu) -> Self {
        let blueprint = Blueprint {
            name: "shadow map",
            source: shaders::SHADOW,
            entries: ["see_from_light", "map_surface"],
            targets: &[Format::R32Float, Format::Rg32Uint],
            additive: false,
            depth: true,
        };
        Self { pipeline: Pipeline::new(gpu, &blueprint) }
    }

    /// Draws one object into the maps of a light; the first object empties them before.
    pub fn step(
        &self,
        gpu: &Gpu,
        drawn: Drawn,
        lights: &wgpu::Buffer,
        geometry: &Geometry,
        maps: &ShadowMaps,
        layer: u32,
    ) -> Step {
        let numbers = gpu.uniform("drawn", &drawn);
        let bound = [
            (0, Bound::Buffer(&geometry.vertices)),
            (1, Bound::Buffer(&geometry.triangles)),
            (2, Bound::Buffer(lights)),
            (3, Bound::Buffer(&numbers)),
        ];
        let first = drawn.object == 0;
        Step::Draw(Draw {
            pipeline: self.pipeline.clone(),
            bind_groups: vec![self.pipeline.bind(gpu, 0, &bound)],
            targets: vec![
                maps.depths.layers[layer as usize].clone(),
                maps.surfaces.layers[layer as usize].clone(),
            ],
            depth: Some((maps.depth_buffer.view().clone(), first)),
            clear: first.then_some(wgpu::Color { r: NOTHING_MM, g: 0.0, b: 0.0, a: 0.0 }),
            indices: None,
            vertices: 3 * geometry.triangle_count,
            instances: 1,
        })
    }
}
