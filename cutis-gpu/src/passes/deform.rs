//! The mesh in its pose, before everything else that looks at it. The twin of cutis-scene's `deform`.

use crate::Gpu;
use crate::pipeline::{Bound, ComputePipeline};
use crate::scene::deformable::Deformable;
use crate::scene::geometry::Geometry;
use crate::shaders;
use crate::step::{Dispatch, Step};

/// Invocations of a group; also in the shader.
const GROUP: u32 = 64;

/// The pass's pipeline.
#[derive(Debug)]
pub struct DeformPass {
    pipeline: ComputePipeline,
}

impl DeformPass {
    /// Compiles it.
    pub fn new(gpu: &Gpu) -> Self {
        Self { pipeline: ComputePipeline::new(gpu, "deform", shaders::DEFORM, "deform_vertices") }
    }

    /// Moves the vertices of a mesh from rest into the pose that was written last.
    pub fn step(&self, gpu: &Gpu, deformable: &Deformable, geometry: &Geometry) -> Step {
        let bound = [
            (0, Bound::Buffer(&deformable.numbers)),
            (1, Bound::Buffer(&deformable.rest)),
            (2, Bound::Buffer(&geometry.vertices)),
            (3, Bound::Buffer(&deformable.first_offsets)),
            (4, Bound::Buffer(&deformable.offsets)),
            (5, Bound::Buffer(&deformable.morph_weights)),
            (6, Bound::Buffer(&deformable.influences)),
            (7, Bound::Buffer(&deformable.joints)),
        ];
        Step::Compute(Dispatch {
            pipeline: self.pipeline.clone(),
            bind_group: self.pipeline.bind(gpu, &bound),
            groups: geometry.vertex_count.div_ceil(GROUP),
        })
    }
}
