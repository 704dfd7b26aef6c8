//! How open the surface is to its surroundings: the twin of cutis-render's `ambient`, by depth maps from many directions.

use crate::Gpu;
use crate::map::{Map, View};
use crate::passes::atlas::AtlasMaps;
use crate::passes::over_charts;
use crate::passes::shadow::Drawn;
use crate::pipeline::{Blueprint, Bound, DEPTH, Pipeline};
use crate::scene::charts::ChartPyramid;
use crate::scene::geometry::Geometry;
use crate::shaders;
use crate::step::{Draw, Step};
use bytemuck::{Pod, Zeroable};
use wgpu::TextureFormat as Format;

/// How often the irradiance's size is halved for this map; also in the shader.
pub const HALVINGS: usize = 2;
/// Directions that are looked from together.
pub const TOGETHER: u32 = 8;

/// Some directions; its twin has the same name.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Batch {
    /// Number of the direction that the first layer of the maps shows.
    pub first: u32,
    /// How many there are.
    pub count: u32,
    /// Fills up the struct.
    pub pad0: u32,
    /// Fills up the struct.
    pub pad1: u32,
}

/// The pass's pipelines.
#[derive(Debug)]
pub struct OpennessPass {
    look: Pipeline,
    add: Pipeline,
    smooth: Pipeline,
}

impl OpennessPass {
    /// Compiles them.
    pub fn new(gpu: &Gpu) -> Self {
        let look = Blueprint {
            name: "openness",
            source: shaders::SHADOW,
            entries: ["see_from_light", "map_surface"],
            targets: &[],
            additive: false,
            depth: true,
        };
        let add = Blueprint {
            source: shaders::OPENNESS,
            entries: ["cover_run", "add_openness"],
            targets: &[Format::Rgba16Float],
            additive: true,
            depth: false,
            ..look
        };
        let smooth = Blueprint { entries: ["cover_run", "smooth_openness"], additive: false, ..add };
        let [look, add, smooth] = [look, add, smooth].map(|blueprint| Pipeline::new(gpu, &blueprint));
        Self { look, add, smooth }
    }

    /// Maps of `size` texels for the directions that are looked from together.
    pub fn maps(gpu: &Gpu, size: u32) -> Map {
        Map::square(gpu, "depths from afar", size, TOGETHER, DEPTH)
    }

    /// Draws an object as it is seen from one of some directions; the first object empties the map before.
    pub fn look(
        &self,
        gpu: &Gpu,
        drawn: Drawn,
        directions: &wgpu::Buffer,
        geometry: &Geometry,
        depth: &View,
    ) -> Step {
        let numbers = gpu.uniform("drawn", &drawn);
        let bound = [
            (0, Bound::Buffer(&geometry.vertices)),
            (1, Bound::Buffer(&geometry.triangles)),
            (2, Bound::Buffer(directions)),
            (3, Bound::Buffer(&numbers)),
        ];
        Step::Draw(Draw {
            pipeline: self.look.clone(),
            bind_groups: vec![self.look.bind(gpu, 0, &bound)],
            targets: Vec::new(),
            depth: Some((depth.clone(), drawn.object == 0)),
            clear: None,
            vertices: 3 * geometry.triangle_count,
            instances: 1,
        })
    }

    /// Adds what some directions see to a map; the first ones empty it before.
    pub fn add(
        &self,
        gpu: &Gpu,
        batch: Batch,
        (directions, depths): (&wgpu::Buffer, &Map),
        (atlas, charts): (&AtlasMaps, &ChartPyramid),
        target: &Map,
    ) -> Step {
        let numbers = gpu.uniform("batch", &batch);
        let bound = [
            (1, Bound::Buffer(directions)),
            (2, Bound::Buffer(&numbers)),
            (3, Bound::Texture(atlas.places.view())),
            (4, Bound::Texture(atlas.stretch.view())),
            (5, Bound::Texture(&charts.all)),
            (6, Bound::Texture(&depths.array)),
        ];
        let clear = batch.first == 0;
        over_charts(gpu, &self.add, &charts.sizes[HALVINGS], &bound, &[target.view()], clear)
    }

    /// Smooths the sum over all directions, whose shadows have edges, into another map.
    pub fn smooth(&self, gpu: &Gpu, charts: &ChartPyramid, [sum, target]: [&Map; 2]) -> Step {
        let bound = [(5, Bound::Texture(&charts.all)), (7, Bound::Texture(sum.view()))];
        over_charts(gpu, &self.smooth, &charts.sizes[HALVINGS], &bound, &[target.view()], true)
    }
}
