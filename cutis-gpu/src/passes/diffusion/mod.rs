//! Diffusion of light over the unrolled surface, by the plan of cutis-render's `diffusion`: seven-tap blurs along u and v,
//! each Gaussian from the one before, wide ones in smaller textures.

mod way;

use crate::Gpu;
use crate::map::Map;
use crate::passes::Samplers;
use crate::passes::levels::Levels;
use crate::pipeline::{Blueprint, Pipeline};
use crate::scene::charts::ChartTexture;
use crate::shaders;
use crate::step::Step;
use bytemuck::{Pod, Zeroable};
use cutis_render::passes::blur;
use cutis_render::passes::diffusion::Action;
use cutis_render::passes::tap::TAPS;
use way::Way;
pub use way::like_level;
use wgpu::TextureFormat as Format;

/// Format of stretch and of variances: two numbers a texel.
const PAIR: Format = Format::Rg16Float;

/// Variance in texel² up to which light stays in its texel: half as much of it, 2 %, would reach each neighbour.
const STAYS_TEXEL2: f32 = 0.04;

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
    pub step_texels: [f32; 2],
    /// 0 along u, 1 along v.
    pub axis: u32,
    /// Fills up the struct.
    pub pad0: u32,
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
    blur: Pipeline,
    halve_light: Pipeline,
    halve_stretch: Pipeline,
    narrow: wgpu::Buffer,
    nearest: wgpu::Sampler,
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
    pub fn new(gpu: &Gpu, samplers: &Samplers) -> Self {
        let pipeline = |name, source, entry, targets: &[Format]| {
            let entries = ["cover_run", entry];
            Pipeline::new(gpu, &Blueprint { name, source, entries, targets, additive: false, depth: false })
        };
        let light = &[Format::Rgba16Float];
        Self {
            taps: pipeline("taps", shaders::TAPS, "lay_taps", &[PAIR, PAIR]),
            blur: pipeline("blur", shaders::BLUR, "blur", light),
            halve_light: pipeline("blur", shaders::HALVE, "halve", light),
            halve_stretch: pipeline("taps", shaders::HALVE, "halve", &[PAIR]),
            narrow: gpu.storage("discrete variances", &TAPS.narrow),
            nearest: samplers.nearest.clone(),
        }
    }

    /// The steps that fill all levels but the first, from that one. `charts` are those of the first size, of every halved one
    /// and of one more; `actions` those that the levels were made for. What `half_way` holds, as many layers as a level has, is lost.
    pub fn steps(
        &self,
        gpu: &Gpu,
        charts: &[ChartTexture],
        levels: &Levels,
        (stretch, half_way): (&Map, &Map),
        actions: &[Action],
    ) -> Diffusion {
        let mut way = Way::new(self, gpu, charts, levels, (stretch, half_way));
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
