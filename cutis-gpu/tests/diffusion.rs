//! Diffusion on the device: against the exact convolution on flat patches, and against the processor on a head.

mod common;

use common::{difference, head_in_the_studio, read, renderer, tolerances};
use cutis_gpu::GpuRenderer;
use cutis_gpu::map::{Map, half_bytes};
use cutis_gpu::passes::diffusion::{like_level, shortened};
use cutis_gpu::passes::levels::Levels;
use cutis_gpu::scene::charts::ChartPyramid;
use cutis_optics::presets;
use cutis_render::Silent;
use cutis_render::passes::atlas::{Atlas, ChartMap, NO_CHART};
use cutis_render::passes::blur::Fields;
use cutis_render::passes::diffusion::{
    Action, Diffused, DiffusionOperator, Level, Separable, median_texel_mm, plan,
};
use cutis_render::passes::stretch::stretch_mm_per_texel;
use cutis_scene::validation::shapes;
use cutis_scene::{Material, Object};
use glam::{Vec2, Vec4};
use std::sync::Arc;

const SIZE: usize = 512;
const LIT: [usize; 2] = [SIZE / 2 + 3, SIZE / 2 - 6];

/// Texel coordinate to millimetres, growing.
type AxisMap = fn(f64) -> f64;

/// What the device makes of a map on an object's atlas, in the processor's terms.
fn diffuse_on_gpu(
    renderer: &GpuRenderer,
    object: &Object,
    atlas: &Atlas,
    variances_mm2: &[f32],
    light: &[Vec4],
) -> Diffused {
    let (gpu, passes) = common::parts(renderer);
    let size = atlas.size as u32;
    let stretch_mm = stretch_mm_per_texel(object, atlas);
    let texel_mm = median_texel_mm(&atlas.charts, &stretch_mm);
    let plan = shortened(&plan(atlas.size, texel_mm, variances_mm2), texel_mm);
    let mut charts = vec![Arc::clone(&atlas.charts)];
    for _ in plan.iter().filter(|a| **a == Action::Halve) {
        let half = charts[charts.len() - 1].halved();
        charts.push(Arc::new(half));
    }
    let textures = ChartPyramid::new(gpu, &atlas.charts, charts.len()).sizes;
    let levels = Levels::new(gpu, &textures, 1, &plan);
    levels.all[0].light.write(gpu, 0, &half_bytes(light.iter().copied()));
    let stretch = stretch_mm.iter().map(|s| s.extend(0.0).extend(0.0));
    let stretch = Map::of_values(gpu, "stretch", [size, size], stretch);
    let half_way = like_level(gpu, "blurred light", size, &levels.all[0].light);
    let diffusion = passes.diffusion.steps(gpu, &textures, &levels, (&stretch, &half_way), &plan);
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    diffusion.taps.iter().chain(&diffusion.blurs).for_each(|step| step.encode(&mut encoder, None));
    gpu.queue.submit([encoder.finish()]);
    let charts_of = |size: u32| {
        Arc::clone(charts.iter().find(|c| c.size == size as usize).expect("a level has one of these sizes"))
    };
    let level = |level: &cutis_gpu::passes::levels::Level| Level {
        charts: charts_of(level.charts.size),
        layers: Arc::new(vec![read(gpu, &level.light, 0)]),
    };
    Diffused { levels: levels.all.iter().map(level).collect() }
}

/// A flat patch over the whole texture but for a margin of 4 texels.
fn patch(along_u: AxisMap, along_v: AxisMap) -> Object {
    let size = SIZE as f64;
    let mesh = shapes::patch(64, 4.0 / size, |u| along_u(u * size), |v| along_v(v * size));
    Object::new("patch", mesh, Material::default())
}

fn three_layer_skin(channel: usize) -> Vec<(f64, f64)> {
    let preset = presets::find("three-layer-skin").expect("ships inside");
    let sum = preset.kernel(6).expect("is a constant").channel(channel);
    sum.terms.iter().filter(|t| t.weight > 0.0).map(|t| (t.weight, t.variance_mm2)).collect()
}

/// Share of a Gaussian around `x_mm` that falls between two places.
fn between(x_mm: f64, from_mm: f64, to_mm: f64, variance_mm2: f64) -> f64 {
    let below = |edge: f64| 0.5 * libm::erfc((x_mm - edge) / (2.0 * variance_mm2).sqrt());
    below(to_mm) - below(from_mm)
}

/// What one lit texel becomes at the centre of every texel, exactly.
fn expected(maps: [AxisMap; 2], terms: &[(f64, f64)]) -> Vec<f64> {
    let axis = |a: usize, variance: f64| -> Vec<f64> {
        let (from, to) = (maps[a](LIT[a] as f64), maps[a](LIT[a] as f64 + 1.0));
        (0..SIZE).map(|i| between(maps[a](i as f64 + 0.5), from, to, variance)).collect()
    };
    let mut sum = vec![0.0; SIZE * SIZE];
    for &(weight, variance) in terms {
        let (u, v) = (axis(0, variance), axis(1, variance));
        sum.iter_mut().enumerate().for_each(|(i, s)| *s += weight * u[i % SIZE] * v[i / SIZE]);
    }
    sum
}

/// Relative RMS power error and change of energy for one lit texel.
fn one_lit_texel(renderer: &GpuRenderer, maps: [AxisMap; 2], terms: &[(f64, f64)]) -> [f64; 2] {
    // Little light falls below what 16-bit floats hold; so the texel shines brightly.
    const BRIGHT: f32 = 1000.0;
    let object = patch(maps[0], maps[1]);
    let atlas = Atlas::new(&object, SIZE);
    let lit = LIT[1] * SIZE + LIT[0];
    let light: Vec<_> =
        (0..SIZE * SIZE).map(|i| if i == lit { Vec4::splat(BRIGHT) } else { Vec4::ZERO }).collect();
    let variances: Vec<f32> = terms.iter().map(|t| t.1 as f32).collect();
    let diffused = diffuse_on_gpu(renderer, &object, &atlas, &variances, &light);
    let centre = |i: usize| (Vec2::new((i % SIZE) as f32, (i / SIZE) as f32) + 0.5) / SIZE as f32;
    let at = |i: usize| {
        let levels = terms.iter().enumerate();
        levels.map(|(l, t)| t.0 * f64::from(diffused.sample(l + 1, 0, centre(i), 0).x / BRIGHT)).sum::<f64>()
    };
    let got: Vec<f64> = (0..SIZE * SIZE).map(at).collect();
    let width = |a: usize, i: usize| maps[a](i as f64 + 1.0) - maps[a](i as f64);
    let area = |i: usize| width(0, i % SIZE) * width(1, i / SIZE);
    let wanted = expected(maps, terms);
    let sum = |f: &dyn Fn(usize) -> f64| (0..got.len()).map(|i| area(i) * f(i)).sum::<f64>();
    let error = (sum(&|i| (got[i] - wanted[i]).powi(2)) / sum(&|i| wanted[i].powi(2))).sqrt();
    let total: f64 = terms.iter().map(|t| t.0).sum::<f64>() * area(lit);
    [error, sum(&|i| got[i]) / total - 1.0]
}

#[test]
fn one_lit_texel_spreads_as_the_exact_convolution_says() {
    let Some(renderer) = renderer("one_lit_texel_spreads_as_the_exact_convolution_says") else { return };
    let cases: [(&str, [AxisMap; 2]); 3] = [
        ("texels of 0.08 mm", [|u| 0.08 * u, |v| 0.08 * v]),
        ("stretched 2:1", [|u| 0.16 * u, |v| 0.08 * v]),
        (
            "growing along u",
            [|u| 0.08 * SIZE as f64 / std::f64::consts::LN_2 * 2f64.powf(u / SIZE as f64), |v| 0.08 * v],
        ),
    ];
    for (what, maps) in cases {
        for channel in 0..3 {
            let [error, energy] = one_lit_texel(renderer, maps, &three_layer_skin(channel));
            eprintln!(
                "{what}, channel {channel}: error {:.3} %, energy {:+.3} %",
                100.0 * error,
                100.0 * energy
            );
            assert!(error <= tolerances::ONE_LIT_TEXEL, "{what}, channel {channel}: {error}");
            assert!(energy.abs() <= tolerances::ENERGY, "{what}, channel {channel}: {energy}");
        }
    }
}

#[test]
fn constant_light_stays_constant_in_every_chart() {
    let Some(renderer) = renderer("constant_light_stays_constant_in_every_chart") else { return };
    let scene = head_in_the_studio();
    let object = &scene.objects[0];
    let atlas = Atlas::new(object, SIZE);
    let light: Vec<_> =
        covered(&atlas.charts).map(|c| if c { Vec4::splat(2.0) } else { Vec4::ZERO }).collect();
    let diffused = diffuse_on_gpu(renderer, object, &atlas, &wide_variances(), &light);
    assert!(diffused.levels.iter().any(|level| level.charts.size < SIZE), "something is halved");
    for (i, level) in diffused.levels.iter().enumerate() {
        for (texel, value) in level.layers[0].iter().enumerate() {
            let inside = level.charts.chart[texel] != NO_CHART;
            assert!(
                !inside || (value.x / 2.0 - 1.0).abs() < tolerances::CONSTANT,
                "level {i}, {texel}: {value}"
            );
        }
    }
}

/// Those of skin and one so wide that it lives in a smaller texture.
fn wide_variances() -> Vec<f32> {
    three_layer_skin(0).iter().map(|t| t.1 as f32).chain([40.0]).collect()
}

fn covered(charts: &ChartMap) -> impl Iterator<Item = bool> + '_ {
    charts.chart.iter().map(|&c| c != NO_CHART)
}

#[test]
fn every_level_is_that_of_the_processor() {
    let Some(renderer) = renderer("every_level_is_that_of_the_processor") else { return };
    let scene = head_in_the_studio();
    let object = &scene.objects[0];
    let atlas = Atlas::new(object, SIZE);
    // Stripes with sharp edges, as shadows have them.
    let stripes = |i: usize| if (i % SIZE / 24 + i / SIZE / 40).is_multiple_of(2) { 1.0 } else { 0.1 };
    let light: Vec<_> = covered(&atlas.charts)
        .enumerate()
        .map(|(i, c)| if c { Vec4::splat(stripes(i)) } else { Vec4::ZERO })
        .collect();
    let variances = wide_variances();
    let got = diffuse_on_gpu(renderer, object, &atlas, &variances, &light);
    let fields = Fields::new(vec![light], stretch_mm_per_texel(object, &atlas));
    let wanted = Separable.diffuse(Arc::clone(&atlas.charts), fields, &variances, &Silent);
    assert_eq!(got.levels.len(), wanted.levels.len());
    for (i, (g, w)) in got.levels.iter().zip(&wanted.levels).enumerate() {
        let inside = |t: usize| w.charts.chart[t] != NO_CHART;
        difference(&g.layers[0], &w.layers[0], inside).check(&format!("level {i}"), tolerances::LEVELS);
    }
}
