//! The depth map of the technique `depth-absorption`: bodies as each light sees them, layer by layer (Green 2004, GPU Gems,
//! section 16.3). What cutis-render finds by rays in `depth_absorption::way`.
//!
//! Normal and colour of the place where light enters are stored as what they make of the light together. Layers behind the
//! first are drawn as often as they are wanted, and leave out what is not behind the layer before (Everitt 2001, not opened).

use crate::Gpu;
use crate::map::Map;
use crate::passes::Samplers;
use crate::pipeline::{Blueprint, Bound, DEPTH, Pipeline};
use crate::scene::geometry::Geometry;
use crate::scene::material::MaterialMaps;
use crate::shaders;
use crate::step::{Draw, Step};
use bytemuck::{Pod, Zeroable};
use cutis_render::technique::depth_absorption::DepthAbsorptionSettings;
use cutis_scene::{Object, Scene};
use wgpu::TextureFormat as Format;

/// Distance where nothing is, mm.
pub const NOTHING_MM: f32 = 1e30;

/// What is drawn, and how far grown; the twin of `Grown`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Grown {
    /// Number of the light.
    pub light: u32,
    /// How far bodies are grown along their normals, mm.
    pub growth_mm: f32,
    /// Fills up the struct.
    pub pad0: u32,
    /// Fills up the struct.
    pub pad1: u32,
}

/// Depth maps of all lights that have one.
#[derive(Debug)]
pub struct DepthMaps {
    /// Distances of each light from the surfaces that it meets, mm; negative where it leaves a body. All layers of the first
    /// light, then those of the next.
    pub distances: Map,
    /// What enters at the first surface, as a share of the light's irradiance. One layer for each light.
    pub entered: Map,
    /// Surfaces that are told apart.
    pub layers: u32,
    /// How far bodies are grown, mm.
    pub growth_mm: f32,
    /// The layer before and the one that is drawn, in turn.
    depth_buffers: [Map; 2],
    /// For every object the vertices that lie at one place.
    alike: Vec<wgpu::Buffer>,
}

impl DepthMaps {
    /// Of `size` texels for so many lights.
    pub fn new(gpu: &Gpu, scene: &Scene, settings: &DepthAbsorptionSettings, size: u32, lights: u32) -> Self {
        let lights = lights.max(1);
        let layers = settings.layers;
        // A single layer has none before it.
        let sides = [size, if layers > 1 { size } else { 1 }];
        Self {
            distances: Map::square(gpu, "depth map", size, lights * layers, Format::R32Float),
            entered: Map::square(gpu, "entered", size, lights, Format::Rgba16Float),
            layers,
            growth_mm: settings.growth_mm,
            depth_buffers: sides.map(|side| Map::square(gpu, "depth map's depth", side, 1, DEPTH)),
            alike: scene.objects.iter().map(|object| gpu.storage("alike", &alike(object))).collect(),
        }
    }
}

/// What the pass reads of one object.
#[derive(Debug, Clone, Copy)]
pub struct DepthMapInputs<'a> {
    /// How textures are read.
    pub samplers: &'a Samplers,
    /// All lights.
    pub lights: &'a wgpu::Buffer,
    /// Its number.
    pub object: u32,
    /// Its mesh.
    pub geometry: &'a Geometry,
    /// What it is made of.
    pub material: &'a MaterialMaps,
    /// Table of what its surface lets through.
    pub rho_dt: &'a Map,
}

/// The pass's pipelines.
#[derive(Debug)]
pub struct DepthMapPass {
    first: Pipeline,
    next: Pipeline,
}

impl DepthMapPass {
    /// Compiles them.
    pub fn new(gpu: &Gpu) -> Self {
        let pipeline = |entry, targets: &[Format]| {
            let (name, source, entries) = ("depth map", shaders::DEPTH_MAP, ["see_grown", entry]);
            Pipeline::new(gpu, &Blueprint { name, source, entries, targets, additive: false, depth: true })
        };
        Self {
            first: pipeline("map_entry", &[Format::R32Float, Format::Rgba16Float]),
            next: pipeline("map_next", &[Format::R32Float]),
        }
    }

    /// Draws one object into a layer of the map of light number `light`, which is map number `map`; the first object empties
    /// it before.
    pub fn step(
        &self,
        gpu: &Gpu,
        inputs: &DepthMapInputs,
        maps: &DepthMaps,
        (light, map): (u32, u32),
        layer: u32,
    ) -> Step {
        let DepthMapInputs { samplers, geometry, material, .. } = *inputs;
        let numbers = gpu.uniform("grown", &Grown { light, growth_mm: maps.growth_mm, ..Grown::zeroed() });
        let mut bound = vec![
            (0, Bound::Buffer(&geometry.vertices)),
            (1, Bound::Buffer(&geometry.triangles)),
            (2, Bound::Buffer(inputs.lights)),
            (3, Bound::Buffer(&numbers)),
            (4, Bound::Buffer(&maps.alike[inputs.object as usize])),
        ];
        let mut targets = vec![maps.distances.layers[(map * maps.layers + layer) as usize].clone()];
        let (own, before) = if layer.is_multiple_of(2) { (0, 1) } else { (1, 0) };
        let pipeline = if layer == 0 {
            bound.extend([
                (5, Bound::Buffer(&material.numbers)),
                (6, Bound::Texture(inputs.rho_dt.view())),
                (7, Bound::Texture(material.albedo.view())),
                (8, Bound::Texture(material.relief.view())),
                (9, Bound::Texture(material.rho_s.view())),
                (10, Bound::Texture(material.roughness.view())),
                (11, Bound::Sampler(&samplers.linear)),
                (12, Bound::Sampler(&samplers.repeating)),
            ]);
            targets.push(maps.entered.layers[map as usize].clone());
            &self.first
        } else {
            bound.push((13, Bound::Texture(maps.depth_buffers[before].view())));
            &self.next
        };
        let first = inputs.object == 0;
        Step::Draw(Draw {
            pipeline: pipeline.clone(),
            bind_groups: vec![pipeline.bind(gpu, 0, &bound)],
            targets,
            depth: Some((maps.depth_buffers[own].view().clone(), first)),
            clear: first.then_some(wgpu::Color { r: f64::from(NOTHING_MM), g: 0.0, b: 0.0, a: 0.0 }),
            indices: None,
            vertices: 3 * geometry.triangle_count,
            instances: 1,
        })
    }
}

/// Where the vertices at the place of each vertex begin in the list itself, and one end more; then the vertices.
fn alike(object: &Object) -> Vec<u32> {
    let vertices = object.point_of_vertex.len();
    let mut at_point = vec![Vec::new(); vertices];
    for (vertex, &point) in (0..).zip(&object.point_of_vertex) {
        at_point[point as usize].push(vertex);
    }
    let mut list = Vec::with_capacity(2 * vertices + 1);
    let mut next = vertices as u32 + 1;
    for &point in &object.point_of_vertex {
        list.push(next);
        next += at_point[point as usize].len() as u32;
    }
    list.push(next);
    list.extend(object.point_of_vertex.iter().flat_map(|&point| &at_point[point as usize]));
    list
}

#[cfg(test)]
mod tests {
    use super::*;
    use cutis_scene::Material;
    use cutis_scene::validation::shapes::cuboid;
    use glam::Vec3;

    #[test]
    fn corners_of_a_box_are_three_vertices_each() {
        let object = Object::new("box", cuboid(Vec3::ZERO, Vec3::ONE), Material::default());
        let list = alike(&object);
        for v in 0..object.mesh.positions_mm.len() {
            let at = &list[list[v] as usize..list[v + 1] as usize];
            assert!(at.len() == 3 && at.contains(&(v as u32)), "{v}: {at:?}");
            let here = object.mesh.positions_mm[v];
            assert!(at.iter().all(|&other| object.mesh.positions_mm[other as usize] == here));
        }
    }
}
