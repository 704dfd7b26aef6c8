//! The kernel's sum of Gaussians, texel by texel. cutis-render takes it for every sample of the picture; samples outnumber
//! texels, and what they read is the same but for one more bilinear read.

use crate::Gpu;
use crate::passes::diffusion::Levels;
use crate::passes::over_charts;
use crate::pipeline::{Blueprint, Bound, Pipeline};
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
    /// Fills up the struct.
    pub pad0: f32,
}

/// The pass's pipeline.
#[derive(Debug)]
pub struct GatherPass {
    full_size: Pipeline,
    smaller: Pipeline,
}

impl GatherPass {
    /// Compiles it.
    pub fn new(gpu: &Gpu) -> Self {
        let pipeline = |entry| {
            let (entries, targets) = (["cover_run", entry], &[Format::Rgba16Float]);
            let (name, source) = ("gather", shaders::GATHER);
            Pipeline::new(gpu, &Blueprint { name, source, entries, targets, additive: true, depth: false })
        };
        Self { full_size: pipeline("gather_texel"), smaller: pipeline("gather") }
    }

    /// Adds up all Gaussians.
    pub fn steps(
        &self,
        gpu: &Gpu,
        kernel: &Kernel,
        levels: &Levels,
        target: &wgpu::TextureView,
    ) -> Vec<Step> {
        let add = |(i, weight): (usize, &glam::Vec3)| {
            let gaussian = gpu.uniform("Gaussian", &Gaussian { weight: weight.to_array(), pad0: 0.0 });
            let (level, finer, finest) = (&levels.all[i + 1], levels.finer_than(i + 1), &levels.all[0]);
            let own = [(1, Bound::Buffer(&gaussian)), (3, Bound::Texture(&level.light.array))];
            if level.charts.size == finest.charts.size {
                return over_charts(gpu, &self.full_size, &finest.charts, &own, &[target], i == 0);
            }
            let others = [
                (2, Bound::Texture(finest.charts.map.view())),
                (4, Bound::Texture(level.charts.map.view())),
                (5, Bound::Texture(&finer.light.array)),
                (6, Bound::Texture(finer.charts.map.view())),
                (7, Bound::Texture(&finest.light.array)),
            ];
            let bound = [own.as_slice(), &others].concat();
            over_charts(gpu, &self.smaller, &finest.charts, &bound, &[target], i == 0)
        };
        kernel.weights.iter().enumerate().map(add).collect()
    }
}
