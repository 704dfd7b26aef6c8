//! Diffusion of light over the unrolled surface, by the plan of cutis-render's `diffusion`: seven-tap blurs along u and v,
//! each Gaussian from the one before, wide ones in smaller textures.

use crate::Gpu;
use crate::map::{Map, View};
use crate::passes::levels::Levels;
use crate::passes::over_charts;
use crate::pipeline::{Blueprint, Bound, Pipeline};
use crate::scene::charts::ChartTexture;
use crate::shaders;
use crate::step::Step;
use bytemuck::{Pod, Zeroable};
use cutis_render::passes::blur;
use cutis_render::passes::diffusion::Action;
use cutis_render::passes::tap::TAPS;
use wgpu::TextureFormat as Format;

/// Format of stretch and of variances: two numbers a texel.
const PAIR: Format = Format::Rg16Float;

/// Variance in texel² up to which light stays in its texel: half as much of it, 2 %, would reach each neighbour.
const STAYS_TEXEL2: f32 = 0.04;
/// Distances to either side that a blur takes in at once, and that few texels go beyond: going round again costs most.
const AT_ONCE: [f32; 3] = [2.0, 4.0, 8.0];
/// Deviations that are taken in; also in the shaders.
const DEVIATIONS: f32 = 3.3;

/// How one step widens along one axis; the twin of `Widening` in `taps.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Widening {
    /// Variance before the step, mm².
    pub from_mm2: f32,
    /// Variance after it, mm².
    pub to_mm2: f32,
    /// Variance in texel² that other means have added or will add.
    pub saved_texel2: f32,
    /// Variance of the weights at spacing 1, texel².
    pub unit_variance: f32,
    /// Weight of the centre and of one tap at each distance.
    pub weights: [f32; 4],
    /// 0 along u, 1 along v.
    pub axis: u32,
    /// Fills up the struct.
    pub pad0: u32,
    /// Fills up the struct.
    pub pad1: u32,
    /// Fills up the struct.
    pub pad2: u32,
}

/// The line along which a layer is blurred; the twin of `Along` in `blur.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Along {
    /// From one texel to the next.
    pub step_texels: [i32; 2],
    /// Fills up the struct.
    pub pad0: u32,
    /// Fills up the struct.
    pub pad1: u32,
}

/// What is halved; the twin of `Halved` in `halve.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Halved {
    /// Layer that is read.
    pub layer: u32,
    /// Factor on the mean.
    pub factor: f32,
    /// Fills up the struct.
    pub pad0: u32,
    /// Fills up the struct.
    pub pad1: u32,
}

/// The pass's pipelines and tables.
#[derive(Debug)]
pub struct DiffusionPass {
    taps: Pipeline,
    /// By how many distances they take in at once: see [`AT_ONCE`].
    blurs: [Pipeline; 3],
    halve_light: Pipeline,
    halve_stretch: Pipeline,
    narrow: wgpu::Buffer,
}

/// What has to be done.
#[derive(Debug)]
pub struct Diffusion {
    /// Lays the taps: to be done when the geometry has changed.
    pub taps: Vec<Step>,
    /// Blurs the light.
    pub blurs: Vec<Step>,
}

impl DiffusionPass {
    /// Compiles them.
    pub fn new(gpu: &Gpu) -> Self {
        let pipeline = |name, source, entry, targets: &[Format]| {
            let entries = ["cover_run", entry];
            Pipeline::new(gpu, &Blueprint { name, source, entries, targets, additive: false, depth: false })
        };
        let light = &[Format::Rgba16Float];
        Self {
            taps: pipeline("taps", shaders::TAPS, "lay_taps", &[PAIR, PAIR]),
            blurs: ["blur_by_twos", "blur_by_fours", "blur_by_eights"]
                .map(|entry| pipeline("blur", shaders::BLUR, entry, light)),
            halve_light: pipeline("blur", shaders::HALVE, "halve", light),
            halve_stretch: pipeline("taps", shaders::HALVE, "halve", &[PAIR]),
            narrow: gpu.storage("discrete variances", &TAPS.narrow),
        }
    }

    /// The steps that fill all levels but the first, from that one. `charts` are those of the first size and of every halved
    /// one; `actions` those that the levels were made for. What `half_way` holds, as many layers as a level has, is lost.
    pub fn steps(
        &self,
        gpu: &Gpu,
        charts: &[ChartTexture],
        levels: &Levels,
        (stretch, half_way): (&Map, &Map),
        actions: &[Action],
        texel_mm: f32,
    ) -> Diffusion {
        let mut way = Way::new(self, gpu, charts, levels, (stretch, half_way), texel_mm);
        for &action in actions {
            match action {
                Action::Halve => way.halve(),
                Action::Step(widening) => way.step(widening),
                Action::Keep => way.level += 1,
            }
        }
        Diffusion { taps: way.taps, blurs: way.blurs }
    }
}

/// What of a plan is done here, where most texels are `texel_mm` wide.
///
/// Steps in between keep taps from being too far apart. A Gaussian sampled at every texel needs none: one step does what
/// several in a row would do. And what would hardly leave its texel stays there, until a wider Gaussian takes it along.
pub fn shortened(plan: &[Action], texel_mm: f32) -> Vec<Action> {
    let mut actions: Vec<Action> = Vec::new();
    let mut saved: Option<blur::Widening> = None;
    for &action in plan {
        match (actions.last_mut(), action) {
            (Some(Action::Step(before)), Action::Step(next)) => before.to_mm2 = next.to_mm2,
            (_, Action::Step(next)) => {
                let from = saved.take().unwrap_or(next);
                let whole = blur::Widening { to_mm2: next.to_mm2, ..from };
                if whole.to_mm2 < STAYS_TEXEL2 * texel_mm * texel_mm {
                    saved = Some(whole);
                } else {
                    actions.push(Action::Step(whole));
                }
            }
            _ => actions.push(action),
        }
    }
    actions
}

/// Where a plan has got to.
struct Way<'a> {
    pass: &'a DiffusionPass,
    gpu: &'a Gpu,
    charts: &'a [ChartTexture],
    levels: &'a Levels,
    halvings: usize,
    /// Number of the level that was kept last.
    level: usize,
    /// Width of most texels, mm.
    texel_mm: f32,
    light: Map,
    stretch: Map,
    /// Where blurred stretch goes in turn.
    stretches: [Map; 2],
    /// Light blurred along u only.
    half_way: Map,
    taps: Vec<Step>,
    blurs: Vec<Step>,
}

impl<'a> Way<'a> {
    fn new(
        pass: &'a DiffusionPass,
        gpu: &'a Gpu,
        charts: &'a [ChartTexture],
        levels: &'a Levels,
        (stretch, half_way): (&Map, &Map),
        texel_mm: f32,
    ) -> Self {
        Self {
            half_way: half_way.clone(),
            light: levels.all[0].light.clone(),
            stretches: pair(gpu, charts[0].size),
            levels,
            level: 0,
            texel_mm,
            stretch: stretch.clone(),
            taps: Vec::new(),
            blurs: Vec::new(),
            halvings: 0,
            pass,
            gpu,
            charts,
        }
    }

    fn charts(&self) -> &'a ChartTexture {
        &self.charts[self.halvings]
    }

    fn halve(&mut self) {
        let fine = self.charts();
        self.halvings += 1;
        self.texel_mm *= 2.0;
        let size = self.charts().size;
        self.half_way = like_level(self.gpu, "blurred light", size, &self.light);
        let light = like_level(self.gpu, "halved light", size, &self.light);
        for (layer, target) in (0..).zip(&light.layers) {
            let halved = Halved { layer, factor: 1.0, ..Halved::zeroed() };
            self.blurs.push(self.halved(&self.pass.halve_light, fine, halved, &self.light, target));
        }
        self.stretches = pair(self.gpu, size);
        let stretch = self.next_stretch();
        let halved = Halved { factor: 2.0, ..Halved::zeroed() };
        self.taps.push(self.halved(&self.pass.halve_stretch, fine, halved, &self.stretch, stretch.view()));
        (self.light, self.stretch) = (light, stretch);
    }

    /// The map that does not hold the stretch now.
    fn next_stretch(&mut self) -> Map {
        self.stretches.swap(0, 1);
        self.stretches[0].clone()
    }

    fn halved(
        &self,
        pipeline: &Pipeline,
        fine: &ChartTexture,
        halved: Halved,
        source: &Map,
        target: &View,
    ) -> Step {
        let numbers = self.gpu.uniform("halved", &halved);
        let bound = [
            (1, Bound::Buffer(&numbers)),
            (2, Bound::Texture(fine.map.view())),
            (3, Bound::Texture(self.charts().map.view())),
            (4, Bound::Texture(&source.array)),
        ];
        over_charts(self.gpu, pipeline, self.charts(), &bound, &[target], false)
    }

    /// Blurs along u, then along v into the next level.
    fn step(&mut self, widening: blur::Widening) {
        self.blur(widening, 0, self.half_way.clone());
        self.blur(widening, 1, self.levels.all[self.level + 1].light.clone());
    }

    /// The pipeline that takes in most texels at once.
    fn pipeline(&self, widening: blur::Widening) -> &'a Pipeline {
        let variance_mm2 = widening.to_mm2 - widening.from_mm2;
        let farthest = DEVIATIONS * variance_mm2.max(0.0).sqrt() / self.texel_mm + 0.5;
        let fits = AT_ONCE.iter().position(|&taps| farthest < taps + 1.0).unwrap_or(AT_ONCE.len() - 1);
        &self.pass.blurs[fits]
    }

    fn blur(&mut self, widening: blur::Widening, axis: u32, target: Map) {
        let variances = self.lay_taps(widening, axis);
        let step_texels = if axis == 0 { [1, 0] } else { [0, 1] };
        let pipeline = self.pipeline(widening);
        let numbers = self.gpu.uniform("along", &Along { step_texels, ..Along::zeroed() });
        for (source, target) in self.light.layers.iter().zip(&target.layers) {
            let bound = [
                (1, Bound::Buffer(&numbers)),
                (2, Bound::Texture(source)),
                (3, Bound::Texture(variances.view())),
            ];
            self.blurs.push(over_charts(self.gpu, pipeline, self.charts(), &bound, &[target], false));
        }
        self.light = target;
    }

    /// Variances along an axis; the stretch is blurred by them.
    fn lay_taps(&mut self, widening: blur::Widening, axis: u32) -> Map {
        let size = self.charts().size;
        let variances = Map::square(self.gpu, "variances", size, 1, PAIR);
        let stretch = self.next_stretch();
        let numbers = self.gpu.uniform("widening", &numbers(widening, axis));
        let bound = [
            (1, Bound::Buffer(&numbers)),
            (2, Bound::Texture(self.charts().map.view())),
            (3, Bound::Texture(self.stretch.view())),
            (4, Bound::Buffer(&self.pass.narrow)),
        ];
        let targets = [variances.view(), stretch.view()];
        self.taps.push(over_charts(self.gpu, &self.pass.taps, self.charts(), &bound, &targets, false));
        self.stretch = stretch;
        variances
    }
}

fn pair(gpu: &Gpu, size: u32) -> [Map; 2] {
    [(); 2].map(|()| Map::square(gpu, "stretch", size, 1, PAIR))
}

/// A map of `size` texels with as many layers as a level.
pub fn like_level(gpu: &Gpu, label: &str, size: u32, like: &Map) -> Map {
    Map::square(gpu, label, size, like.layers.len() as u32, Format::Rgba16Float)
}

fn numbers(widening: blur::Widening, axis: u32) -> Widening {
    Widening {
        from_mm2: widening.from_mm2,
        to_mm2: widening.to_mm2,
        saved_texel2: widening.saved_texel2,
        weights: TAPS.weights,
        unit_variance: TAPS.unit_variance,
        axis,
        ..Widening::zeroed()
    }
}
