//! A row of polynomials: stage by stage from the light to the sums of every time.

use super::fields::{Fields, points};
use super::{AT_ONCE, HeatFlowPass, Stage, TOGETHER};
use crate::Gpu;
use crate::map::View;
use crate::passes::over_charts;
use crate::pipeline::Bound;
use crate::scene::charts::ChartTexture;
use crate::step::{Dispatch, Step};
use bytemuck::Zeroable;

/// A row of polynomials.
pub struct Row<'a> {
    /// Its pipelines.
    pub pass: &'a HeatFlowPass,
    /// The device.
    pub gpu: &'a Gpu,
    /// Charts of the level.
    pub charts: &'a ChartTexture,
    /// What the level needs on the device.
    pub fields: &'a Fields,
}

/// What a stage adds to a sum.
struct Added<'a> {
    /// Where the sum is, and where it goes.
    from: &'a View,
    to: &'a View,
    /// What it takes of the polynomial that is known last, and of those before it.
    parts: [f32; AT_ONCE],
    /// Whether there is something in it.
    begun: bool,
}

impl<'a> Row<'a> {
    /// From a map of light to the sums of every time.
    pub fn steps(&self, light: &View, sums: &[&View], steps: &mut Vec<Step>) {
        let most = self.fields.times.iter().map(Vec::len).max().unwrap_or(0);
        let turn = |k: usize| if k == 0 { light } else { self.fields.turns[k % (AT_ONCE + 1)].view() };
        for k in 0..most {
            // Before the first there is none: what is bound is taken no times.
            let before =
                |n: usize| if k >= n { Bound::Texture(turn(k - n)) } else { Bound::Texels(light, 0) };
            let added: Vec<Added> = (0..sums.len()).filter_map(|n| self.added(n, sums[n], k)).collect();
            // What begins reads nothing: it is drawn apart from what goes on.
            let (begun, begins): (Vec<Added>, Vec<Added>) = added.into_iter().partition(|sum| sum.begun);
            let mut groups: Vec<&[Added]> = begun.chunks(TOGETHER).chain(begins.chunks(TOGETHER)).collect();
            let nearest = (13, Bound::Sampler(&self.pass.nearest));
            let last_two = [(2, before(0)), (3, before(1)), nearest];
            if k + 1 < most {
                let with_it = if groups.is_empty() { &[] } else { groups.remove(0) };
                self.exchange(k, with_it, (&last_two, [before(2), before(3)]), turn(k + 1), steps);
                let numbers = self.numbers(k, &[]);
                let before = if k == 0 { light } else { turn(k - 1) };
                steps.extend(self.exchange_at_edges(&numbers, [turn(k), before, turn(k + 1)]));
            }
            for sums in groups {
                let numbers = self.numbers(k, sums);
                let all = [&[(1, Bound::Buffer(&numbers))], &last_two[..]].concat();
                let all = [all, bound_sums(sums, [before(2), before(3)])].concat();
                let targets: Vec<&View> = sums.iter().map(|a| a.to).collect();
                let pipeline = &self.pass.add_up[sums.len() - 1];
                steps.push(over_charts(self.gpu, pipeline, self.charts, &all, &targets, false));
            }
        }
        sums.iter().for_each(|sum| self.fill_padding(sum, steps));
    }

    /// The next polynomial, and some sums with those that are known.
    fn exchange(
        &self,
        k: usize,
        sums: &[Added],
        (last_two, earlier): (&[(u32, Bound)], [Bound; 2]),
        next: &View,
        steps: &mut Vec<Step>,
    ) {
        let numbers = self.numbers(k, sums);
        let [east, west] = self.fields.taken.each_ref().map(|map| Bound::Texture(map.view()));
        let bound = [&[(1, Bound::Buffer(&numbers)), (4, east), (5, west)], last_two].concat();
        let targets: Vec<&View> = [next].into_iter().chain(sums.iter().map(|a| a.to)).collect();
        let pipeline = match sums.len() {
            0 => &self.pass.exchange_alone,
            n => &self.pass.exchange[n - 1],
        };
        let all = [bound, bound_sums(sums, earlier)].concat();
        steps.push(over_charts(self.gpu, pipeline, self.charts, &all, &targets, false));
    }

    /// The next polynomial of texels at the edges of charts, from the last two.
    fn exchange_at_edges(&self, numbers: &wgpu::Buffer, [now, before, next]: [&View; 3]) -> Option<Step> {
        let Fields { edges, taken, .. } = self.fields;
        let (own, all) = (u64::from(edges.count), u64::from(edges.link_count));
        let bound = [
            (1, Bound::Buffer(numbers)),
            (2, Bound::Texels(now, all)),
            (3, Bound::Texels(before, own)),
            (4, Bound::Texels(taken[0].view(), own)),
            (5, Bound::Texels(taken[1].view(), own)),
            (9, Bound::Buffer(&edges.rows)),
            (10, Bound::Buffer(&edges.links)),
            (13, Bound::Sampler(&self.pass.nearest)),
            (14, Bound::Texels(next, own)),
        ];
        let pipeline = &self.pass.edge_exchange;
        (edges.count > 0).then(|| {
            Step::Compute(Dispatch {
                pipeline: pipeline.clone(),
                bind_group: pipeline.bind(self.gpu, &bound),
                groups: edges.count.div_ceil(64),
            })
        })
    }

    /// What stage `k` adds to sum `n`: four polynomials at every fourth stage, and what is left at the last.
    fn added(&self, n: usize, level: &'a View, k: usize) -> Option<Added<'a>> {
        let time = &self.fields.times[n];
        let last = time.len() - 1;
        let (round, place) = (k / AT_ONCE, k % AT_ONCE);
        if k > last || (place + 1 < AT_ONCE && k < last) {
            return None;
        }
        // So that the last goes to the level: how many come after this one.
        let after = last / AT_ONCE - round;
        let spare = &self.fields.spare.layers[n];
        let [from, to] = if after.is_multiple_of(2) { [spare, level] } else { [level, spare] };
        let mut parts = std::array::from_fn(|back| if back <= place { time[k - back] } else { 0.0 });
        // A sum that takes nothing is none: where all coefficients are 0, it takes next to nothing.
        parts[0] = if parts == [0.0; AT_ONCE] { f32::MIN_POSITIVE } else { parts[0] };
        Some(Added { from, to, parts, begun: round > 0 })
    }

    fn numbers(&self, k: usize, sums: &[Added]) -> wgpu::Buffer {
        let mut stage = Stage {
            // T_1 = x T_0, and after that T_{k+1} = 2 x T_k - T_{k-1}.
            factor: if k == 0 { 1.0 } else { 2.0 },
            kept: if sums.iter().any(|sum| sum.begun) { 1.0 } else { 0.0 },
            size: self.charts.size,
            seed: (k as u32).wrapping_mul(0xC2B2_AE3D),
            ..Stage::zeroed()
        };
        stage.parts.iter_mut().zip(sums).for_each(|(parts, sum)| *parts = sum.parts);
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
            (2, Bound::Texels(map, u64::from(padding.link_count))),
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

/// What sums hold so far, and the polynomials that they take from besides the last two. A shader that is bound any is bound as
/// many as it knows, and leaves those alone that it has no use for.
fn bound_sums<'a>(sums: &[Added<'a>], earlier: [Bound<'a>; 2]) -> Vec<(u32, Bound<'a>)> {
    let Some(last) = sums.last() else { return Vec::new() };
    let bound = |n: usize| match sums.get(n) {
        Some(sum) if sum.begun => Bound::Texture(sum.from),
        _ => Bound::Texels(last.from, 0),
    };
    let taken = |back: usize| sums.iter().any(|sum| sum.parts[back] != 0.0);
    let idle = Bound::Texels(last.from, 0);
    let earlier = [(11, 2), (12, 3)]
        .into_iter()
        .zip(earlier)
        .map(|((binding, back), bound)| (binding, if taken(back) { bound } else { idle }));
    (0..TOGETHER).map(|n| (6 + n as u32, bound(n))).chain(earlier).collect()
}

fn numbers(gpu: &Gpu, stage: Stage) -> wgpu::Buffer {
    gpu.uniform("stage", &stage)
}
