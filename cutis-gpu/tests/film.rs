//! The film on the device against that of the processor, on the same light.

mod common;

use common::{head_in_the_studio, parts, renderer, tolerances};
use cutis_gpu::GpuRenderer;
use cutis_gpu::map::Map;
use cutis_gpu::scene::development::{Developing, Development};
use cutis_render::film::{Bloom, Film, ToneMapper, codes, develop};
use cutis_render::{Frame, Settings, Silent};
use glam::{Vec3, Vec4};
use wgpu::TextureFormat as Format;

/// A picture whose sides no cell divides.
const SIZE: [u32; 2] = [151, 203];
const BEHIND: f32 = 0.02;

/// Colours of all hues and tones, ever less covered downwards, a few lamps, and what is no light at all.
fn light() -> Frame {
    let [width, height] = SIZE;
    let pixel = |i: u32| {
        let (x, y) = ((i % width) as f32 / width as f32, (i / width) as f32 / height as f32);
        let tone = (14.0 * x - 10.0).exp2();
        let hue = Vec3::new((6.3 * y).sin(), (6.3 * y + 2.1).sin(), (6.3 * y + 4.2).sin());
        let coverage = (1.5 - 1.5 * y).clamp(0.0, 1.0);
        let lamp = if i.is_multiple_of(4999) { 5000.0 } else { 0.0 };
        ((tone * (1.0 + 0.9 * hue) + lamp) * coverage).extend(coverage)
    };
    let mut pixels: Vec<_> = (0..width * height).map(pixel).collect();
    pixels[700] = Vec4::splat(f32::NAN);
    pixels[900] = Vec4::new(-1.0, 0.5, f32::INFINITY, 1.0);
    Frame { width, height, pixels, ..Frame::default() }
}

fn films() -> impl Iterator<Item = Film> {
    // 203 rows: no reduction; cells of 3 pixels.
    let blooms = [None, Some(Bloom::default()), Some(Bloom { strength: 0.5, sigma_over_height: 0.15 })];
    let with = |tone_mapper| move |bloom| Film { exposure_ev: 0.7, bloom, tone_mapper };
    ToneMapper::ALL.into_iter().flat_map(move |tone_mapper| blooms.into_iter().map(with(tone_mapper)))
}

/// Fails where codes are further apart than they may be.
fn same_codes(got: &[[u8; 4]], expected: &[[u8; 4]], what: &Film) {
    assert_eq!(got.len(), expected.len(), "{what:?}");
    let pairs = || got.as_flattened().iter().zip(expected.as_flattened());
    let most = pairs().map(|(a, b)| a.abs_diff(*b)).max().unwrap_or_default();
    let off = pairs().filter(|(a, b)| a != b).count() as f32 / (3 * got.len()) as f32;
    eprintln!("{what:?}: {most} codes at most, {off:.5} differ");
    assert!(most <= tolerances::CODES_APART, "{what:?}: {most} codes");
    let spread = what.bloom.map_or(0.0, |bloom| bloom.strength);
    assert!(off <= tolerances::codes_that_differ(spread), "{what:?}: {off} differ");
}

#[test]
fn every_tone_mapper_with_and_without_bloom() {
    let Some(renderer) = renderer("every_tone_mapper_with_and_without_bloom") else { return };
    let (gpu, passes) = parts(renderer);
    let frame = light();
    let bytes: &[u8] = bytemuck::cast_slice(&frame.pixels);
    let picture = Map::filled(gpu, "light", SIZE, Format::Rgba32Float, bytes);
    for film in films() {
        let development = Development::new(gpu, passes, &picture, Developing { film, behind: BEHIND });
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        development.steps.iter().for_each(|step| step.encode(&mut encoder, None));
        gpu.queue.submit([encoder.finish()]);
        let got = development.codes(gpu).expect("is developed");
        same_codes(&got, &codes(&develop(&frame, &film), BEHIND), &film);
    }
}

#[test]
fn another_film_needs_no_new_light_and_no_new_picture() {
    let Some(renderer) = renderer("another_film_needs_no_new_light_and_no_new_picture") else { return };
    let GpuRenderer { gpu, passes, .. } = renderer;
    let settings = |side| Settings { width: side, height: side, irradiance_size: 128, ..Settings::default() };
    let mut ready = renderer.scene(&head_in_the_studio(), &settings(48), &Silent).expect("is uploaded");
    assert_eq!(ready.developed(gpu), Ok(None));
    ready.set_film(gpu, passes, Developing { film: Film::default(), behind: BEHIND }).expect("is laid");
    let drawn = ready.look_timed(gpu).expect("is drawn");
    assert!(drawn.iter().any(|pass| pass.name == "tone map"), "a picture is developed when it is drawn");
    let expected = |ready: &cutis_gpu::GpuScene, side, film: &Film| {
        let pixels = ready.picture(gpu).expect("is read");
        codes(&develop(&Frame { width: side, height: side, pixels, ..Frame::default() }, film), BEHIND)
    };
    let developed = |ready: &cutis_gpu::GpuScene| ready.developed(gpu).expect("is read").expect("has a film");
    let first = developed(&ready);
    same_codes(&first, &expected(&ready, 48, &Film::default()), &Film::default());
    for film in films() {
        ready.set_film(gpu, passes, Developing { film, behind: BEHIND }).expect("is laid");
        let passes = ready.develop_timed(gpu).expect("is developed");
        assert!(passes.iter().all(|pass| ["bloom", "tone map"].contains(&pass.name.as_str())), "{passes:?}");
        let got = developed(&ready);
        assert_ne!(got, first);
        same_codes(&got, &expected(&ready, 48, &film), &film);
    }
    // A picture of another size takes the film along.
    ready.set_picture(gpu, passes, &settings(32)).expect("is no larger than before");
    ready.look_timed(gpu).expect("is drawn");
    let last = films().last().expect("there are films");
    same_codes(&developed(&ready), &expected(&ready, 32, &last), &last);
    ready.unset_film();
    assert_eq!(ready.developed(gpu), Ok(None));
}
