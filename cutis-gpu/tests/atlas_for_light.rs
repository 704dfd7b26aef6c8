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
        let mut all: Vec<f32> = repeated.iter().zip(&written).map(off).collect();
        all.sort_by(f32::total_cmp);
        let (usual, p99) = (all.iter().sum::<f32>() / all.len() as f32, all[all.len() * 99 / 100]);
        eprintln!("{technique:?}: {usual}, 99 of 100 at most {p99}, the mean is {mean}");
        assert!(mean > 0.01, "{technique:?}: there is a picture");
        // Filters place a read between texels in 8 bits; of two media a pixel may take the other one for that.
        assert!(usual < 1e-3 && p99 < 0.02, "{technique:?}: {usual}, 99 of 100 at most {p99}");
    }
}
