//! A plan on its way from step to step.

use super::{Along, DiffusionPass, Halved, PAIR, Widening};
use crate::Gpu;
use crate::map::{Map, View};
use crate::passes::levels::Levels;
use crate::passes::over_charts;
use crate::pipeline::{Bound, Pipeline};
use crate::scene::charts::ChartTexture;
use crate::step::Step;
use bytemuck::Zeroable;
use cutis_render::passes::blur;
use cutis_render::passes::tap::TAPS;
use wgpu::TextureFormat as Format;

/// Where a plan has got to.
pub struct Way<'a> {
    pass: &'a DiffusionPass,
    gpu: &'a Gpu,
    charts: &'a [ChartTexture],
    levels: &'a Levels,
    halvings: usize,
    /// Number of the level that was kept last.
    pub level: usize,
    light: Map,
    stretch: Map,
    /// Where blurred stretch goes in turn.
    stretches: [Map; 2],
    /// Light blurred along u only.
    half_way: Map,
    /// Lays the taps.
    pub taps: Vec<Step>,
    /// Blurs the light.
    pub blurs: Vec<Step>,
}

impl<'a> Way<'a> {
    /// Before the first action.
    pub fn new(
        pass: &'a DiffusionPass,
        gpu: &'a Gpu,
        charts: &'a [ChartTexture],
        levels: &'a Levels,
        (stretch, half_way): (&Map, &Map),
    ) -> Self {
        let mut way = Self {
            half_way: half_way.clone(),
            light: levels.all[0].light.clone(),
            stretches: pair(gpu, charts[1].size),
            levels,
            level: 0,
            stretch: stretch.clone(),
            taps: Vec::new(),
            blurs: Vec::new(),
            halvings: 0,
            pass,
            gpu,
            charts,
        };
        way.halve_stretch([0, 1], 1.0);
        way
    }

    fn charts(&self) -> &'a ChartTexture {
        &self.charts[self.halvings]
    }

    /// Stretch, and what follows from it, change slowly: they have half the size of the light.
    fn half_charts(&self) -> &'a ChartTexture {
        &self.charts[self.halvings + 1]
    }

    /// Moves everything on to half the size.
    pub fn halve(&mut self) {
        self.halvings += 1;
        let size = self.charts().size;
        self.half_way = like_level(self.gpu, "blurred light", size, &self.light);
        let light = like_level(self.gpu, "halved light", size, &self.light);
        let charts = [self.halvings - 1, self.halvings].map(|h| &self.charts[h]);
        for (layer, target) in (0..).zip(&light.layers) {
            let halved = Halved { layer, factor: 1.0, ..Halved::zeroed() };
            self.blurs.push(self.halved(&self.pass.halve_light, charts, halved, &self.light, target));
        }
        self.light = light;
        self.stretches = pair(self.gpu, self.half_charts().size);
        self.halve_stretch([self.halvings, self.halvings + 1], 2.0);
    }

    /// From charts of one size to those of the next; `factor` texels of before are one now.
    fn halve_stretch(&mut self, sizes: [usize; 2], factor: f32) {
        let stretch = self.next_stretch();
        let halved = Halved { factor, ..Halved::zeroed() };
        let charts = sizes.map(|halvings| &self.charts[halvings]);
        let pipeline = &self.pass.halve_stretch;
        self.taps.push(self.halved(pipeline, charts, halved, &self.stretch, stretch.view()));
        self.stretch = stretch;
    }

    /// The map that does not hold the stretch now.
    fn next_stretch(&mut self) -> Map {
        self.stretches.swap(0, 1);
        self.stretches[0].clone()
    }

    fn halved(
        &self,
        pipeline: &Pipeline,
        [fine, coarse]: [&ChartTexture; 2],
        halved: Halved,
        source: &Map,
        target: &View,
    ) -> Step {
        let numbers = self.gpu.uniform("halved", &halved);
        let bound = [
            (1, Bound::Buffer(&numbers)),
            (2, Bound::Texture(fine.map.view())),
            (3, Bound::Texture(coarse.map.view())),
            (4, Bound::Texture(&source.array)),
        ];
        over_charts(self.gpu, pipeline, coarse, &bound, &[target], false)
    }

    /// Blurs along u, then along v into the next level.
    pub fn step(&mut self, widening: blur::Widening) {
        self.blur(widening, 0, self.half_way.clone());
        self.blur(widening, 1, self.levels.all[self.level + 1].light.clone());
    }

    fn blur(&mut self, widening: blur::Widening, axis: u32, target: Map) {
        let variances = self.lay_taps(widening, axis);
        let step_texels = if axis == 0 { [1.0, 0.0] } else { [0.0, 1.0] };
        let numbers = self.gpu.uniform("along", &Along { step_texels, axis, ..Along::zeroed() });
        for (source, target) in self.light.layers.iter().zip(&target.layers) {
            let bound = [
                (1, Bound::Buffer(&numbers)),
                (2, Bound::Texture(source)),
                (3, Bound::Texture(variances.view())),
                (4, Bound::Texture(self.charts().map.view())),
                (5, Bound::Sampler(&self.pass.nearest)),
            ];
            self.blurs.push(over_charts(self.gpu, &self.pass.blur, self.charts(), &bound, &[target], false));
        }
        self.light = target;
    }

    /// Variances along an axis; the stretch is blurred by them.
    fn lay_taps(&mut self, widening: blur::Widening, axis: u32) -> Map {
        let charts = self.half_charts();
        let variances = Map::square(self.gpu, "variances", charts.size, 1, PAIR);
        let stretch = self.next_stretch();
        let numbers = self.gpu.uniform("widening", &numbers(widening, axis));
        let bound = [
            (1, Bound::Buffer(&numbers)),
            (2, Bound::Texture(charts.map.view())),
            (3, Bound::Texture(self.stretch.view())),
            (4, Bound::Buffer(&self.pass.narrow)),
        ];
        let targets = [variances.view(), stretch.view()];
        self.taps.push(over_charts(self.gpu, &self.pass.taps, charts, &bound, &targets, false));
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
