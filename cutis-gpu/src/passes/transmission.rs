//! Light that comes through the body. The twin of cutis-render's `transmission`; the light-facing surface comes from the
//! translucent shadow maps instead of rays.

use crate::Gpu;
use crate::map::Map;
use crate::passes::atlas::AtlasMaps;
use crate::passes::diffusion::Levels;
use crate::passes::over_charts;
use crate::passes::shadow::ShadowMaps;
use crate::pipeline::{Blueprint, Bound, Pipeline};
use crate::scene::charts::ChartTexture;
use crate::shaders;
use crate::step::Step;
use bytemuck::{Pod, Zeroable};
use cutis_render::prepare::Kernel;
use wgpu::TextureFormat as Format;

/// One Gaussian of a body; its twin has the same name.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Slab {
    /// Weight per channel.
    pub weight: [f32; 3],
    /// Variance, mm².
    pub variance_mm2: f32,
    /// Number of the object.
    pub object: u32,
    /// 1 if every light has a share of its own.
    pub many_lights: u32,
    /// Fills up the struct.
    pub pad0: u32,
    /// Fills up the struct.
    pub pad1: u32,
}

/// One round of smoothing; its twin has the same name.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Smoothing {
    /// Distance between texels that are taken in.
    pub step: i32,
    /// Fills up the struct.
    pub pad0: u32,
    /// Fills up the struct.
    pub pad1: u32,
    /// Fills up the struct.
    pub pad2: u32,
}

/// Everything the pass reads.
#[derive(Debug, Clone, Copy)]
pub struct TransmissionInputs<'a> {
    /// Number of the object.
    pub object: u32,
    /// All lights.
    pub lights: &'a wgpu::Buffer,
    /// The object's kernel.
    pub kernel: &'a Kernel,
    /// Its unrolled surface.
    pub atlas: &'a AtlasMaps,
    /// Its charts at half the size.
    pub half_charts: &'a ChartTexture,
    /// What the lights see.
    pub shadows: &'a ShadowMaps,
    /// Share of each light; none with a single one.
    pub shares: Option<&'a Map>,
    /// The blurred light.
    pub levels: &'a Levels,
}

/// The pass's pipelines.
#[derive(Debug)]
pub struct TransmissionPass {
    transmit: Pipeline,
    smooth: Pipeline,
}

impl TransmissionPass {
    /// Compiles them.
    pub fn new(gpu: &Gpu) -> Self {
        let pipeline = |source, entry, additive| {
            let (entries, targets) = (["cover_run", entry], &[Format::Rgba16Float]);
            let name = "transmission";
            Pipeline::new(gpu, &Blueprint { name, source, entries, targets, additive, depth: false })
        };
        Self {
            transmit: pipeline(shaders::TRANSMISSION, "transmit", true),
            smooth: pipeline(shaders::SMOOTH, "smooth_map", false),
        }
    }

    /// Adds up what comes through by every Gaussian and smooths it, `rounds` with so many texels between those taken in.
    /// Gives the steps, and the one of two maps that holds the result.
    pub fn steps(
        &self,
        gpu: &Gpu,
        inputs: &TransmissionInputs,
        rounds: &[usize],
        maps: [Map; 2],
    ) -> (Vec<Step>, Map) {
        let [mut from, mut to] = maps;
        let gaussians = inputs.kernel.weights.len();
        let mut steps: Vec<_> = (0..gaussians).map(|i| self.gaussian(gpu, inputs, i, from.view())).collect();
        for &round in rounds {
            let numbers = gpu.uniform("smoothing", &Smoothing { step: round as i32, ..Smoothing::zeroed() });
            let bound = [
                (1, Bound::Buffer(&numbers)),
                (2, Bound::Texture(inputs.half_charts.map.view())),
                (3, Bound::Texture(from.view())),
            ];
            steps.push(over_charts(gpu, &self.smooth, inputs.half_charts, &bound, &[to.view()], false));
            std::mem::swap(&mut from, &mut to);
        }
        (steps, from)
    }

    fn gaussian(&self, gpu: &Gpu, inputs: &TransmissionInputs, i: usize, target: &wgpu::TextureView) -> Step {
        let slab = gpu.uniform(
            "slab",
            &Slab {
                weight: inputs.kernel.weights[i].to_array(),
                variance_mm2: inputs.kernel.variances_mm2[i],
                object: inputs.object,
                many_lights: u32::from(inputs.shares.is_some()),
                ..Slab::zeroed()
            },
        );
        let levels = &inputs.levels.all;
        let (before, level, finest) = (&levels[i], &levels[i + 1], &levels[0]);
        let finer = inputs.levels.finer_than(i + 1);
        // A single light's share is not read; something has to be bound.
        let shares = inputs.shares.unwrap_or(&finest.light);
        let bound = [
            (1, Bound::Buffer(&slab)),
            (2, Bound::Buffer(inputs.lights)),
            (3, Bound::Texture(inputs.half_charts.map.view())),
            (4, Bound::Texture(finest.charts.map.view())),
            (5, Bound::Texture(inputs.atlas.places.view())),
            (6, Bound::Texture(inputs.atlas.stretch.view())),
            (7, Bound::Texture(&inputs.shadows.depths.array)),
            (8, Bound::Texture(&inputs.shadows.surfaces.array)),
            (9, Bound::Texture(&shares.array)),
            (10, Bound::Texture(&before.light.array)),
            (11, Bound::Texture(before.charts.map.view())),
            (12, Bound::Texture(&level.light.array)),
            (13, Bound::Texture(level.charts.map.view())),
            (14, Bound::Texture(&finest.light.array)),
            (15, Bound::Texture(&finer.light.array)),
            (16, Bound::Texture(finer.charts.map.view())),
        ];
        over_charts(gpu, &self.transmit, inputs.half_charts, &bound, &[target], i == 0)
    }
}
