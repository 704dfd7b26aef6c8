//! The technique `texture-blur` on the device against the processor: blur by blur, light through a plate, whole frames.

mod common;

use common::tolerances::{self, Tolerance};
use common::{difference, head_in_the_studio, parts, patch, patch_under_a_spot, read, renderer, small_frame};
use cutis_gpu::map::{Map, half_bytes};
use cutis_gpu::passes::seven_taps::SevenTapsInputs;
use cutis_gpu::scene::charts::ChartPyramid;
use cutis_render::passes::atlas::Atlas;
use cutis_render::passes::blur::Axis;
use cutis_render::passes::seven_taps::{blurred, weights};
use cutis_render::technique::texture_blur::{BlurWeights, BlurWidth, TextureBlurSettings};
use cutis_render::{Aov, CpuRenderer, Renderer, Settings, Silent, TechniqueName};
use cutis_scene::validation::shapes;
use cutis_scene::{Camera, ColourMap, Light, Material, Object, ScalarMap, Scene, Texels, Texture};
use glam::{Vec3, Vec4};
use std::sync::Arc;
use wgpu::TextureFormat::Rgba16Float;

const SIZE: usize = 128;

fn settings(texture_blur: TextureBlurSettings) -> Settings {
    let mut settings = Settings {
        technique: TechniqueName::TextureBlur,
        aovs: vec![Aov::Diffuse, Aov::Blur(0)],
        ..small_frame()
    };
    settings.techniques.texture_blur = texture_blur;
    settings
}

#[test]
fn every_blur_of_one_lit_texel_is_that_of_the_processor() {
    let Some(renderer) = renderer("every_blur_of_one_lit_texel_is_that_of_the_processor") else { return };
    let (gpu, passes) = parts(renderer);
    let object = patch(|u| u, |v| v);
    let atlas = Atlas::new(&object, SIZE);
    let charts = ChartPyramid::new(gpu, &atlas.charts, 1);
    let maps: Vec<_> = (0..3).map(|_| Map::square(gpu, "light", SIZE as u32, 1, Rgba16Float)).collect();
    let lit = SIZE / 2 * SIZE + SIZE / 2;
    // Away from the middle, and so near to the edge that taps come closer.
    for (texel, factor) in [(lit, 1.0), (lit, 2.3), (lit, 0.4), (SIZE / 2 * SIZE + 7, 2.3)] {
        // Bright, so that little of it falls below what 16-bit floats hold.
        let mut light = vec![Vec4::ZERO; SIZE * SIZE];
        light[texel] = Vec4::new(1000.0, 1000.0, 1000.0, 3.0);
        maps[0].write(gpu, 0, &half_bytes(light.iter().copied()));
        for passes_done in 1..=3 {
            let settings = TextureBlurSettings {
                weights: BlurWeights::Printed,
                passes: passes_done,
                ..TextureBlurSettings::default()
            };
            let steps = passes.seven_taps.steps(
                gpu,
                &SevenTapsInputs {
                    object: &object,
                    atlas: &atlas,
                    charts: &charts,
                    through: None,
                    light: &maps[0],
                    maps: [&maps[1], &maps[2]],
                    settings: &settings,
                    factor,
                },
            );
            let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            steps.iter().for_each(|step| step.encode(&mut encoder, None));
            gpu.queue.submit([encoder.finish()]);
            for axis in [Axis::U, Axis::V] {
                light = blurred(&atlas.charts, &light, axis, factor, &weights(BlurWeights::Printed));
            }
            let got = read(gpu, &maps[1], 0);
            // Two numbers of 16 bits for each pass, which llvmpipe cuts off: 1/1024 of each at most, and what is too small.
            for (i, (got, expected)) in got.iter().zip(&light).enumerate() {
                let slack = expected.truncate() * (passes_done as f32 / 512.0) + 1e-4;
                let off = (got.truncate() - expected.truncate()).abs();
                assert!(
                    off.cmple(slack).all(),
                    "{factor}, pass {passes_done}, texel {i}: {got} of {expected}"
                );
            }
        }
    }
}

/// Draws a scene on both and compares picture, light that was inside, and the blurred map.
fn same_on_both(test: &str, scene: &Scene, settings: &Settings, allowed: [Tolerance; 3]) {
    let Some(renderer) = renderer(test) else { return };
    let cpu = CpuRenderer.render(scene, settings, &Silent).expect("draws");
    let gpu = renderer.render(scene, settings, &Silent).expect("draws");
    let covered = |i: usize| cpu.pixels[i].w > 0.99 && gpu.pixels[i].w > 0.99;
    difference(&gpu.pixels, &cpu.pixels, covered).check(test, allowed[0]);
    for ((g, c), allowed) in gpu.layers.iter().zip(&cpu.layers).zip(&allowed[1..]) {
        difference(&g.pixels, &c.pixels, covered).check(&format!("{test}, {}", g.name), *allowed);
    }
}

/// Light red veins on white, a dozen across the texture.
fn veins() -> ColourMap {
    let vein = |i: usize| if (i / 8).is_multiple_of(2) { [0.9, 0.3, 0.25, 1.0] } else { [1.0; 4] };
    let texels = (0..SIZE * SIZE).map(|i| vein(i % SIZE)).collect();
    let texture = Texture::new(SIZE as u32, SIZE as u32, Texels::LinearF32(texels));
    ColourMap { factor: Vec3::new(1.0, 0.9, 0.95), texture: Some(Arc::new(texture)) }
}

#[test]
fn a_patch_with_layers_under_it() {
    let mut scene = patch_under_a_spot(patch(|u| 40.0 * u, |v| 40.0 * v));
    let white = ColourMap { factor: Vec3::new(0.8, 0.9, 1.0), texture: None };
    scene.objects[0].material.under = vec![white, veins(), veins()];
    for (passes, blend) in [(0, 1.0), (1, 1.0), (2, 0.6), (5, 1.0)] {
        let blur = TextureBlurSettings { passes, blend, ..TextureBlurSettings::default() };
        let what = format!("a_patch_with_layers_under_it, {passes} passes");
        same_on_both(&what, &scene, &settings(blur), [tolerances::VEINS; 3]);
    }
}

#[test]
fn the_built_in_head_as_wide_as_its_material() {
    let blur =
        TextureBlurSettings { passes: 3, width: BlurWidth::Material, ..TextureBlurSettings::default() };
    let allowed = [tolerances::HEAD, tolerances::SEVEN_TAPS, tolerances::SEVEN_TAPS];
    same_on_both(
        "the_built_in_head_as_wide_as_its_material",
        &head_in_the_studio(),
        &settings(blur),
        allowed,
    );
}

/// A plate lit from behind, seen from the front; with a second light from the side if wanted.
fn backlit_plate(thickness_mm: f32, second: bool) -> Scene {
    let mesh = shapes::cuboid(Vec3::ZERO, Vec3::new(60.0, 60.0, 0.5 * thickness_mm));
    let mut material = Material { rho_s: ScalarMap::constant(0.0), ..Material::default() };
    material.albedo.factor = Vec3::new(0.9, 0.7, 0.6);
    let sun = |dir: Vec3, irradiance_w_per_m2| Light::Directional {
        dir_to_light: dir.normalize(),
        irradiance_w_per_m2,
        angular_radius_rad: 0.0,
    };
    let mut lights = vec![sun(-Vec3::Z, Vec3::ONE)];
    if second {
        lights.push(sun(Vec3::new(0.5, 0.2, -1.0), Vec3::new(0.3, 0.6, 1.2)));
    }
    Scene {
        camera: Camera {
            position_mm: Vec3::Z * 500.0,
            look_at_mm: Vec3::ZERO,
            up: Vec3::Y,
            vertical_fov_rad: 0.12,
            exposure_ev: 0.0,
        },
        objects: vec![Object::new("plate", mesh, material)],
        lights,
        environment: None,
        background: None,
        warnings: Vec::new(),
    }
}

#[test]
fn light_through_a_plate_is_in_the_map_that_is_blurred() {
    for (thickness_mm, second) in [(0.5, false), (2.0, false), (1.0, true)] {
        let blur = TextureBlurSettings { passes: 2, depth: true, ..TextureBlurSettings::default() };
        let scene = backlit_plate(thickness_mm, second);
        let what = format!("light_through_a_plate, {thickness_mm} mm");
        same_on_both(&what, &scene, &settings(blur), [tolerances::PLATE; 3]);
    }
}
