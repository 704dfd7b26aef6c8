//! Diffusion of light over the unrolled surface, by the plan of cutis-render's `diffusion`: seven-tap blurs along u and v,
//! each Gaussian from the one before, wide ones in smaller textures.

use crate::Gpu;
use crate::map::Map;
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

/// Format of blurred stretch.
const STRETCH: Format = Format::Rg16Float;

/// How one step widens one layer; the twin of `Widening` in `blur.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Widening {
    /// Variance before the step, mm².
    pub from_mm2: f32,
    /// Variance after it, mm².
    pub to_mm2: f32,
    /// Variance in texel² that other means have added or will add.
    pub saved_texel2: f32,
    /// Deviation in texels at the end of the table of spacings.
    pub max_deviation: f32,
    /// Weight of the centre and of one tap at each distance.
    pub weights: [f32; 4],
    /// Variance of the weights at spacing 1, texel².
    pub unit_variance: f32,
    /// 0 along u, 1 along v.
    pub axis: u32,
    /// Layer of the light.
    pub layer: u32,
    /// Fills up the struct.
    pub pad0: u32,
}

/// Which layer is halved; the twin of `Halved` in `halve.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Halved {
    /// Layer of the light.
    pub layer: u32,
    /// Fills up the struct.
    pub pad0: u32,
    /// Fills up the struct.
    pub pad1: u32,
    /// Fills up the struct.
    pub pad2: u32,
}

/// The light before any blur and after every Gaussian.
#[derive(Debug)]
pub struct Levels {
    /// Level 0 is unblurred; level i is blurred by the i-th variance.
    pub all: Vec<Level>,
}

/// One blurred state of all layers.
#[derive(Debug, Clone)]
pub struct Level {
    /// Charts at this level's size.
    pub charts: ChartTexture,
    /// Irradiance with distance in alpha; with several lights, their distances in further layers.
    pub light: Map,
}

impl Levels {
    /// The nearest level before this one that is larger; the first if there is none.
    pub fn finer_than(&self, level: usize) -> &Level {
        let size = self.all[level].charts.size;
        self.all[..level].iter().rev().find(|l| l.charts.size > size).unwrap_or(&self.all[0])
    }
}

/// The pass's pipelines.
#[derive(Debug)]
pub struct DiffusionPass {
    blur: Pipeline,
    blur_layer: Pipeline,
    halve: Pipeline,
    halve_layer: Pipeline,
    tables: wgpu::Buffer,
}

impl DiffusionPass {
    /// Compiles them.
    pub fn new(gpu: &Gpu) -> Self {
        let pipeline = |source, entry, targets: &[Format]| {
            let entries = ["cover_run", entry];
            Pipeline::new(gpu, &Blueprint { name: "blur", source, entries, targets, additive: false, depth: false })
        };
        let both = &[Format::Rgba16Float, STRETCH];
        let light = &[Format::Rgba16Float];
        let mut tables = TAPS.spacing.clone();
        tables.extend(&TAPS.narrow);
        tables.extend(TAPS.cells.as_flattened());
        Self {
            blur: pipeline(shaders::BLUR, "blur", both),
            blur_layer: pipeline(shaders::BLUR, "blur_layer", light),
            halve: pipeline(shaders::HALVE, "halve", both),
            halve_layer: pipeline(shaders::HALVE, "halve_layer", light),
            tables: gpu.storage("taps", &tables),
        }
    }

    /// The steps of a plan, and the levels they fill. `charts` are those of the first level and of every halved one.
    pub fn steps(
        &self,
        gpu: &Gpu,
        charts: &[ChartTexture],
        light: &Map,
        stretch: &Map,
        plan: &[Action],
    ) -> (Vec<Step>, Levels) {
        let mut way = Way::new(self, gpu, charts, light, stretch);
        for (i, action) in plan.iter().enumerate() {
            match *action {
                Action::Halve => way.halve(),
                Action::Step(widening) => way.step(widening, plan.get(i + 1) == Some(&Action::Keep)),
                Action::Keep => way.levels.push(way.level()),
            }
        }
        (way.steps, Levels { all: way.levels })
    }
}

/// Where a plan has got to.
struct Way<'a> {
    pass: &'a DiffusionPass,
    gpu: &'a Gpu,
    charts: &'a [ChartTexture],
    halvings: usize,
    light: Map,
    stretch: Map,
    rooms: Rooms,
    steps: Vec<Step>,
    levels: Vec<Level>,
}

/// Textures of one size that steps pass their results through.
struct Rooms {
    /// Blurred along u.
    half_way: (Map, Map),
    /// Blurred along both.
    done: (Map, Map),
}

impl Rooms {
    fn new(gpu: &Gpu, size: u32, layers: u32) -> Self {
        let room = || {
            (
                Map::square(gpu, "blurred light", size, layers, Format::Rgba16Float),
                Map::square(gpu, "blurred stretch", size, 1, STRETCH),
            )
        };
        Self { half_way: room(), done: room() }
    }
}

impl<'a> Way<'a> {
    fn new(pass: &'a DiffusionPass, gpu: &'a Gpu, charts: &'a [ChartTexture], light: &Map, stretch: &Map) -> Self {
        let rooms = Rooms::new(gpu, charts[0].size, light.layers.len() as u32);
        let levels = vec![Level { charts: charts[0].clone(), light: light.clone() }];
        let (light, stretch) = (light.clone(), stretch.clone());
        Self { pass, gpu, charts, halvings: 0, light, stretch, rooms, steps: Vec::new(), levels }
    }

    fn charts(&self) -> &'a ChartTexture {
        &self.charts[self.halvings]
    }

    fn level(&self) -> Level {
        Level { charts: self.charts().clone(), light: self.light.clone() }
    }

    fn halve(&mut self) {
        let fine = self.charts();
        self.halvings += 1;
        let layers = self.light.layers.len() as u32;
        self.rooms = Rooms::new(self.gpu, self.charts().size, layers);
        let (light, stretch) = self.rooms.done.clone();
        for layer in 0..layers {
            let numbers = self.gpu.uniform("halved", &Halved { layer, ..Halved::zeroed() });
            let bound = [
                (1, Bound::Buffer(&numbers)),
                (2, Bound::Texture(fine.map.view())),
                (3, Bound::Texture(self.charts().map.view())),
                (4, Bound::Texture(&self.light.array)),
                (5, Bound::Texture(self.stretch.view())),
            ];
            let [with_stretch, alone] = [&self.pass.halve, &self.pass.halve_layer];
            let step = self.draw([with_stretch, alone], &bound, layer, &light, &stretch);
            self.steps.push(step);
        }
        (self.light, self.stretch) = (light, stretch);
    }

    /// Blurs along u, then along v; into a map of its own if that is kept.
    fn step(&mut self, widening: blur::Widening, kept: bool) {
        let half_way = self.rooms.half_way.clone();
        self.blur(widening, 0, &half_way);
        (self.light, self.stretch) = half_way;
        let mut done = self.rooms.done.clone();
        if kept {
            let layers = self.light.layers.len() as u32;
            done.0 = Map::square(self.gpu, "level", self.charts().size, layers, Format::Rgba16Float);
        }
        self.blur(widening, 1, &done);
        (self.light, self.stretch) = done;
    }

    fn blur(&mut self, widening: blur::Widening, axis: u32, (light, stretch): &(Map, Map)) {
        for layer in 0..self.light.layers.len() as u32 {
            let numbers = self.gpu.uniform("widening", &numbers(widening, axis, layer));
            let bound = [
                (1, Bound::Buffer(&numbers)),
                (2, Bound::Texture(self.charts().map.view())),
                (3, Bound::Texture(&self.light.array)),
                (4, Bound::Texture(self.stretch.view())),
                (5, Bound::Buffer(&self.pass.tables)),
            ];
            let [with_stretch, alone] = [&self.pass.blur, &self.pass.blur_layer];
            let step = self.draw([with_stretch, alone], &bound, layer, light, stretch);
            self.steps.push(step);
        }
    }

    /// The stretch is drawn along with the first layer.
    fn draw(
        &self,
        [with_stretch, alone]: [&Pipeline; 2],
        bound: &[(u32, Bound)],
        layer: u32,
        light: &Map,
        stretch: &Map,
    ) -> Step {
        let target = &light.layers[layer as usize];
        let charts = &self.charts[self.halvings];
        if layer == 0 {
            over_charts(self.gpu, with_stretch, charts, bound, &[target, stretch.view()], false)
        } else {
            over_charts(self.gpu, alone, charts, bound, &[target], false)
        }
    }
}

fn numbers(widening: blur::Widening, axis: u32, layer: u32) -> Widening {
    Widening {
        from_mm2: widening.from_mm2,
        to_mm2: widening.to_mm2,
        saved_texel2: widening.saved_texel2,
        max_deviation: TAPS.max_deviation,
        weights: TAPS.weights,
        unit_variance: TAPS.unit_variance,
        axis,
        layer,
        pad0: 0,
    }
}
