//! Heat flow on the device against the processor: polynomial by polynomial, sums, halvings and the padding.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{head_in_the_studio, read, renderer};
use cutis_gpu::GpuRenderer;
use cutis_gpu::cost::by_pass;
use cutis_gpu::map::half_bytes;
use cutis_gpu::passes::heat_flow::{GpuHeatFlow, actions};
use cutis_gpu::passes::levels::Levels;
use cutis_gpu::scene::charts::ChartPyramid;
use cutis_render::passes::atlas::{Atlas, NO_CHART};
use cutis_render::passes::heat_flow::HeatFlow;
use cutis_render::passes::stretch::stretch_mm_per_texel;
use cutis_render::{Diffusion, Settings, Silent};
use cutis_scene::Object;
use glam::Vec4;

const SIZE: usize = 512;

/// The built-in head and its atlas.
fn head() -> (Object, Atlas) {
    let object = head_in_the_studio().objects.swap_remove(0);
    let atlas = Atlas::new(&object, SIZE);
    (object, atlas)
}

/// Light in squares of ten millimetres, with a different channel each way.
fn squares(object: &Object, atlas: &Atlas) -> Vec<Vec4> {
    let lit = |i: usize| {
        let Some(point) = atlas.surface_point(object, i) else { return Vec4::ZERO };
        let cells = (point.position_mm / 10.0).floor().as_ivec3();
        let on = |n: i32| if n.rem_euclid(2) == 0 { 1.0 } else { 0.125 };
        Vec4::new(
            on(cells.x),
            on(cells.y),
            on(cells.x + cells.y + cells.z),
            3.0 + point.position_mm.x / 100.0,
        )
    };
    (0..atlas.size * atlas.size).map(lit).collect()
}

/// All levels but the first, as the device makes them.
fn flown(renderer: &GpuRenderer, atlas: &Atlas, flow: &HeatFlow, light: &[Vec4]) -> Vec<Vec<Vec4>> {
    flown_in_pose(renderer, atlas, flow, None, light)
}

/// The same, where the object is put into another pose after the upload.
fn flown_in_pose(
    renderer: &GpuRenderer,
    atlas: &Atlas,
    flow: &HeatFlow,
    posed: Option<&Object>,
    light: &[Vec4],
) -> Vec<Vec<Vec4>> {
    let (gpu, passes) = common::parts(renderer);
    let charts = ChartPyramid::new(gpu, &atlas.charts, flow.levels.len()).sizes;
    let levels = Levels::new(gpu, &charts, 1, &actions(flow));
    levels.all[0].light.write(gpu, 0, &half_bytes(light.iter().copied()));
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let on_device = GpuHeatFlow::new(gpu, flow.clone());
    let steps = passes.heat_flow.steps(gpu, &charts, &levels, &on_device);
    posed.into_iter().for_each(|object| on_device.set_pose(gpu, object));
    // Twice: what a frame leaves behind must not show in the next.
    for _ in 0..2 {
        steps.iter().for_each(|step| step.encode(&mut encoder, None));
    }
    gpu.queue.submit([encoder.finish()]);
    levels.all[1..].iter().map(|level| read(gpu, &level.light, 0)).collect()
}

/// Mean and 99.9th percentile of the difference of two maps over the texels of charts, by the mean light there.
fn apart(charts: &[u32], a: &[Vec4], b: &[Vec4]) -> [f32; 2] {
    let texels = || (0..charts.len()).filter(|&i| charts[i] != NO_CHART);
    let mean = texels().map(|i| b[i].element_sum()).sum::<f32>() / (4 * texels().count()) as f32;
    let mut off: Vec<f32> = texels().map(|i| (a[i] - b[i]).abs().max_element() / mean).collect();
    off.sort_by(f32::total_cmp);
    [off.iter().sum::<f32>() / off.len() as f32, off[off.len() * 999 / 1000]]
}

/// The head, with variances that grow until one is wide enough for a coarse map.
#[test]
fn both_machines_spread_the_same_light() {
    let Some(renderer) = renderer("both_machines_spread_the_same_light") else { return };
    let (object, atlas) = &head();
    let variances_mm2 = [0.05, 0.5, 2.0, 8.0, 200.0];
    let flow = HeatFlow::new(object, atlas, &stretch_mm_per_texel(object, atlas), &variances_mm2);
    assert!(flow.levels.len() > 1, "there is a coarse level");
    let light = squares(object, atlas);
    let (exact, found) = (flow.flow(&light), flown(renderer, atlas, &flow, &light));
    let charts = flow.levels.iter().flat_map(|level| level.times.iter().map(|_| &level.atlas.charts.chart));
    for (n, ((exact, found), charts)) in exact.iter().zip(&found).zip(charts).enumerate() {
        let [mean, worst] = apart(charts, found, exact);
        eprintln!("{} mm²: mean {mean}, worst {worst}", variances_mm2[n]);
        assert!(mean < 0.0025 && worst < 0.013, "{} mm²: {mean} {worst}", variances_mm2[n]);
    }
}

/// With a single coefficient of 1 a sum is the polynomial itself.
#[test]
fn both_machines_have_the_same_polynomials() {
    let Some(renderer) = renderer("both_machines_have_the_same_polynomials") else { return };
    let (object, atlas) = &head();
    let numbers = [0, 1, 2, 5, 12];
    let variances_mm2 = numbers.map(|n| 0.1 + 0.1 * n as f32);
    let mut flow = HeatFlow::new(object, atlas, &stretch_mm_per_texel(object, atlas), &variances_mm2);
    assert_eq!(flow.levels.len(), 1);
    for (time, &n) in flow.levels[0].times.iter_mut().zip(&numbers) {
        *time = (0..=n).map(|k| if k == n { 1.0 } else { 0.0 }).collect();
    }
    let light = squares(object, atlas);
    let (exact, found) = (flow.flow(&light), flown(renderer, atlas, &flow, &light));
    for ((n, exact), found) in numbers.iter().zip(&exact).zip(&found) {
        let [mean, worst] = apart(&atlas.charts.chart, found, exact);
        eprintln!("polynomial {n}: mean {mean}, worst {worst}");
        let stages = (n + 2) as f32;
        assert!(mean < 0.0003 * stages && worst < 0.0015 * stages, "{n}: {mean} {worst}");
    }
}

/// The first polynomial of a coarse map is the light that was halved.
#[test]
fn both_machines_halve_light_alike() {
    let Some(renderer) = renderer("both_machines_halve_light_alike") else { return };
    let (object, atlas) = &head();
    let mut flow = HeatFlow::new(object, atlas, &stretch_mm_per_texel(object, atlas), &[0.1, 200.0]);
    let coarse = flow.levels.last_mut().unwrap();
    coarse.times[0] = vec![1.0];
    let charts = coarse.atlas.charts.chart.clone();
    let light = squares(object, atlas);
    let (exact, found) = (flow.flow(&light), flown(renderer, atlas, &flow, &light));
    let [mean, worst] = apart(&charts, &found[1], &exact[1]);
    eprintln!("mean {mean}, worst {worst}");
    assert!(mean < 0.001 && worst < 0.005, "{mean} {worst}");
}

/// A head that is drawn out to one and a half times its height after the upload, and whose one half becomes twice as wide.
#[test]
fn heat_flows_by_the_pose() {
    let Some(renderer) = renderer("heat_flows_by_the_pose") else { return };
    let (object, atlas) = &head();
    let mut mesh = object.mesh.clone();
    let drawn = |p: &mut glam::Vec3| *p *= glam::Vec3::new(if p.x > 0.0 { 2.0 } else { 1.0 }, 1.5, 1.0);
    mesh.positions_mm.iter_mut().for_each(drawn);
    let posed = Object::new("head", mesh, object.material.clone());
    let variances_mm2 = [0.5, 8.0, 200.0];
    let flow =
        HeatFlow::new(object, atlas, &stretch_mm_per_texel(object, atlas), &variances_mm2).for_all_poses();
    let light = squares(object, atlas);
    let mut in_pose = flow.clone();
    in_pose.set_pose(&posed);
    let found = flown_in_pose(renderer, atlas, &flow, Some(&posed), &light);
    let charts = flow.levels.iter().flat_map(|level| level.times.iter().map(|_| &level.atlas.charts.chart));
    for (n, (found, charts)) in found.iter().zip(charts).enumerate() {
        let [mean, worst] = apart(charts, found, &in_pose.flow(&light)[n]);
        let [at_rest, _] = apart(charts, found, &flow.flow(&light)[n]);
        eprintln!("{} mm²: mean {mean}, worst {worst}, from rest {at_rest}", variances_mm2[n]);
        assert!(mean < 0.0025 && worst < 0.013, "{} mm²: {mean} {worst}", variances_mm2[n]);
        assert!(at_rest > 4.0 * mean, "{} mm²: the pose shows", variances_mm2[n]);
    }
}

/// What a frame's heat flow moves through memory, at 1 TB/s, on maps of 1024²; what stages read twice or leave out is not known.
#[test]
fn heat_flow_moves_no_more_than_it_did() {
    let Some(renderer) = renderer("heat_flow_moves_no_more_than_it_did") else { return };
    let settings = Settings { diffusion: Diffusion::HeatFlow, irradiance_size: 1024, ..Settings::default() };
    let ready = renderer.scene(&head_in_the_studio(), &settings, &Silent).expect("is uploaded");
    let all = by_pass(&ready.costs());
    let flow = all.iter().find(|cost| cost.pass == "heat flow").expect("is part of a frame");
    let ms = flow.milliseconds(1000.0);
    eprintln!("{ms:.2} ms, {:.2} GB", (flow.read_bytes + flow.written_bytes) as f64 * 1e-9);
    assert!(ms < 3.8, "{ms} ms");
}
