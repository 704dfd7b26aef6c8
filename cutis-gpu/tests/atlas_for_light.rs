//! Maps of the material lie where texture coordinates say; light lies in the atlas: the twin of cutis-render's test.

mod common;

use common::renderer;
use cutis_render::{Renderer, Settings, Silent, TechniqueName};
use cutis_scene::validation::maps::repeated_and_written_out;
use glam::Vec4;

#[test]
fn maps_that_repeat_are_maps_written_out() {
    let Some(renderer) = renderer("maps_that_repeat_are_maps_written_out") else { return };
    for &technique in TechniqueName::ALL.iter().filter(|&&name| name != TechniqueName::Truth) {
        let settings =
            Settings { technique, width: 72, height: 72, irradiance_size: 256, ..Settings::default() };
        let [repeated, written] = repeated_and_written_out()
            .map(|scene| renderer.render(&scene, &settings, &Silent).expect("draws").pixels);
        let grey = |p: &Vec4| p.truncate().element_sum() / 3.0;
        let mean = written.iter().map(grey).sum::<f32>() / written.len() as f32;
        let off = |(a, b): (&Vec4, &Vec4)| grey(&(*a - *b).abs()) / (mean + grey(b));
        let worst = repeated.iter().zip(&written).map(off).fold(0.0, f32::max);
        eprintln!("{technique:?}: {worst}, the mean is {mean}");
        assert!(mean > 0.01, "{technique:?}: there is a picture");
        // Filters place a read between texels in 8 bits.
        assert!(worst < 0.02, "{technique:?}: {worst}");
    }
}
