//! The technique `texture-blur`: what its blur makes of one texel and of constants, how wide it is, what lies under the
//! surface, and its limits.

mod common;

use common::patch;
use cutis_optics::RgbGaussianSum;
use cutis_render::lit_scene::LitScene;
use cutis_render::passes::atlas::{Atlas, NO_CHART};
use cutis_render::passes::blur::Axis;
use cutis_render::passes::seven_taps::{blurred, factor_of, variance_texel2, weights};
use cutis_render::prepare::kernel::kernel_of;
use cutis_render::technique::texture_blur::{BlurWeights, BlurWidth, TextureBlurSettings};
use cutis_render::{Aov, CpuRenderer, Diffusion, Frame, Renderer, Settings, Silent, TechniqueName};
use cutis_scene::head::HeadDetail;
use cutis_scene::{Camera, ColourMap, Light, Object, ScalarMap, Scattering, Scene, Texels, Texture, studio};
use glam::{Vec3, Vec4};
use std::sync::{Arc, LazyLock};

const SIZE: usize = 128;
const MIDDLE: usize = 64;

fn settings(texture_blur: TextureBlurSettings) -> Settings {
    let mut settings = Settings {
        technique: TechniqueName::TextureBlur,
        width: 24,
        height: 24,
        samples_per_pixel: 1,
        irradiance_size: SIZE as u32,
        ..Settings::default()
    };
    settings.techniques.texture_blur = texture_blur;
    settings
}

/// One lit texel in the middle of a patch of `size` texels, after so many blurs along both axes.
fn one_lit_texel(size: usize, choice: BlurWeights, factor: f32, passes: usize) -> Vec<Vec4> {
    let object = patch(size, 8, |u| u, |v| v);
    let charts = Atlas::new(&object, size).charts;
    let mut light = vec![Vec4::ZERO; size * size];
    light[size / 2 * size + size / 2] = Vec4::ONE;
    for _ in 0..passes {
        for axis in [Axis::U, Axis::V] {
            light = blurred(&charts, &light, axis, factor, &weights(choice));
        }
    }
    light
}

/// What listing 16-7 makes of one lit texel, by the distance from it: the reads at 1.5, 3.5 and 5.5 texels halve each weight
/// between two of them.
fn listing(d: isize) -> [f32; 3] {
    let red = match d.abs() {
        0 => 0.383,
        1 | 2 => 0.121,
        3 | 4 => 0.0305,
        5 | 6 => 0.003,
        _ => 0.0,
    };
    let [green, blue] = match d {
        0 => [0.5, 0.5],
        // What lies after the lit texel reads it by the tap before it, whose weight for blue is the greater one.
        1 | 2 => [0.125, 0.125],
        -2 | -1 => [0.125, 0.1],
        _ => [0.0; 2],
    };
    [red, green, blue]
}

#[test]
fn one_lit_texel_becomes_the_weights_of_the_listing() {
    let light = one_lit_texel(SIZE, BlurWeights::Printed, 1.0, 1);
    let mut sums = [0.0f64; 3];
    for (i, texel) in light.iter().enumerate() {
        let [along_u, along_v] = [i % SIZE, i / SIZE].map(|x| listing(x as isize - MIDDLE as isize));
        for channel in 0..3 {
            let expected = along_u[channel] * along_v[channel];
            // Seven products and sums along each axis of numbers up to 1.
            assert!((texel[channel] - expected).abs() < 16.0 * f32::EPSILON, "texel {i}, channel {channel}");
            sums[channel] += f64::from(texel[channel]);
        }
    }
    for (sum, of_axis) in sums.iter().zip([1.001, 1.0, 0.95]) {
        assert!((sum - of_axis * of_axis).abs() < 1e-5, "{sums:?}");
    }
    let normalised: f64 =
        one_lit_texel(SIZE, BlurWeights::Normalised, 1.0, 1).iter().map(|t| f64::from(t.z)).sum();
    assert!((normalised - 1.0).abs() < 1e-5, "{normalised}");
}

#[test]
fn constants_stay_in_every_chart_up_to_its_border() {
    let head = &head().objects[0];
    assert!(head.charts.count > 1, "there are borders");
    let charts = Atlas::new(head, 256).charts;
    for factor in [0.3, 1.0, 7.3, f32::MAX] {
        let mut light: Vec<_> =
            charts.chart.iter().map(|&c| if c == NO_CHART { Vec4::ZERO } else { Vec4::splat(2.0) }).collect();
        for axis in [Axis::U, Axis::V, Axis::U, Axis::V] {
            light = blurred(&charts, &light, axis, factor, &weights(BlurWeights::Normalised));
        }
        let covered = light.iter().zip(&charts.chart).filter(|(_, chart)| **chart != NO_CHART);
        let worst = covered.map(|(t, _)| (t.truncate() * 0.5 - 1.0).abs().max_element()).fold(0.0, f32::max);
        // Seven weights, rounded when they are divided and when they are added, in each of four blurs.
        assert!(worst < 4.0 * 7.0 * f32::EPSILON, "factor {factor}: {worst}");
    }
}

/// Variance of red along u, texel².
fn variance(light: &[Vec4], size: usize) -> f64 {
    let moment = |n: i32| -> f64 {
        let at = |(i, t): (usize, &Vec4)| f64::from(t.x) * ((i % size) as f64 - (size / 2) as f64).powi(n);
        light.iter().enumerate().map(at).sum()
    };
    moment(2) / moment(0) - (moment(1) / moment(0)).powi(2)
}

#[test]
fn variances_of_blurs_add_up() {
    // 2 (0.242 (1² + 2²)/2 + 0.061 (3² + 4²)/2 + 0.006 (5² + 6²)/2) / 1.001 texel².
    let of_listing = 3.101 / 1.001;
    let red = weights(BlurWeights::Printed).map(|w| f64::from(w.x));
    assert!((variance_texel2(red, 1.0) / of_listing - 1.0).abs() < 1e-6);
    for (factor, passes) in [(1.0, 1), (1.0, 2), (1.0, 5), (0.37, 3), (1.9, 3)] {
        let measured = variance(&one_lit_texel(SIZE, BlurWeights::Printed, factor, passes), SIZE);
        let expected = passes as f64 * variance_texel2(red, f64::from(factor));
        // The light far from the middle, 33 texels at most, is small and rounded: 33² ε on the mean at worst.
        assert!((measured / expected - 1.0).abs() < 1e-4, "{factor}, {passes}: {measured} of {expected}");
    }
}

#[test]
fn all_passes_together_spread_red_as_far_as_the_material() {
    let (size, texel_mm) = (512, 0.08f32);
    let object = patch(size, 8, |u| 0.08 * u, |v| 0.08 * v);
    let deviation_mm = kernel_of(&object.material, 6).expect("is known").deviation_mm().x;
    for passes in [2, 4, 7] {
        let blur =
            TextureBlurSettings { passes, width: BlurWidth::Material, ..TextureBlurSettings::default() };
        let factor = factor_of(&object, texel_mm, &settings(blur)).expect("has a kernel");
        let light = one_lit_texel(size, BlurWeights::Normalised, factor, passes as usize);
        let measured_mm = variance(&light, size).sqrt() * f64::from(texel_mm);
        // The factor is found to the last digit; light is rounded as above.
        let off = measured_mm / f64::from(deviation_mm) - 1.0;
        assert!(off.abs() < 1e-4, "{passes} passes: {measured_mm} mm of {deviation_mm} mm");
    }
}

/// A patch of 0.1 mm texels under even light from straight above.
fn lit_patch(change: impl FnOnce(&mut Object)) -> Scene {
    let mut object = patch(SIZE, 8, |u| 0.1 * u, |v| 0.1 * v);
    object.material.rho_s = ScalarMap::constant(0.0);
    object.material.albedo.factor = Vec3::ONE;
    change(&mut object);
    let light =
        Light::Directional { dir_to_light: Vec3::Z, irradiance_w_per_m2: Vec3::ONE, angular_radius_rad: 0.0 };
    Scene {
        camera: Camera::framing(object.mesh.bounds_mm().expect("has points"), Vec3::Z, 0.4),
        objects: vec![object],
        lights: vec![light],
        environment: None,
        background: None,
        warnings: Vec::new(),
    }
}

/// A map that is black up to the middle and white from there.
fn edge() -> ColourMap {
    let texels = (0..SIZE * SIZE).map(|i| if i % SIZE < MIDDLE { [0.0; 4] } else { [1.0; 4] }).collect();
    let texture = Texture::new(SIZE as u32, SIZE as u32, Texels::LinearF32(texels));
    ColourMap { factor: Vec3::ONE, texture: Some(Arc::new(texture)) }
}

/// The edge after so many blurs by the listing, red, by sums in double precision.
fn blurred_edge(passes: u32) -> Vec<f64> {
    let mut line: Vec<f64> = (0..SIZE).map(|i| if i < MIDDLE { 0.0 } else { 1.0 }).collect();
    for _ in 0..passes {
        let at = |i: isize| line[i.clamp(0, SIZE as isize - 1) as usize];
        let sum = |i: isize| (-6..=6).map(|d| f64::from(listing(d)[0]) * at(i - d)).sum::<f64>() / 1.001;
        line = (0..SIZE as isize).map(sum).collect();
    }
    line
}

#[test]
fn a_layer_is_seen_through_as_many_blurs_as_it_lies_deep() {
    let white = || ColourMap { factor: Vec3::ONE, texture: None };
    // (layers over the edge, blurs, blurs that the edge is seen through)
    for (over, passes, seen_through) in [(0, 4, 1), (1, 4, 2), (3, 4, 4), (4, 4, 4), (0, 1, 1), (2, 0, 0)] {
        let scene = lit_patch(|object| {
            object.material.under = (0..over).map(|_| white()).chain([edge()]).collect();
        });
        let blur = TextureBlurSettings { passes, ..TextureBlurSettings::default() };
        let lit = LitScene::new(&scene, &settings(blur), &Silent).expect("draws");
        let row = &lit.maps()[0].diffused.levels[1].layers[0][MIDDLE * SIZE..][..SIZE];
        let expected = blurred_edge(seen_through);
        for i in MIDDLE - 26..MIDDLE + 26 {
            // Texture coordinates of the texels are rounded: 64 ε of a step of the image between two texels.
            let off = (f64::from(row[i].x) - expected[i]).abs();
            assert!(off < 3e-5, "{over} over, {passes} passes, texel {i}: {} of {}", row[i].x, expected[i]);
        }
    }
}

#[test]
fn layers_filter_what_was_blurred_and_nothing_else() {
    let scene = lit_patch(|object| {
        let layer = |factor| ColourMap { factor, texture: None };
        object.material.under = vec![layer(Vec3::new(0.5, 1.0, 0.25)), layer(Vec3::new(0.5, 0.75, 1.0))];
    });
    let blur = TextureBlurSettings { blend: 0.25, passes: 3, ..TextureBlurSettings::default() };
    let lit = LitScene::new(&scene, &settings(blur), &Silent).expect("draws");
    let maps = &lit.maps()[0];
    let total = kernel_of(&scene.objects[0].material, 6).expect("is known").total();
    let leaves = maps.diffused.weighted_sum(&maps.kernel.weights, glam::Vec2::splat(0.5), 0);
    // Light of 1 W/m², of which a quarter has met both layers.
    let expected = (Vec3::splat(0.75) + 0.25 * Vec3::new(0.25, 0.75, 0.25)) * total;
    assert!((leaves / expected - 1.0).abs().max_element() < 1e-5, "{leaves} of {expected}");
}

/// A small head in the studio, which takes seconds to make.
fn head() -> Scene {
    static HEAD: LazyLock<Scene> =
        LazyLock::new(|| studio::head_in_the_studio(HeadDetail { triangles: 3000, map_size: 0 }));
    Scene { environment: None, ..HEAD.clone() }
}

fn draw(scene: &Scene, settings: &Settings) -> Frame {
    CpuRenderer.render(scene, settings, &Silent).expect("draws")
}

#[test]
fn what_spreads_nothing_is_plain_diffuse_shading() {
    let plain = TextureBlurSettings { blend: 0.0, ..TextureBlurSettings::default() };
    let material = TextureBlurSettings {
        passes: 3,
        width: BlurWidth::Material,
        depth: true,
        ..TextureBlurSettings::default()
    };
    let still = TextureBlurSettings { passes: 0, ..TextureBlurSettings::default() };
    let narrow = TextureBlurSettings { width: BlurWidth::Listing(0.0), passes: 2, ..plain };
    let mut tight = head();
    let kernel = RgbGaussianSum { variances_mm2: vec![1e-18], weights: vec![[1.0; 3]] };
    tight.objects[0].material.scattering = Scattering::Kernel(kernel);
    let opaque = Settings { diffusion: Diffusion::None, ..settings(plain) };
    for (what, scene, blur) in [
        ("blend 0", head(), plain),
        ("no pass", head(), still),
        ("width 0", head(), TextureBlurSettings { blend: 1.0, ..narrow }),
        ("free path 0", tight, material),
    ] {
        let (drawn, expected) = (draw(&scene, &settings(blur)), draw(&scene, &opaque));
        let off = drawn.pixels.iter().zip(&expected.pixels).map(|(a, b)| (*a - *b).abs().max_element());
        let (off, most) =
            (off.fold(0.0, f32::max), expected.pixels.iter().map(|p| p.max_element()).fold(0.0, f32::max));
        // Weights that sum to one but for rounding, a few times over.
        assert!(off < 64.0 * f32::EPSILON * most, "{what}: {off} of {most}");
    }
}

#[test]
fn a_free_path_of_a_thousand_kilometres_ends_in_numbers() {
    let mut scene = head();
    let kernel = RgbGaussianSum { variances_mm2: vec![1e18], weights: vec![[1.0; 3]] };
    scene.objects[0].material.scattering = Scattering::Kernel(kernel);
    let blur = TextureBlurSettings {
        passes: 5,
        width: BlurWidth::Material,
        depth: true,
        ..TextureBlurSettings::default()
    };
    let frame = draw(&scene, &settings(blur));
    assert!(frame.pixels.iter().all(|p| p.is_finite() && p.min_element() >= 0.0));
    assert!(frame.pixels.iter().any(|p| p.x > 0.0));
}

#[test]
fn reports_levels_and_seams_are_those_of_what_leaves() {
    let blur = TextureBlurSettings { passes: 4, ..TextureBlurSettings::default() };
    let aovs = vec![Aov::Irradiance, Aov::Blur(0), Aov::Blur(1), Aov::Seams];
    let wanted = Settings { diffusion_report: true, aovs, ..settings(blur) };
    let frame = draw(&head(), &wanted);
    let report = &frame.diffusion_reports[0];
    // A blur in texels keeps the sum over texels, not that over the surface.
    assert!(report.energy_change.abs() < 0.1 && report.energy_change != 0.0, "{report:?}");
    let [sharp, blurred, sharp_again, seams] = &frame.layers[..] else { panic!("four layers") };
    assert!(sharp.pixels == sharp_again.pixels && sharp.pixels != blurred.pixels);
    assert!(seams.pixels.iter().any(|p| p.y > 0.0), "some seam is seen");
    // With nothing of the blur in what leaves, its energy is that of the light map.
    let plain = TextureBlurSettings { blend: 0.0, ..blur };
    let report =
        draw(&head(), &Settings { diffusion_report: true, ..settings(plain) }).diffusion_reports.remove(0);
    assert!(report.energy_change.abs() < 1e-5, "{report:?}");
}

#[test]
fn techniques_say_that_they_leave_layers_out() {
    let mut scene = head();
    scene.objects[0].material.under = vec![ColourMap { factor: Vec3::ONE, texture: None }];
    for technique in [TechniqueName::TextureSpace, TechniqueName::TextureBlur] {
        let frame = draw(&scene, &Settings { technique, ..settings(TextureBlurSettings::default()) });
        let told = frame.warnings.iter().any(|words| words.contains("under the surface"));
        assert_eq!(told, technique != TechniqueName::TextureBlur, "{technique}: {:?}", frame.warnings);
    }
}

#[test]
fn numbers_out_of_range_are_refused_in_words() {
    let good = TextureBlurSettings::default();
    let bad = [
        (TextureBlurSettings { passes: 65, ..good }, "0 to 64"),
        (TextureBlurSettings { blend: -0.1, ..good }, "0 to 1"),
        (TextureBlurSettings { blend: f32::NAN, ..good }, "0 to 1"),
        (TextureBlurSettings { width: BlurWidth::Listing(-1.0), ..good }, "0 to 64 times"),
        (TextureBlurSettings { width: BlurWidth::Listing(f32::INFINITY), ..good }, "0 to 64 times"),
        (TextureBlurSettings { width: BlurWidth::Listing(f32::NAN), ..good }, "0 to 64 times"),
    ];
    for (blur, words) in bad {
        let refused = settings(blur).check().expect_err("is bad");
        assert!(refused.to_string().contains(words), "{refused}");
    }
}
