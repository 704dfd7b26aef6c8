//! Every technique on the scanned head at the size of Mertens et al. 2003, 500 × 500 pixels, on the processor and on a graphics
//! adapter, with its error against the simulated truth: image-space with its grain for each number of samples, beside
//! texture-space with textures of several sizes.
#![allow(missing_docs, reason = "criterion's macros make public functions")]

mod common;

use criterion::{Criterion, SamplingMode, criterion_group, criterion_main};
use cutis_gpu::{Adapters, GpuRenderer};
use cutis_render::{Aov, CpuRenderer, Frame, Renderer, Settings, Silent, TechniqueName};
use cutis_scene::validation::SCENES;
use cutis_scene::{Scene, read_picture};
use std::path::Path;
use std::time::{Duration, Instant};

/// Samples of the profile; a quarter as many fill the disc.
const SAMPLES: [u32; 9] = [1, 2, 4, 8, 16, 32, 64, 128, 256];
/// Textures of texture-space, texels.
const TEXTURES: [u32; 4] = [256, 512, 1024, 2048];
/// Frames of which the quickest is told.
const FRAMES: usize = 5;
/// The scene whose truth is kept, and the size of its pictures.
const JUDGED: (&str, u32) = ("head-front", 96);
/// Pixels that are drawn for one of them, in a row.
const FINER: u32 = 4;

/// What is compared, and by which number of it.
fn rivals() -> Vec<(String, Settings)> {
    let by_samples = |samples: u32| (format!("image-space, {samples} samples"), sampled(samples));
    let spread =
        |size: u32| (format!("texture-space, {size}²"), Settings { irradiance_size: size, ..common() });
    let usual = |technique: TechniqueName| (technique.to_string(), Settings { technique, ..common() });
    let others = [TechniqueName::Wrap, TechniqueName::DepthAbsorption, TechniqueName::TextureBlur].map(usual);
    others.into_iter().chain(TEXTURES.map(spread)).chain(SAMPLES.map(by_samples)).collect()
}

fn sampled(samples: u32) -> Settings {
    let mut settings = Settings { technique: TechniqueName::ImageSpace, ..common() };
    settings.techniques.image_space.samples = samples;
    settings.techniques.image_space.uniform_samples = samples / 4;
    settings
}

/// One sample a pixel; shadows and openness from textures of 1024².
fn common() -> Settings {
    Settings { width: 500, height: 500, samples_per_pixel: 1, irradiance_size: 1024, ..Settings::default() }
}

/// The scan; none without the assets.
fn scan() -> Option<Scene> {
    let scene = SCENES.iter().find(|scene| scene.name == JUDGED.0).expect("is among them");
    scene.make().inspect_err(|error| eprintln!("{error}: nothing is measured")).ok()
}

fn frames(criterion: &mut Criterion) {
    let Some(scene) = scan() else { return };
    let mut group = criterion.benchmark_group("techniques, 500 x 500");
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    group.warm_up_time(Duration::from_secs(1)).measurement_time(Duration::from_secs(5));
    for (name, settings) in rivals() {
        group.bench_function(format!("cpu, {name}"), |b| b.iter(|| draw(&scene, &settings)));
    }
    group.finish();
}

fn draw(scene: &Scene, settings: &Settings) -> Frame {
    CpuRenderer.render(scene, settings, &Silent).expect("draws")
}

/// What the documents quote.
fn tables() {
    if !common::reports_wanted() {
        return;
    }
    let Some(scene) = scan() else { return };
    let renderer = GpuRenderer::new(Adapters::Any);
    let truth = truth();
    let adapter = renderer.as_ref().map_or("no adapter".to_owned(), GpuRenderer::adapter);
    eprintln!(
        "\n| technique | processor, ms | of it by the technique | {adapter}, ms a frame | relative RMSE | grain |"
    );
    eprintln!("|---|---:|---:|---:|---:|---:|");
    let smooth = judged(&scene, &sampled(1024));
    for (name, settings) in rivals() {
        let (whole, own) = on_the_processor(&scene, &settings);
        let on_adapter = renderer
            .as_ref()
            .map_or_else(|_| "–".to_owned(), |renderer| on_the_adapter(renderer, &scene, &settings));
        let light = judged(&scene, &settings);
        let error = 100.0 * apart(&averaged(&light), &truth);
        let grain = match settings.technique {
            TechniqueName::ImageSpace => format!("{:.2} %", 100.0 * apart(&light, &smooth)),
            _ => "–".to_owned(),
        };
        eprintln!("| {name} | {whole:.0} | {own:.0} | {on_adapter} | {error:.2} % | {grain} |");
    }
}

/// Milliseconds of the quickest picture, and those of them in passes that are the technique's own or look at the picture.
fn on_the_processor(scene: &Scene, settings: &Settings) -> (f64, f64) {
    let timed = || {
        let start = Instant::now();
        let frame = draw(scene, settings);
        (start.elapsed(), frame)
    };
    let (whole, frame) = (0..3).map(|_| timed()).min_by_key(|(time, _)| *time).expect("three were drawn");
    let own = ["blur", "links", "heat flow", "transmission", "irradiance image", "resolve"];
    let own: Duration =
        frame.passes.iter().filter(|pass| own.contains(&pass.name.as_str())).map(|pass| pass.time).sum();
    (whole.as_secs_f64() * 1e3, own.as_secs_f64() * 1e3)
}

/// Milliseconds of the quickest frame of a scene that is there.
fn on_the_adapter(renderer: &GpuRenderer, scene: &Scene, settings: &Settings) -> String {
    let ready = renderer.scene(scene, settings, &Silent).expect("is uploaded");
    let timed = || {
        let start = Instant::now();
        ready.draw(&renderer.gpu).expect("is drawn");
        renderer.gpu.wait().expect("the device is there");
        start.elapsed()
    };
    // The first one meets shaders that were never run.
    let quickest = (0..=FRAMES).map(|_| timed()).min().expect("some were drawn");
    format!("{:.0}", quickest.as_secs_f64() * 1e3)
}

/// Light from below the surface in the kept truth: what the picture has beside the specular layer.
fn truth() -> Vec<f64> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../truth/{}.exr", JUDGED.0));
    let layer = |name: Option<&str>| read_picture(&path, name).expect("the truth is kept").pixels;
    let specular = layer(Some(&Aov::Specular.to_string()));
    let pairs = layer(None).into_iter().zip(specular);
    pairs.flat_map(|(all, part)| (all - part).truncate().to_array()).map(f64::from).collect()
}

/// Light from below the surface in a picture four times as wide and high as the truth.
fn judged(scene: &Scene, settings: &Settings) -> Vec<f64> {
    let side = FINER * JUDGED.1;
    let settings = Settings {
        width: side,
        height: side,
        shadow_samples: 16,
        aovs: vec![Aov::Specular],
        ..settings.clone()
    };
    let frame = draw(scene, &settings);
    let pairs = frame.pixels.iter().zip(&frame.layers[0].pixels);
    pairs.flat_map(|(all, part)| (*all - *part).truncate().to_array()).map(f64::from).collect()
}

/// The same at the size of the truth: the mean of each block of pixels.
fn averaged(light: &[f64]) -> Vec<f64> {
    let (side, finer) = (JUDGED.1 as usize, FINER as usize);
    let mut mean = vec![0.0; 3 * side * side];
    for (i, value) in light.iter().enumerate() {
        let (x, y, channel) = (i / 3 % (side * finer), i / 3 / (side * finer), i % 3);
        mean[3 * (y / finer * side + x / finer) + channel] += value / (finer * finer) as f64;
    }
    mean
}

/// Root of the mean square of the differences over that of the second.
fn apart(light: &[f64], reference: &[f64]) -> f64 {
    let off: f64 = light.iter().zip(reference).map(|(light, wanted)| (light - wanted).powi(2)).sum();
    (off / reference.iter().map(|wanted| wanted * wanted).sum::<f64>()).sqrt()
}

criterion_group!(benches, frames);
criterion_main!(benches, tables);
