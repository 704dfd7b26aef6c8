//! Heat flow on the unrolled surface: cutis-render's `heat_flow`, whose links it uploads.
//!
//! A stage is one draw over the tiles of the charts, without branches, and one of points at their edges. Polynomials are kept in
//! three maps in turn, sums in the levels and a spare map in turn. Two polynomials are added to a sum at once. Nothing is blended:
//! 16 bits hold what is wanted only if every stage rounds to the nearest.

use crate::Gpu;
use crate::map::{Map, View};
use crate::passes::levels::Levels;
use crate::passes::{Samplers, over_charts};
use crate::pipeline::{Blueprint, Bound, ComputePipeline, Pipeline};
use crate::scene::charts::ChartTexture;
use crate::shaders;
use crate::step::{Dispatch, Draw, Step};
use bytemuck::{Pod, Zeroable};
use cutis_render::passes::blur::Widening;
use cutis_render::passes::diffusion::Action;
use cutis_render::passes::heat_flow::exchange::Rows;
use cutis_render::passes::heat_flow::{HeatFlow, Level};
use glam::Vec4;
use half::f16;
use wgpu::TextureFormat as Format;

/// Most sums that are drawn at once.
const TOGETHER: usize = 3;
/// Largest pace: 16 bits hold no more.
const FASTEST_PACE: f32 = 6e4;
const LIGHT: Format = Format::Rgba16Float;

/// Numbers of a stage; their twin has the same name.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Stage {
    /// What sums take of the polynomial that is known last, …
    pub parts: [f32; 4],
    /// … of the one before, …
    pub parts_before: [f32; 4],
    /// … and of what they hold: 0 to begin with, then 1.
    pub kept: [f32; 4],
    /// The next polynomial: so many times x of this one …
    pub factor: f32,
    /// … less so much of the one before.
    pub part: f32,
    /// Width and height of the map, texels.
    pub size: u32,
    /// Another one for every stage.
    pub seed: u32,
}

/// A link of a row; its twin has the same name.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Link {
    /// Texel at the other end.
    pub texel: u32,
    /// Its strength.
    pub strength: f32,
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
    edge_exchange: Pipeline,
    edge_halved: Pipeline,
    edge_kept: Pipeline,
    keep_padding: ComputePipeline,
    nearest: wgpu::Sampler,
}

/// A sparse matrix on the device.
#[derive(Debug)]
struct GpuRows {
    rows: wgpu::Buffer,
    links: wgpu::Buffer,
    count: u32,
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
            edge_exchange: points("edge_exchange"),
            edge_halved: points("edge_halved"),
            edge_kept: points("edge_kept"),
            keep_padding: ComputePipeline::new(gpu, "heat flow", shaders::HEAT_ROWS, "keep_padding"),
            nearest: samplers.nearest.clone(),
        }
    }

    /// The steps that fill all levels but the first, from that one. `charts` are those of the first size and of every halved one;
    /// the levels were made for [`actions`].
    pub fn steps(&self, gpu: &Gpu, charts: &[ChartTexture], levels: &Levels, flow: &HeatFlow) -> Vec<Step> {
        let mut steps = Vec::new();
        let mut light = levels.all[0].light.clone();
        let mut first = 1;
        let mut finer: Option<Map> = None;
        for (level, charts) in flow.levels.iter().zip(charts) {
            let fields = Fields::new(gpu, level);
            if let (Some(halving), Some(paces)) = (&level.halving, &finer) {
                let rows = GpuRows::new(gpu, &halving.rows());
                let halved = Map::square(gpu, "halved light", charts.size, light.layers.len() as u32, LIGHT);
                for (fine, coarse) in light.layers.iter().zip(&halved.layers) {
                    let bound = [(1, Bound::Texture(fine)), (2, Bound::Texture(paces.view()))];
                    steps.push(over_charts(gpu, &self.halve, charts, &bound, &[coarse], false));
                    let stage = numbers(gpu, Stage { size: charts.size, ..Stage::zeroed() });
                    let bound = [(1, Bound::Buffer(&stage)), (2, Bound::Texture(fine))];
                    steps.extend(rows.draw(gpu, &self.edge_halved, &bound, coarse));
                }
                light = halved;
            }
            let ends = first + level.times.len();
            let row = Row { pass: self, gpu, charts, level, fields: &fields };
            for layer in 0..light.layers.len() {
                let sums: Vec<&View> =
                    levels.all[first..ends].iter().map(|level| &level.light.layers[layer]).collect();
                row.steps(&light.layers[layer], &sums, &mut steps);
            }
            first = ends;
            finer = Some(fields.paces);
        }
        steps
    }
}

/// What a level needs on the device.
struct Fields {
    /// What of each neighbour's difference a texel takes at once: from the east on, and from the west on.
    taken: [Map; 2],
    paces: Map,
    edges: GpuRows,
    padding: GpuRows,
    kept: wgpu::Buffer,
    /// Polynomials, in turn.
    turns: [Map; 3],
    /// Where sums are in turn with their level.
    spare: Map,
}

impl Fields {
    fn new(gpu: &Gpu, level: &Level) -> Self {
        let exchange = &level.exchange;
        let size = exchange.size as u32;
        let taken = taken(level);
        let speed = 2.0 / exchange.fastest_rate;
        let paces =
            exchange.per_area.iter().map(|per_area| f16::from_f32((per_area * speed).min(FASTEST_PACE)));
        let bytes: Vec<u8> = paces.flat_map(|pace| pace.to_bits().to_le_bytes()).collect();
        let entries =
            level.padding.iter().flat_map(|(texel, read)| read.iter().map(move |&(t, w)| (*texel, t, w)));
        let padding = GpuRows::new(gpu, &Rows::new(entries.collect()));
        Self {
            taken: [0, 1]
                .map(|side| Map::of_values(gpu, "taken", [size, size], taken.iter().map(move |t| t[side]))),
            paces: Map::filled(gpu, "paces", [size, size], Format::R16Float, &bytes),
            edges: GpuRows::new(gpu, &taken_further(level)),
            kept: gpu.storage("padding", &vec![Vec4::ZERO; padding.count as usize]),
            padding,
            turns: std::array::from_fn(|_| Map::square(gpu, "polynomial", size, 1, LIGHT)),
            spare: Map::square(gpu, "sums", size, level.times.len().max(1) as u32, LIGHT),
        }
    }
}

/// What of the differences of its eight neighbours every texel takes at once, counter-clockwise: from the east, and from the west
/// on.
fn taken(level: &Level) -> Vec<[Vec4; 2]> {
    let exchange = &level.exchange;
    let size = exchange.size;
    let speed = 2.0 / exchange.fastest_rate;
    // Inner squares link no texel along the edges of the map.
    let of = |i: usize| {
        if i <= size || i + size + 1 >= exchange.links.len() {
            return [Vec4::ZERO; 2];
        }
        let links = |i: usize| exchange.links[i];
        let [e, n, ne, nw] = links(i);
        let east = Vec4::new(e, ne, n, nw);
        let west =
            Vec4::new(links(i - 1)[0], links(i - size - 1)[2], links(i - size)[1], links(i - size + 1)[3]);
        [east, west].map(|links| links * exchange.per_area[i] * speed)
    };
    (0..exchange.links.len()).map(of).collect()
}

/// The same from further away.
fn taken_further(level: &Level) -> Rows {
    let exchange = &level.exchange;
    let speed = 2.0 / exchange.fastest_rate;
    let mut rows = exchange.rows.clone();
    for (&texel, ends) in rows.texels.iter().zip(exchange.rows.starts.windows(2)) {
        let links = &mut rows.links[ends[0] as usize..ends[1] as usize];
        links.iter_mut().for_each(|(_, link)| *link *= exchange.per_area[texel as usize] * speed);
    }
    rows
}

/// A row of polynomials.
struct Row<'a> {
    pass: &'a HeatFlowPass,
    gpu: &'a Gpu,
    charts: &'a ChartTexture,
    level: &'a Level,
    fields: &'a Fields,
}

/// What a stage adds to a sum.
struct Added<'a> {
    /// Where the sum is, and where it goes.
    from: &'a View,
    to: &'a View,
    part: f32,
    part_before: f32,
    kept: f32,
}

impl<'a> Row<'a> {
    /// From a map of light to the sums of every time.
    fn steps(&self, light: &View, sums: &[&View], steps: &mut Vec<Step>) {
        let most = self.level.times.iter().map(Vec::len).max().unwrap_or(0);
        let turn = |k: usize| if k == 0 { light } else { self.fields.turns[k % 3].view() };
        for k in 0..most {
            // Before the first there is none: what is bound counts nothing.
            let (now, before) = (turn(k), turn(k.saturating_sub(1)));
            let added: Vec<Added> = (0..sums.len()).filter_map(|n| self.added(n, sums[n], k)).collect();
            let (first, others) = added.split_at(added.len().min(TOGETHER));
            let numbers = self.numbers(k, first);
            let links = [
                (4, Bound::Texture(self.fields.taken[0].view())),
                (5, Bound::Texture(self.fields.taken[1].view())),
            ];
            let nearest = Bound::Sampler(&self.pass.nearest);
            let polynomials = [(2, Bound::Texture(now)), (3, Bound::Texture(before)), (13, nearest)];
            let bound = [&[(1, Bound::Buffer(&numbers))], &polynomials[..], &links[..]].concat();
            if k + 1 < most {
                let next = turn(k + 1);
                let targets: Vec<&View> = [next].into_iter().chain(first.iter().map(|a| a.to)).collect();
                let pipeline = match first.len() {
                    0 => &self.pass.exchange_alone,
                    n => &self.pass.exchange[n - 1],
                };
                let all = [&bound[..], &bound_sums(first)].concat();
                steps.push(over_charts(self.gpu, pipeline, self.charts, &all, &targets, false));
                steps.extend(self.fields.edges.draw(self.gpu, &self.pass.edge_exchange, &bound, next));
            }
            let alone = if k + 1 < most { others } else { &added[..] };
            for sums in alone.chunks(TOGETHER) {
                let numbers = self.numbers(k, sums);
                let all = [&[(1, Bound::Buffer(&numbers))], &polynomials[..], &bound_sums(sums)].concat();
                let targets: Vec<&View> = sums.iter().map(|a| a.to).collect();
                let pipeline = &self.pass.add_up[sums.len() - 1];
                steps.push(over_charts(self.gpu, pipeline, self.charts, &all, &targets, false));
            }
        }
        sums.iter().for_each(|sum| self.fill_padding(sum, steps));
    }

    /// What stage `k` adds to sum `n`: two polynomials at every second stage, and what is left at the last.
    fn added(&self, n: usize, level: &'a View, k: usize) -> Option<Added<'a>> {
        let time = &self.level.times[n];
        let last = time.len() - 1;
        if k > last || (k.is_multiple_of(2) && k < last) {
            return None;
        }
        let part_before = if k.is_multiple_of(2) { 0.0 } else { time[k - 1] };
        // So that the last goes to the level: how many come after this one.
        let after = last / 2 - k / 2;
        let spare = &self.fields.spare.layers[n];
        let [from, to] = if after.is_multiple_of(2) { [spare, level] } else { [level, spare] };
        let kept = if k < 2 { 0.0 } else { 1.0 };
        Some(Added { from, to, part: time[k], part_before, kept })
    }

    fn numbers(&self, k: usize, sums: &[Added]) -> wgpu::Buffer {
        let (factor, part) = if k == 0 { (1.0, 0.0) } else { (2.0, 1.0) };
        let mut stage = Stage {
            factor,
            part,
            size: self.charts.size,
            seed: (k as u32).wrapping_mul(0xC2B2_AE3D),
            ..Stage::zeroed()
        };
        for (n, sum) in sums.iter().enumerate() {
            (stage.parts[n], stage.parts_before[n], stage.kept[n]) = (sum.part, sum.part_before, sum.kept);
        }
        numbers(self.gpu, stage)
    }

    /// What is beyond the edges of charts is what is across the seam, for those who read there.
    fn fill_padding(&self, map: &View, steps: &mut Vec<Step>) {
        let Fields { padding, kept, .. } = self.fields;
        let numbers = numbers(self.gpu, Stage { size: self.charts.size, ..Stage::zeroed() });
        if padding.count == 0 {
            return;
        }
        let bound = [
            (1, Bound::Buffer(&numbers)),
            (2, Bound::Texture(map)),
            (9, Bound::Buffer(&padding.rows)),
            (10, Bound::Buffer(&padding.links)),
            (12, Bound::Buffer(kept)),
        ];
        let pipeline = &self.pass.keep_padding;
        steps.push(Step::Compute(Dispatch {
            pipeline: pipeline.clone(),
            bind_group: pipeline.bind(self.gpu, &bound),
            groups: padding.count.div_ceil(64),
        }));
        let bound =
            [(1, Bound::Buffer(&numbers)), (9, Bound::Buffer(&padding.rows)), (11, Bound::Buffer(kept))];
        steps.push(points(self.gpu, &self.pass.edge_kept, &bound, map, padding.count));
    }
}

impl GpuRows {
    fn new(gpu: &Gpu, rows: &Rows) -> Self {
        let last = rows.starts.last().copied().unwrap_or(0);
        let pairs = rows.texels.iter().zip(&rows.starts).map(|(&texel, &start)| [texel, start]);
        let pairs: Vec<[u32; 2]> = pairs.chain([[0, last]]).collect();
        let links: Vec<Link> = rows.links.iter().map(|&(texel, strength)| Link { texel, strength }).collect();
        Self {
            rows: gpu.storage("rows", &pairs),
            links: gpu.storage("links", &links),
            count: rows.texels.len() as u32,
        }
    }

    /// A point for every row.
    fn draw(&self, gpu: &Gpu, pipeline: &Pipeline, bound: &[(u32, Bound)], target: &View) -> Option<Step> {
        let mut all = bound.to_vec();
        all.extend([(9, Bound::Buffer(&self.rows)), (10, Bound::Buffer(&self.links))]);
        (self.count > 0).then(|| points(gpu, pipeline, &all, target, self.count))
    }
}

/// What sums hold so far; a shader that is bound any is bound as many as it knows.
fn bound_sums<'a>(sums: &[Added<'a>]) -> Vec<(u32, Bound<'a>)> {
    let Some(last) = sums.last() else { return Vec::new() };
    let from = |n: usize| sums.get(n).unwrap_or(last).from;
    (0..TOGETHER).map(|n| (6 + n as u32, Bound::Texture(from(n)))).collect()
}

fn points(gpu: &Gpu, pipeline: &Pipeline, bound: &[(u32, Bound)], target: &View, count: u32) -> Step {
    Step::Draw(Draw {
        pipeline: pipeline.clone(),
        bind_groups: vec![pipeline.bind(gpu, 0, bound)],
        targets: vec![target.clone()],
        depth: None,
        clear: None,
        indices: None,
        vertices: count,
        instances: 1,
    })
}

fn numbers(gpu: &Gpu, stage: Stage) -> wgpu::Buffer {
    gpu.uniform("stage", &stage)
}
