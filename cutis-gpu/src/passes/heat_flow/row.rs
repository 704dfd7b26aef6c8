//! A row of polynomials: stage by stage from the light to the sums of every time.

use super::fields::{Fields, points};
use super::{HeatFlowPass, Stage, TOGETHER};
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
    part: f32,
    part_before: f32,
}

impl<'a> Row<'a> {
    /// From a map of light to the sums of every time.
    pub fn steps(&self, light: &View, sums: &[&View], steps: &mut Vec<Step>) {
        let most = self.fields.times.iter().map(Vec::len).max().unwrap_or(0);
        let turn = |k: usize| if k == 0 { light } else { self.fields.turns[k % 3].view() };
        for k in 0..most {
            let (now, before) = (turn(k), turn(k.saturating_sub(1)));
            // Before the first there is none: what is bound is taken no times.
            let bound_before = if k == 0 { Bound::Texels(before, 0) } else { Bound::Texture(before) };
            let added: Vec<Added> = (0..sums.len()).filter_map(|n| self.added(n, sums[n], k)).collect();
            let (first, others) = added.split_at(added.len().min(TOGETHER));
            let numbers = self.numbers(k, first);
            let links = [
                (4, Bound::Texture(self.fields.taken[0].view())),
                (5, Bound::Texture(self.fields.taken[1].view())),
            ];
            let nearest = Bound::Sampler(&self.pass.nearest);
            let polynomials = [(2, Bound::Texture(now)), (3, bound_before), (13, nearest)];
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
                steps.extend(self.exchange_at_edges(&numbers, [now, before, next]));
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

    /// What stage `k` adds to sum `n`: two polynomials at every second stage, and what is left at the last.
    fn added(&self, n: usize, level: &'a View, k: usize) -> Option<Added<'a>> {
        let time = &self.fields.times[n];
        let last = time.len() - 1;
        if k > last || (k.is_multiple_of(2) && k < last) {
            return None;
        }
        let part_before = if k.is_multiple_of(2) { 0.0 } else { time[k - 1] };
        // So that the last goes to the level: how many come after this one.
        let after = last / 2 - k / 2;
        let spare = &self.fields.spare.layers[n];
        let [from, to] = if after.is_multiple_of(2) { [spare, level] } else { [level, spare] };
        Some(Added { from, to, part: time[k], part_before })
    }

    fn numbers(&self, k: usize, sums: &[Added]) -> wgpu::Buffer {
        let (factor, part) = if k == 0 { (1.0, 0.0) } else { (2.0, 1.0) };
        let mut stage = Stage {
            factor,
            part,
            // Every second polynomial is added with the one before it: the first of them begins a sum.
            kept: if k < 2 { 0.0 } else { 1.0 },
            sums: sums.len() as u32,
            size: self.charts.size,
            seed: (k as u32).wrapping_mul(0xC2B2_AE3D),
            ..Stage::zeroed()
        };
        for (n, sum) in sums.iter().enumerate() {
            (stage.parts[n], stage.parts_before[n]) = (sum.part, sum.part_before);
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

/// What sums hold so far; a shader that is bound any is bound as many as it knows, and leaves those alone.
fn bound_sums<'a>(sums: &[Added<'a>]) -> Vec<(u32, Bound<'a>)> {
    let Some(last) = sums.last() else { return Vec::new() };
    let bound = |n: usize| sums.get(n).map_or(Bound::Texels(last.from, 0), |sum| Bound::Texture(sum.from));
    (0..TOGETHER).map(|n| (6 + n as u32, bound(n))).collect()
}

fn numbers(gpu: &Gpu, stage: Stage) -> wgpu::Buffer {
    gpu.uniform("stage", &stage)
}
