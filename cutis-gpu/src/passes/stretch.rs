//! Stretch at the vertices; the texels' follows in the pass `atlas`. The twin of cutis-render's `stretch`.

use crate::Gpu;
use crate::pipeline::{Bound, ComputePipeline};
use crate::scene::geometry::Geometry;
use crate::shaders;
use crate::step::{Dispatch, Step};

/// Invocations of a group; also in the shader.
const GROUP: u32 = 64;

/// The pass's pipeline.
#[derive(Debug)]
pub struct StretchPass {
    pipeline: ComputePipeline,
}

impl StretchPass {
    /// Compiles it.
    pub fn new(gpu: &Gpu) -> Self {
        Self { pipeline: ComputePipeline::new(gpu, "stretch", shaders::STRETCH, "stretch_at_vertices") }
    }

    /// Measures a mesh.
    pub fn step(&self, gpu: &Gpu, geometry: &Geometry) -> Step {
        let bound = [
            (0, Bound::Buffer(&geometry.vertices)),
            (1, Bound::Buffer(&geometry.triangles)),
            (2, Bound::Buffer(&geometry.fans)),
            (3, Bound::Buffer(&geometry.squared_stretch_mm2)),
        ];
        Step::Compute(Dispatch {
            pipeline: self.pipeline.clone(),
            bind_group: self.pipeline.bind(gpu, &bound),
            groups: geometry.vertex_count.div_ceil(GROUP),
        })
    }
}
