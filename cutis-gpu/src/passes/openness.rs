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
use wgpu::TextureFormat as Format;

/// How often the irradiance's size is halved for this map; also in the shader.
pub const HALVINGS: usize = 2;
/// Format of its maps. Half of the bits would do, but llvmpipe cuts off what it has no bits for, and what is open on all
/// sides would lose a thousandth.
pub const FORMAT: Format = Format::Rgba32Float;

/// The pass's pipelines.
#[derive(Debug)]
pub struct OpennessPass {
    look: Pipeline,
    around: Pipeline,
    smooth: Pipeline,
}

impl OpennessPass {
    /// Compiles them.
    pub fn new(gpu: &Gpu) -> Self {
        let look = Blueprint {
            name: "openness",
            source: shaders::SHADOW,
            entries: ["see_depth", "map_surface"],
            targets: &[],
            additive: false,
            depth: true,
        };
        let around = Blueprint {
            source: shaders::OPENNESS,
            entries: ["cover_run", "look_around"],
            targets: &[FORMAT],
            depth: false,
            ..look
        };
        let smooth = Blueprint { entries: ["cover_run", "smooth_openness"], ..around };
        let [look, around, smooth] = [look, around, smooth].map(|blueprint| Pipeline::new(gpu, &blueprint));
        Self { look, around, smooth }
    }

    /// Maps of `size` texels for so many directions.
    pub fn maps(gpu: &Gpu, size: u32, directions: u32) -> Map {
        Map::square(gpu, "depths from afar", size, directions, DEPTH)
    }

    /// Draws an object as it is seen from a direction; the first object empties the map before.
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
            (2, Bound::Buffer(directions)),
            (3, Bound::Buffer(&numbers)),
        ];
        Step::Draw(Draw {
            pipeline: self.look.clone(),
            bind_groups: vec![self.look.bind(gpu, 0, &bound)],
            targets: Vec::new(),
            depth: Some((depth.clone(), drawn.object == 0)),
            clear: None,
            indices: Some(geometry.indices.clone()),
            vertices: 3 * geometry.triangle_count,
            instances: 1,
        })
    }

    /// Finds out what all directions see of an object.
    pub fn look_around(
        &self,
        gpu: &Gpu,
        (directions, depths): (&wgpu::Buffer, &Map),
        (atlas, charts): (&AtlasMaps, &ChartPyramid),
        target: &Map,
    ) -> Step {
        let bound = [
            (1, Bound::Buffer(directions)),
            (2, Bound::Texture(atlas.places.view())),
            (3, Bound::Texture(atlas.stretch.view())),
            (4, Bound::Texture(&charts.all)),
            (5, Bound::Texture(&depths.array)),
        ];
        over_charts(gpu, &self.around, &charts.sizes[HALVINGS], &bound, &[target.view()], true)
    }

    /// Smooths the edges of what single directions see, into another map.
    pub fn smooth(&self, gpu: &Gpu, charts: &ChartPyramid, [sharp, target]: [&Map; 2]) -> Step {
        let bound = [(4, Bound::Texture(&charts.all)), (6, Bound::Texture(sharp.view()))];
        over_charts(gpu, &self.smooth, &charts.sizes[HALVINGS], &bound, &[target.view()], true)
    }
}
