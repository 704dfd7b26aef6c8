//! The blur of Green 2004: seven taps along u, then along v, so often. The twin of cutis-render's `seven_taps`.

use crate::Gpu;
use crate::map::Map;
use crate::passes::over_charts;
use crate::pipeline::{Blueprint, Bound, Pipeline};
use crate::scene::charts::{ChartPyramid, ChartTexture};
use crate::shaders;
use crate::step::Step;
use bytemuck::{Pod, Zeroable};
use cutis_render::passes::atlas::Atlas;
use cutis_render::passes::seven_taps::{OFFSETS_TEXELS, layers_due, weights};
use cutis_render::technique::texture_blur::TextureBlurSettings;
use cutis_scene::Object;
use glam::Vec3;
use std::ops::Range;
use wgpu::TextureFormat as Format;

/// One blur along one axis; its twin has the same name.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct SevenTaps {
    /// Weights of the taps for red, green and blue; their places in alpha, texels.
    pub all: [[f32; 4]; 7],
    /// From one texel to the next.
    pub step_texels: [i32; 2],
    /// 0 along u, 1 along v.
    pub axis: u32,
    /// Factor on the places.
    pub factor: f32,
}

/// The pass's pipelines.
#[derive(Debug)]
pub struct SevenTapsPass {
    begin: Pipeline,
    blur: Pipeline,
}

/// Everything the pass reads and fills.
#[derive(Debug, Clone, Copy)]
pub struct SevenTapsInputs<'a> {
    /// The object.
    pub object: &'a Object,
    /// Its surface unrolled.
    pub atlas: &'a Atlas,
    /// Its charts.
    pub charts: &'a ChartPyramid,
    /// Light that came through its thin parts, at half the size; none if nobody asks for it.
    pub through: Option<&'a Map>,
    /// The light map.
    pub light: &'a Map,
    /// Where blurred light goes, and what holds it between two axes.
    pub maps: [&'a Map; 2],
    /// Numbers of the technique.
    pub settings: &'a TextureBlurSettings,
    /// Factor on the places of the taps.
    pub factor: f32,
}

impl SevenTapsPass {
    /// Compiles them.
    pub fn new(gpu: &Gpu) -> Self {
        let pipeline = |entry| {
            let (entries, targets) = (["cover_run", entry], &[Format::Rgba16Float]);
            let (name, source) = ("blur", shaders::SEVEN_TAPS);
            Pipeline::new(gpu, &Blueprint { name, source, entries, targets, additive: false, depth: false })
        };
        Self { begin: pipeline("begin_blur"), blur: pipeline("blur_seven") }
    }

    /// The steps that blur a light map.
    pub fn steps(&self, gpu: &Gpu, inputs: &SevenTapsInputs) -> Vec<Step> {
        let [blurred, half_way] = inputs.maps;
        let passes = inputs.settings.passes;
        let due = |left| layers_due(inputs.object.material.under.len(), passes, left);
        let (mut steps, mut from) = (Vec::new(), inputs.light);
        if passes == 0 || !due(passes).is_empty() || inputs.through.is_some() {
            steps.push(self.begin(gpu, inputs, due(passes)));
            from = blurred;
        }
        for left in (0..passes).rev() {
            steps.push(self.blur(gpu, inputs, 0, [from, half_way], 0..0));
            // After the last blur there is no layer any more.
            let layers = if left == 0 { 0..0 } else { due(left) };
            steps.push(self.blur(gpu, inputs, 1, [half_way, blurred], layers));
            from = blurred;
        }
        steps
    }

    fn begin(&self, gpu: &Gpu, inputs: &SevenTapsInputs, layers: Range<usize>) -> Step {
        let [charts, half_charts] = [&inputs.charts.sizes[0], &inputs.charts.sizes[1]];
        let layers = colours(gpu, inputs, layers);
        let nothing;
        let through = match inputs.through {
            Some(through) => through,
            None => {
                nothing = Map::square(gpu, "nothing came through", 1, 1, Format::Rgba16Float);
                &nothing
            }
        };
        let bound = [
            (2, Bound::Texture(&inputs.light.layers[0])),
            (3, Bound::Texture(charts.map.view())),
            (4, Bound::Texture(layers.view())),
            (5, Bound::Texture(through.view())),
            (6, Bound::Texture(half_charts.map.view())),
        ];
        over_charts(gpu, &self.begin, charts, &bound, &[&inputs.maps[0].layers[0]], false)
    }

    fn blur(
        &self,
        gpu: &Gpu,
        inputs: &SevenTapsInputs,
        axis: u32,
        [from, to]: [&Map; 2],
        layers: Range<usize>,
    ) -> Step {
        let charts: &ChartTexture = &inputs.charts.sizes[0];
        let layers = colours(gpu, inputs, layers);
        let numbers = gpu.uniform("seven taps", &numbers(inputs, axis));
        let bound = [
            (1, Bound::Buffer(&numbers)),
            (2, Bound::Texture(&from.layers[0])),
            (3, Bound::Texture(charts.map.view())),
            (4, Bound::Texture(layers.view())),
        ];
        over_charts(gpu, &self.blur, charts, &bound, &[&to.layers[0]], false)
    }
}

fn numbers(inputs: &SevenTapsInputs, axis: u32) -> SevenTaps {
    let weights = weights(inputs.settings.weights);
    let tap = |i: usize| weights[i].extend(OFFSETS_TEXELS[i]).to_array();
    SevenTaps {
        all: std::array::from_fn(tap),
        step_texels: if axis == 0 { [1, 0] } else { [0, 1] },
        axis,
        factor: inputs.factor,
    }
}

/// The product of some layers' colours, texel by texel of the light map: no pose moves texture coordinates.
fn colours(gpu: &Gpu, inputs: &SevenTapsInputs, layers: Range<usize>) -> Map {
    let layers = &inputs.object.material.under[layers];
    if layers.is_empty() {
        return Map::of_values(gpu, "no layer", [1, 1], std::iter::once(glam::Vec4::ONE));
    }
    let size = inputs.atlas.size;
    let colour = |i: usize| {
        let uv = inputs.atlas.map_uv_under(inputs.object, i);
        uv.map_or(Vec3::ONE, |uv| layers.iter().map(|layer| layer.at(uv)).product()).extend(1.0)
    };
    Map::of_values(gpu, "layers under the surface", [size as u32; 2], (0..size * size).map(colour))
}
