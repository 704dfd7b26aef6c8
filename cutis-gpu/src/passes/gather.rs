//! The kernel's sum of Gaussians, texel by texel. cutis-render takes it for every sample of the picture; samples outnumber
//! texels, and what they read is the same but for one more bilinear read.

use crate::Gpu;
use crate::map::View;
use crate::passes::levels::{LevelSize, Levels, MAX_GAUSSIANS, MAX_SIZES};
use crate::passes::over_charts;
use crate::pipeline::{Blueprint, Bound, Pipeline};
use crate::scene::charts::ChartPyramid;
use crate::shaders;
use crate::step::Step;
use bytemuck::{Pod, Zeroable};
use cutis_render::prepare::Kernel;
use wgpu::TextureFormat as Format;

/// One Gaussian; its twin has the same name.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Gaussian {
    /// Weight per channel.
    pub weight: [f32; 3],
    /// Layer of its level.
    pub layer: u32,
}

/// All Gaussians; its twin has the same name.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Gaussians {
    /// Those of the kernel; the others are not read.
    pub all: [Gaussian; MAX_GAUSSIANS],
    /// The same by the sizes of their levels; the first `size_count` of them count.
    pub sizes: [LevelSize; MAX_SIZES],
    /// How many sizes there are.
    pub size_count: u32,
    /// Fills up the struct.
    pub pad0: u32,
    /// Fills up the struct.
    pub pad1: u32,
    /// Fills up the struct.
    pub pad2: u32,
}

/// The pass's pipeline.
#[derive(Debug)]
pub struct GatherPass {
    pipeline: Pipeline,
}

impl GatherPass {
    /// Compiles it.
    pub fn new(gpu: &Gpu) -> Self {
        let blueprint = Blueprint {
            name: "gather",
            source: shaders::GATHER,
            entries: ["cover_run", "gather"],
            targets: &[Format::Rgba16Float],
            additive: false,
            depth: false,
        };
        Self { pipeline: Pipeline::new(gpu, &blueprint) }
    }

    /// Adds up all Gaussians.
    pub fn step(
        &self,
        gpu: &Gpu,
        kernel: &Kernel,
        levels: &Levels,
        charts: &ChartPyramid,
        target: &View,
    ) -> Step {
        let numbers = gpu.uniform("Gaussians", &gaussians(kernel, levels));
        let bound = [
            (1, Bound::Buffer(&numbers)),
            (2, Bound::Texture(&charts.all)),
            (3, Bound::Texture(&levels.texture)),
        ];
        over_charts(gpu, &self.pipeline, &charts.sizes[0], &bound, &[target], false)
    }
}

fn gaussians(kernel: &Kernel, levels: &Levels) -> Gaussians {
    let mut gaussians = Gaussians::zeroed();
    for (size, of_levels) in gaussians.sizes.iter_mut().zip(levels.sizes()) {
        *size = of_levels;
        gaussians.size_count += 1;
    }
    for ((gaussian, weight), level) in gaussians.all.iter_mut().zip(&kernel.weights).zip(&levels.all[1..]) {
        *gaussian = Gaussian { weight: weight.to_array(), layer: level.light.first_layer };
    }
    gaussians
}
