//! Light that comes through the body. The twin of cutis-render's `transmission`; the light-facing surface comes from the
//! translucent shadow maps instead of rays.

use crate::Gpu;
use crate::map::{Map, View};
use crate::passes::atlas::AtlasMaps;
use crate::passes::levels::{Levels, MAX_GAUSSIANS};
use crate::passes::over_tiles;
use crate::passes::shadow::ShadowMaps;
use crate::pipeline::{Blueprint, Bound, Pipeline};
use crate::scene::charts::ChartTexture;
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
    /// Layer of the level before, for the distance.
    pub before: u32,
    /// 1 if that one is one size up.
    pub before_is_finer: u32,
    /// Fills up the struct.
    pub pad0: u32,
}

/// The Gaussians whose levels have one size; its twin has the same name.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Slabs {
    /// The first `count` of them count.
    pub all: [Slab; MAX_GAUSSIANS],
    /// How many there are.
    pub count: u32,
    /// Layer of the last level one size up.
    pub finer_layer: u32,
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
    mark: Pipeline,
    transmit: Pipeline,
    smooth: Pipeline,
}

impl TransmissionPass {
    /// Compiles them.
    pub fn new(gpu: &Gpu) -> Self {
        let pipeline = |source, entries, format, additive| {
            let (name, targets) = ("transmission", &[format]);
            Pipeline::new(gpu, &Blueprint { name, source, entries, targets, additive, depth: false })
        };
        let light = Format::Rgba16Float;
        Self {
            mark: pipeline(shaders::TRANSMISSION, ["cover_marks", "mark_thin"], Format::R8Unorm, true),
            transmit: pipeline(shaders::TRANSMISSION, ["cover_thin_tile", "transmit"], light, true),
            smooth: pipeline(shaders::SMOOTH, ["cover_thin_tile", "smooth_map"], light, false),
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
        let marks_size = inputs.half_charts.size.div_ceil(TEXELS_OF_MARK);
        let marks = Map::square(gpu, "thin places", marks_size, 1, Format::R8Unorm);
        let sizes: Vec<_> = (0..inputs.levels.sizes.len())
            .map(|size| (size, slabs(inputs, size)))
            .filter(|(_, slabs)| slabs.count > 0)
            .map(|(size, slabs)| (size, gpu.uniform("slabs", &slabs)))
            .collect();
        let mut steps = Vec::new();
        for (i, (size, slabs)) in sizes.iter().enumerate() {
            steps.push(self.mark(gpu, inputs, (*size, slabs), marks.view(), i == 0));
        }
        for (i, (size, slabs)) in sizes.iter().enumerate() {
            steps.push(self.transmit(gpu, inputs, (*size, slabs), &marks, from.view(), i == 0));
        }
        let mut reach = 0;
        for &round in rounds {
            // Two steps to either side.
            reach += 2 * round as i32;
            let numbers = Smoothing { step: round as i32, reach, ..Smoothing::zeroed() };
            steps.push(self.smooth(gpu, numbers, inputs.half_charts, &marks, [&from, &to]));
            std::mem::swap(&mut from, &mut to);
        }
        (steps, from)
    }

    /// Marks where light may come through.
    fn mark(
        &self,
        gpu: &Gpu,
        inputs: &TransmissionInputs,
        (size, slabs): (usize, &wgpu::Buffer),
        target: &View,
        clear: bool,
    ) -> Step {
        let all = bound(inputs, size, slabs);
        let read: Vec<_> = all.into_iter().filter(|(binding, _)| MARK_READS.contains(binding)).collect();
        Step::Draw(Draw {
            pipeline: self.mark.clone(),
            bind_groups: vec![self.mark.bind(gpu, 0, &read)],
            targets: vec![target.clone()],
            depth: None,
            clear: clear.then_some(wgpu::Color::TRANSPARENT),
            vertices: 3,
            instances: 1,
        })
    }

    /// Adds what comes through by the Gaussians of a size.
    fn transmit(
        &self,
        gpu: &Gpu,
        inputs: &TransmissionInputs,
        (size, slabs): (usize, &wgpu::Buffer),
        marks: &Map,
        target: &View,
        clear: bool,
    ) -> Step {
        let mut all = bound(inputs, size, slabs);
        all.push((MARKS, Bound::Texture(marks.view())));
        let tiles = (&inputs.half_charts.single_tiles, inputs.half_charts.tile_count);
        over_tiles(gpu, &self.transmit, tiles, &all, &[target], clear)
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

/// Where the marks are bound.
const MARKS: u32 = 20;
/// What of [`bound`] marking reads.
const MARK_READS: [u32; 7] = [1, 2, 3, 4, 10, 12, 14];

fn bound<'a>(inputs: &TransmissionInputs<'a>, size: usize, slabs: &'a wgpu::Buffer) -> Vec<(u32, Bound<'a>)> {
    let TransmissionInputs { lights, half_charts, atlas, shadows, levels, .. } = *inputs;
    let (own, finer, finest) = (&levels.sizes[size], levels.finer_than(size), &levels.all[0]);
    // A single light's share is not read; something has to be bound.
    let shares = inputs.shares.unwrap_or(&finest.light);
    vec![
        (1, Bound::Buffer(slabs)),
        (2, Bound::Buffer(lights)),
        (3, Bound::Texture(half_charts.map.view())),
        (4, Bound::Texture(finest.charts.map.view())),
        (5, Bound::Texture(atlas.places.view())),
        (6, Bound::Texture(atlas.stretch.view())),
        (7, Bound::Texture(&shadows.depths.array)),
        (8, Bound::Texture(&shadows.surfaces.array)),
        (9, Bound::Texture(&shares.array)),
        (10, Bound::Texture(&own.light.array)),
        (11, Bound::Texture(own.charts.map.view())),
        (12, Bound::Texture(&finer.light.array)),
        (13, Bound::Texture(finer.charts.map.view())),
        (14, Bound::Texture(&finest.light.array)),
    ]
}

/// The Gaussians whose levels have size number `size`. One without width lets nothing through.
fn slabs(inputs: &TransmissionInputs, size: usize) -> Slabs {
    let TransmissionInputs { kernel, levels, .. } = inputs;
    let mut slabs = Slabs {
        finer_layer: levels.finer_than(size).last_layer,
        object: inputs.object,
        many_lights: u32::from(inputs.shares.is_some()),
        ..Slabs::zeroed()
    };
    let wide = |i: &usize| levels.size_of(*i) == size && kernel.variances_mm2[*i] > 0.0;
    for i in (0..kernel.weights.len()).filter(wide) {
        let (before, level) = (&levels.all[i], &levels.all[i + 1]);
        slabs.all[slabs.count as usize] = Slab {
            weight: kernel.weights[i].to_array(),
            variance_mm2: kernel.variances_mm2[i],
            layer: level.light.first_layer,
            before: before.light.first_layer,
            before_is_finer: u32::from(before.size != size),
            ..Slab::zeroed()
        };
        slabs.count += 1;
    }
    slabs
}
