//! The mean of the samples of every pixel.

use crate::Gpu;
use crate::map::Map;
use crate::pipeline::{Blueprint, Bound, Pipeline};
use crate::shaders;
use crate::step::Step;
use bytemuck::{Pod, Zeroable};
use wgpu::TextureFormat as Format;

/// The twin of `Pixels`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Pixels {
    /// Samples along a side of a pixel.
    pub grid: i32,
    /// Fills up the struct.
    pub pad0: u32,
    /// Fills up the struct.
    pub pad1: u32,
    /// Fills up the struct.
    pub pad2: u32,
}

/// The pass's pipelines.
#[derive(Debug)]
pub struct DownsamplePass {
    half: Pipeline,
    single: Pipeline,
}

impl DownsamplePass {
    /// Compiles them.
    pub fn new(gpu: &Gpu) -> Self {
        let pipeline = |format| {
            let entries = ["cover_picture", "downsample"];
            let (name, source, targets) = ("downsample", shaders::DOWNSAMPLE, &[format]);
            Pipeline::new(gpu, &Blueprint { name, source, entries, targets, additive: false, depth: false })
        };
        Self { half: pipeline(Format::Rgba16Float), single: pipeline(Format::Rgba32Float) }
    }

    /// From `samples`, `grid` times as wide and high, to `pixels`.
    pub fn step(&self, gpu: &Gpu, grid: u32, samples: &Map, pixels: &Map) -> Step {
        let pipeline = if pixels.texture.format() == Format::Rgba16Float { &self.half } else { &self.single };
        let numbers = gpu.uniform("pixels", &Pixels { grid: grid as i32, ..Pixels::zeroed() });
        let bound = [(0, Bound::Texture(samples.view())), (1, Bound::Buffer(&numbers))];
        super::over_picture(gpu, pipeline, &bound, pixels)
    }
}
