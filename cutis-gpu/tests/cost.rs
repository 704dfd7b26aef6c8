//! What a frame is said to cost and to keep, against sizes worked out by hand.

mod common;

use common::{patch, patch_under_a_spot, renderer};
use cutis_gpu::cost::{Cost, by_pass, total};
use cutis_render::{Diffusion, Settings, Silent};

/// Texels of the irradiance, and of the maps of the light: the smallest there is.
const SIZE: u64 = 256;

fn settings() -> Settings {
    Settings {
        width: 32,
        height: 16,
        samples_per_pixel: 4,
        irradiance_size: SIZE as u32,
        diffusion: Diffusion::Separable,
        ..Settings::default()
    }
}

#[test]
fn passes_move_what_their_maps_hold() {
    let Some(renderer) = renderer("passes_move_what_their_maps_hold") else { return };
    let scene = patch_under_a_spot(patch(|u| 40.0 * u, |v| 40.0 * v));
    let ready = renderer.scene(&scene, &settings(), &Silent).expect("is uploaded");
    let costs = ready.costs();
    let passes = by_pass(&costs);
    let pass = |name: &str| *passes.iter().find(|cost| cost.pass == name).expect("is part of a frame");
    let texels = SIZE * SIZE;
    // Four bytes of fractions, eight of distances.
    assert_eq!(pass("shadows").written_bytes, texels * (4 + 8));
    assert_eq!(pass("irradiance").written_bytes, texels * 8);
    assert_eq!(pass("downsample").written_bytes, 32 * 16 * 8);
    assert_eq!(pass("downsample").taps, 32 * 16 * 4);
    // The samples, and the number of them in 16 bytes.
    assert_eq!(pass("downsample").read_bytes, 4 * 32 * 16 * 8 + 16);
    // Depth and what faces the light, and the buffer that decides which is nearest.
    assert_eq!(pass("shadow map").written_bytes, texels * (4 + 8 + 4));
    // Along an axis: light of eight bytes in, variances of four, light out.
    let blur = pass("blur");
    assert!(blur.read_bytes > blur.written_bytes && blur.read_bytes < 2 * blur.written_bytes, "{blur:?}");
    let sum = total(&costs);
    assert_eq!(sum.written_bytes, costs.iter().map(|cost: &Cost| cost.written_bytes).sum::<u64>());
}

#[test]
fn a_scene_keeps_what_its_maps_hold() {
    let Some(renderer) = renderer("a_scene_keeps_what_its_maps_hold") else { return };
    let scene = patch_under_a_spot(patch(|u| 40.0 * u, |v| 40.0 * v));
    let kept = |width: u32| {
        let settings = Settings { width, ..settings() };
        renderer.scene(&scene, &settings, &Silent).expect("is uploaded").memory_bytes()
    };
    // Four samples of light and depth, and the pixel: 8 and 4 bytes each, and 8.
    assert_eq!(kept(64) - kept(32), 32 * 16 * (4 * (8 + 4) + 8));
    // Per texel: atlas 16 + 8 + 8, triangles 8, charts 4, light in 8, distance 8, visibility 4, sum 8; the light's two maps
    // and its depth 4 + 8 + 4. Blurred maps and their variances come on top, at most 40 more for each of six Gaussians.
    let (texels, known) = (SIZE * SIZE, 16 + 8 + 8 + 8 + 4 + 8 + 8 + 4 + 8 + 16);
    let kept = kept(32);
    assert!(kept > texels * known && kept < texels * (known + 6 * 40), "{kept} for {texels} texels");
}
