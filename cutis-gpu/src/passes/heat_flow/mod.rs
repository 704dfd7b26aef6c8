//! Heat flow on the unrolled surface: cutis-render's `heat_flow`, whose links it uploads.
//!
//! A stage is one draw over the tiles of the charts and one computation for the texels at their edges. Polynomials are kept in
//! five maps in turn, sums in the levels and a spare map in turn. Four polynomials are added to a sum at once. Nothing is blended:
//! 16 bits hold what is wanted only if every stage rounds without a bias.

mod fields;
mod row;

use crate::Gpu;
use crate::map::{Map, View};
use crate::passes::levels::Levels;
use crate::passes::{Samplers, over_charts};
use crate::pipeline::{Blueprint, Bound, ComputePipeline, Pipeline};
use crate::scene::charts::ChartTexture;
use crate::shaders;
use crate::step::Step;
use bytemuck::{Pod, Zeroable};
use cutis_render::passes::blur::Widening;
use cutis_render::passes::diffusion::Action;
use cutis_render::passes::heat_flow::HeatFlow;
use cutis_scene::Object;
use fields::Fields;
pub use fields::Link;
use row::Row;
use std::sync::{Mutex, PoisonError};
use wgpu::TextureFormat as Format;

/// Most sums that are drawn at once.
const TOGETHER: usize = 3;
/// Polynomials that are added to a sum at once.
const AT_ONCE: usize = 4;
const LIGHT: Format = Format::Rgba16Float;

/// Numbers of a stage; their twin has the same name.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Stage {
    /// What each sum takes of the polynomial that is known last, and of those before it; nothing of all, where there is no sum.
    pub parts: [[f32; AT_ONCE]; TOGETHER],
    /// The next polynomial: so many times x of this one, less one time less of the one before.
    pub factor: f32,
    /// What sums take of what they hold: 0 to begin with, then 1.
    pub kept: f32,
    /// Width and height of the map, texels.
    pub size: u32,
    /// Another one for every stage.
    pub seed: u32,
}

/// The pass's pipelines.
#[derive(Debug)]
pub struct HeatFlowPass {
    /// The next polynomial.
    exchange_alone: Pipeline,
    /// The next polynomial and so many sums.
    exchange: [Pipeline; TOGETHER],
    add_up: [Pipeline; TOGETHER],
    halve: Pipeline,
    edge_exchange: ComputePipeline,
    edge_halved: Pipeline,
    edge_kept: Pipeline,
    keep_padding: ComputePipeline,
    nearest: wgpu::Sampler,
}

/// How heat flows over one object on the device.
#[derive(Debug)]
pub struct GpuHeatFlow {
    flow: Mutex<HeatFlow>,
    levels: Vec<Fields>,
}

impl GpuHeatFlow {
    /// Uploads a flow, in the pose that it has.
    pub fn new(gpu: &Gpu, flow: HeatFlow) -> Self {
        let levels = flow.levels.iter().map(|level| Fields::new(gpu, level)).collect();
        Self { flow: Mutex::new(flow), levels }
    }

    /// Lets heat flow over the object in another pose, from the next frame on.
    pub fn set_pose(&self, gpu: &Gpu, object: &Object) {
        let mut flow = self.flow.lock().unwrap_or_else(PoisonError::into_inner);
        flow.set_pose(object);
        self.levels.iter().zip(&flow.levels).for_each(|(fields, level)| fields.write(gpu, level));
    }
}

/// The actions that make levels for a flow: see [`Levels::new`].
pub fn actions(flow: &HeatFlow) -> Vec<Action> {
    let widening = Widening { from_mm2: 0.0, to_mm2: 0.0, saved_texel2: 0.0 };
    let mut all = Vec::new();
    for (n, level) in flow.levels.iter().enumerate() {
        all.extend((n > 0).then_some(Action::Halve));
        all.extend(level.times.iter().flat_map(|_| [Action::Step(widening), Action::Keep]));
    }
    all
}

impl HeatFlowPass {
    /// Compiles them.
    pub fn new(gpu: &Gpu, samplers: &Samplers) -> Self {
        let blueprint = |source, entries, targets| Blueprint {
            name: "heat flow",
            source,
            entries,
            targets,
            additive: false,
            depth: false,
        };
        let over = |source, entry, targets: usize| {
            const ALL: [Format; TOGETHER + 1] = [LIGHT; TOGETHER + 1];
            Pipeline::new(gpu, &blueprint(source, ["cover_run", entry], &ALL[..targets]))
        };
        let points =
            |entry| Pipeline::of_points(gpu, &blueprint(shaders::HEAT_ROWS, [entry, "show_point"], &[LIGHT]));
        Self {
            exchange_alone: over(shaders::HEAT_FLOW, "exchange_alone", 1),
            exchange: std::array::from_fn(|n| over(shaders::HEAT_FLOW, "exchange", n + 2)),
            add_up: std::array::from_fn(|n| over(shaders::HEAT_FLOW, "add_up", n + 1)),
            halve: over(shaders::HEAT_HALVE, "halve_heat", 1),
            edge_exchange: ComputePipeline::new(gpu, "heat flow", shaders::HEAT_ROWS, "edge_exchange"),
            edge_halved: points("edge_halved"),
            edge_kept: points("edge_kept"),
            keep_padding: ComputePipeline::new(gpu, "heat flow", shaders::HEAT_ROWS, "keep_padding"),
            nearest: samplers.nearest.clone(),
        }
    }

    /// The steps that fill all levels but the first, from that one. `charts` are those of the first size and of every halved one;
    /// the levels were made for [`actions`].
    pub fn steps(
        &self,
        gpu: &Gpu,
        charts: &[ChartTexture],
        levels: &Levels,
        flow: &GpuHeatFlow,
    ) -> Vec<Step> {
        let mut steps = Vec::new();
        let mut light = levels.all[0].light.clone();
        let mut first = 1;
        let mut finer: Option<&Fields> = None;
        for (fields, charts) in flow.levels.iter().zip(charts) {
            if let (Some(rows), Some(finer)) = (&fields.halved, finer) {
                let halved = Map::square(gpu, "halved light", charts.size, light.layers.len() as u32, LIGHT);
                for (fine, coarse) in light.layers.iter().zip(&halved.layers) {
                    let bound = [(1, Bound::Texture(fine)), (2, Bound::Texture(finer.paces.view()))];
                    steps.push(over_charts(gpu, &self.halve, charts, &bound, &[coarse], false));
                    let stage = gpu.uniform("stage", &Stage { size: charts.size, ..Stage::zeroed() });
                    let fine = Bound::Texels(fine, u64::from(rows.link_count));
                    let bound = [(1, Bound::Buffer(&stage)), (2, fine)];
                    steps.extend(rows.draw(gpu, &self.edge_halved, &bound, coarse));
                }
                light = halved;
            }
            let ends = first + fields.times.len();
            let row = Row { pass: self, gpu, charts, fields };
            for layer in 0..light.layers.len() {
                let sums: Vec<&View> =
                    levels.all[first..ends].iter().map(|level| &level.light.layers[layer]).collect();
                row.steps(&light.layers[layer], &sums, &mut steps);
            }
            first = ends;
            finer = Some(fields);
        }
        steps
    }
}
