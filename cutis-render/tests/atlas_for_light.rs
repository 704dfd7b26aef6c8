//! Maps of the material lie where texture coordinates say; light lies in the atlas.

use cutis_render::{Aov, AovSpace, CpuRenderer, Frame, Renderer, Settings, Silent, TechniqueName};
use cutis_scene::validation::maps::repeated_and_written_out;
use glam::Vec4;

/// Both ways to tell of the body, as one technique draws them.
fn drawn(technique: TechniqueName, settings: Settings) -> [Frame; 2] {
    let settings = Settings { technique, width: 72, height: 72, irradiance_size: 256, ..settings };
    repeated_and_written_out().map(|scene| CpuRenderer.render(&scene, &settings, &Silent).expect("draws"))
}

/// Largest difference, as a part of what is there and of the mean; the mean.
fn worst_and_mean(got: &[Vec4], wanted: &[Vec4]) -> (f32, f32) {
    let grey = |p: &Vec4| p.truncate().element_sum() / 3.0;
    let mean = wanted.iter().map(grey).sum::<f32>() / wanted.len() as f32;
    let off = |(a, b): (&Vec4, &Vec4)| grey(&(*a - *b).abs()) / (mean + grey(b));
    (got.iter().zip(wanted).map(off).fold(0.0, f32::max), mean)
}

#[test]
fn maps_that_repeat_are_maps_written_out() {
    for &technique in TechniqueName::ALL.iter().filter(|&&name| name != TechniqueName::Truth) {
        let [repeated, written] = drawn(technique, Settings::default());
        let (worst, mean) = worst_and_mean(&repeated.pixels, &written.pixels);
        eprintln!("{technique:?}: {worst}, the mean is {mean}");
        assert!(mean > 0.01 && worst < 3e-4, "{technique:?}: {worst}, the mean is {mean}");
    }
}

#[test]
fn so_are_layers_in_texture_space() {
    for aov in [Aov::Irradiance, Aov::Stretch, Aov::Blur(3)] {
        let settings = Settings { aovs: vec![aov], aov_space: AovSpace::Texture, ..Settings::default() };
        let [repeated, written] = drawn(TechniqueName::TextureSpace, settings).map(|frame| frame.layers);
        let (worst, mean) = worst_and_mean(&repeated[0].pixels, &written[0].pixels);
        assert!(mean > 0.01 && worst < 3e-4, "{aov:?}: {worst}, the mean is {mean}");
    }
}

/// Paths part where rounding decides, which is rare.
#[test]
fn so_they_are_for_the_truth() {
    let settings = Settings { samples_per_pixel: 4, ..Settings::default() };
    let [repeated, written] = drawn(TechniqueName::Truth, settings.clone());
    alike(&repeated.pixels, &written.pixels);
    let in_texture = Settings { aovs: vec![Aov::Exitance], aov_space: AovSpace::Texture, ..settings };
    let [repeated, written] = drawn(TechniqueName::Truth, in_texture).map(|frame| frame.layers);
    alike(&repeated[0].pixels, &written[0].pixels);
}

/// Checks that what is lit is the same, but for one place in ten.
fn alike(got: &[Vec4], wanted: &[Vec4]) {
    let lit = || got.iter().zip(wanted).filter(|(_, b)| b.x > 0.0);
    let same = lit().filter(|(a, b)| (**a - **b).abs().max_element() < 1e-3 * b.max_element()).count();
    assert!(lit().count() > 500 && same * 10 > lit().count() * 9, "{same} of {} are alike", lit().count());
}
