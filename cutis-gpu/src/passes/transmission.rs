//! Light that comes through the body. The twin of cutis-render's `transmission`; the light-facing surface comes from the
//! translucent shadow maps instead of rays.

use crate::Gpu;
use crate::map::{Map, View};
use crate::passes::atlas::AtlasMaps;
use crate::passes::levels::{LevelSize, Levels, MAX_GAUSSIANS, MAX_SIZES};
use crate::passes::over_tiles;
use crate::passes::shadow::ShadowMaps;
use crate::pipeline::{Blueprint, Bound, Pipeline};
use crate::scene::charts::{ChartPyramid, ChartTexture};
use crate::shaders;
use crate::step::{Draw, Step};
use bytemuck::{Pod, Zeroable};
use cutis_render::prepare::Kernel;
use wgpu::TextureFormat as Format;

/// Side of a square of texels that are marked together; also in `lib/thin_tiles.wgsl`.
pub const TEXELS_OF_MARK: u32 = 4;

/// One Gaussian of a body; its twin has the same name.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Slab {
    /// Weight per channel.
    pub weight: [f32; 3],
    /// Variance, mm².
    pub variance_mm2: f32,
    /// Layer of its level, for the light.
    pub layer: u32,
    /// First layer of the level before, for the distance.
    pub before_layer: u32,
    /// How often that one is halved.
    pub before_halvings: u32,
    /// Fills up the struct.
    pub pad0: u32,
}

/// All Gaussians of a body; its twin has the same name.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Slabs {
    /// The first `count` of them count.
    pub all: [Slab; MAX_GAUSSIANS],
    /// The same by the sizes of their levels; the first `size_count` of them count.
    pub sizes: [LevelSize; MAX_SIZES],
    /// How many Gaussians there are.
    pub count: u32,
    /// How many sizes there are.
    pub size_count: u32,
    /// Number of the object.
    pub object: u32,
    /// 1 if every light has a share of its own.
    pub many_lights: u32,
}

/// One round of smoothing; its twin has the same name.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Smoothing {
    /// Distance between texels that are taken in.
    pub step: i32,
    /// How far light has got by this round and those before, texels.
    pub reach: i32,
    /// Fills up the struct.
    pub pad0: u32,
    /// Fills up the struct.
    pub pad1: u32,
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
    /// Its charts.
    pub charts: &'a ChartPyramid,
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
    mark: Pipeline,
    transmit: Pipeline,
    smooth: Pipeline,
}

impl TransmissionPass {
    /// Compiles them.
    pub fn new(gpu: &Gpu) -> Self {
        let pipeline = |source, entries, format| {
            let (name, targets) = ("transmission", &[format]);
            Pipeline::new(gpu, &Blueprint { name, source, entries, targets, additive: false, depth: false })
        };
        let light = Format::Rgba16Float;
        Self {
            mark: pipeline(shaders::TRANSMISSION, ["cover_marks", "mark_thin"], Format::R8Unorm),
            transmit: pipeline(shaders::TRANSMISSION, ["cover_thin_tile", "transmit"], light),
            smooth: pipeline(shaders::SMOOTH, ["cover_thin_tile", "smooth_map"], light),
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
        let half_charts = &inputs.charts.sizes[1];
        let marks_size = half_charts.size.div_ceil(TEXELS_OF_MARK);
        let marks = Map::square(gpu, "thin places", marks_size, 1, Format::R8Unorm);
        let slabs = gpu.uniform("slabs", &slabs(inputs));
        let mut steps = vec![
            self.mark(gpu, inputs, &slabs, marks.view()),
            self.transmit(gpu, inputs, &slabs, &marks, from.view()),
        ];
        let mut reach = 0;
        for &round in rounds {
            // Two steps to either side.
            reach += 2 * round as i32;
            let numbers = Smoothing { step: round as i32, reach, ..Smoothing::zeroed() };
            steps.push(self.smooth(gpu, numbers, half_charts, &marks, [&from, &to]));
            std::mem::swap(&mut from, &mut to);
        }
        (steps, from)
    }

    /// Marks where light may come through.
    fn mark(&self, gpu: &Gpu, inputs: &TransmissionInputs, slabs: &wgpu::Buffer, target: &View) -> Step {
        Step::Draw(Draw {
            pipeline: self.mark.clone(),
            bind_groups: vec![self.mark.bind(gpu, 0, &bound(inputs, slabs)[..MARK_READS])],
            targets: vec![target.clone()],
            depth: None,
            clear: None,
            indices: None,
            vertices: 3,
            instances: 1,
        })
    }

    /// Adds up what comes through by all Gaussians.
    fn transmit(
        &self,
        gpu: &Gpu,
        inputs: &TransmissionInputs,
        slabs: &wgpu::Buffer,
        marks: &Map,
        target: &View,
    ) -> Step {
        let mut all = bound(inputs, slabs);
        all.push((MARKS, Bound::Texture(marks.view())));
        let half_charts = &inputs.charts.sizes[1];
        let tiles = (&half_charts.single_tiles, half_charts.tile_count);
        over_tiles(gpu, &self.transmit, tiles, &all, &[target], true)
    }

    fn smooth(
        &self,
        gpu: &Gpu,
        numbers: Smoothing,
        charts: &ChartTexture,
        marks: &Map,
        [from, to]: [&Map; 2],
    ) -> Step {
        let numbers = gpu.uniform("smoothing", &numbers);
        let bound = [
            (1, Bound::Buffer(&numbers)),
            (2, Bound::Texture(charts.map.view())),
            (3, Bound::Texture(from.view())),
            (MARKS, Bound::Texture(marks.view())),
        ];
        let tiles = (&charts.single_tiles, charts.tile_count);
        over_tiles(gpu, &self.smooth, tiles, &bound, &[to.view()], true)
    }
}

/// In place of no variance at all, by which nothing may be divided: deviations of a nanometre.
const LEAST_VARIANCE_MM2: f32 = 1e-12;
/// Where the marks are bound.
const MARKS: u32 = 20;
/// How many of [`bound`] marking reads: the first ones.
const MARK_READS: usize = 4;

fn bound<'a>(inputs: &TransmissionInputs<'a>, slabs: &'a wgpu::Buffer) -> Vec<(u32, Bound<'a>)> {
    let TransmissionInputs { lights, charts, atlas, shadows, levels, .. } = *inputs;
    // A single light's share is not read; something has to be bound.
    let shares = inputs.shares.map_or(&levels.all[0].light.array, |shares| &shares.array);
    vec![
        (1, Bound::Buffer(slabs)),
        (2, Bound::Buffer(lights)),
        (3, Bound::Texture(&charts.all)),
        (4, Bound::Texture(&levels.texture)),
        (5, Bound::Texture(atlas.places.view())),
        (6, Bound::Texture(atlas.stretch.view())),
        (7, Bound::Texture(&shadows.depths.array)),
        (8, Bound::Texture(&shadows.surfaces.array)),
        (9, Bound::Texture(shares)),
    ]
}

/// The Gaussians of the object's kernel.
fn slabs(inputs: &TransmissionInputs) -> Slabs {
    let TransmissionInputs { kernel, levels, .. } = inputs;
    let mut slabs = Slabs {
        object: inputs.object,
        many_lights: u32::from(inputs.shares.is_some()),
        count: kernel.weights.len() as u32,
        ..Slabs::zeroed()
    };
    for (size, of_levels) in slabs.sizes.iter_mut().zip(levels.sizes()) {
        *size = of_levels;
        slabs.size_count += 1;
    }
    let gaussians = kernel.weights.iter().zip(&kernel.variances_mm2).zip(levels.all.windows(2));
    for (slab, ((weight, &variance_mm2), pair)) in slabs.all.iter_mut().zip(gaussians) {
        let [before, level] = [&pair[0].light, &pair[1].light];
        *slab = Slab {
            // One without width lets nothing through.
            weight: if variance_mm2 > 0.0 { weight.to_array() } else { [0.0; 3] },
            variance_mm2: variance_mm2.max(LEAST_VARIANCE_MM2),
            layer: level.first_layer,
            before_layer: before.first_layer,
            before_halvings: before.halvings,
            ..Slab::zeroed()
        };
    }
    slabs
}
