//! The kernel's sum of Gaussians, texel by texel. cutis-render takes it for every sample of the picture; samples outnumber
//! texels, and what they read is the same but for one more bilinear read.

use crate::Gpu;
use crate::map::View;
use crate::passes::levels::{Levels, MAX_GAUSSIANS};
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
    /// Layer of its level.
    pub layer: u32,
}

/// The Gaussians whose levels have one size; its twin has the same name.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Gaussians {
    /// The first `count` of them count.
    pub all: [Gaussian; MAX_GAUSSIANS],
    /// How many there are.
    pub count: u32,
    /// Layer of the last level one size up.
    pub finer_layer: u32,
    /// Fills up the struct.
    pub pad0: u32,
    /// Fills up the struct.
    pub pad1: u32,
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

    /// Adds up all Gaussians, size by size.
    pub fn steps(&self, gpu: &Gpu, kernel: &Kernel, levels: &Levels, target: &View) -> Vec<Step> {
        let finest = &levels.all[0];
        let mut steps = Vec::new();
        for (number, size) in levels.sizes.iter().enumerate() {
            let numbers = gaussians(kernel, levels, number);
            if numbers.count == 0 {
                continue;
            }
            let numbers = gpu.uniform("Gaussians", &numbers);
            let own = [(1, Bound::Buffer(&numbers)), (3, Bound::Texture(&size.light.array))];
            let clear = steps.is_empty();
            if size.charts.size == finest.charts.size {
                steps.push(over_charts(gpu, &self.full_size, &finest.charts, &own, &[target], clear));
                continue;
            }
            let finer = levels.finer_than(number);
            let others = [
                (2, Bound::Texture(finest.charts.map.view())),
                (4, Bound::Texture(size.charts.map.view())),
                (5, Bound::Texture(&finer.light.array)),
                (6, Bound::Texture(finer.charts.map.view())),
                (7, Bound::Texture(&finest.light.array)),
            ];
            let bound = [own.as_slice(), &others].concat();
            steps.push(over_charts(gpu, &self.smaller, &finest.charts, &bound, &[target], clear));
        }
        steps
    }
}

/// Those whose levels have size number `size`.
fn gaussians(kernel: &Kernel, levels: &Levels, size: usize) -> Gaussians {
    let mut gaussians = Gaussians { finer_layer: levels.finer_than(size).last_layer, ..Gaussians::zeroed() };
    for (i, weight) in kernel.weights.iter().enumerate().filter(|(i, _)| levels.size_of(*i) == size) {
        let layer = levels.all[i + 1].light.first_layer;
        gaussians.all[gaussians.count as usize] = Gaussian { weight: weight.to_array(), layer };
        gaussians.count += 1;
    }
    gaussians
}
