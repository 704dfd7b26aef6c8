//! Layers, and media and reliefs that differ from pixel to pixel.

use crate::scenes::{draw, exitances, mean, medium, plane, settings, sun, white};
use cutis_optics::{Dipole, Medium, Profile, Stack, TissueLayer};
use cutis_render::prepare::radial::RadialKernel;
use cutis_render::technique::image_space::{ImageSpaceSettings, SampleCount};
use cutis_render::{Aov, Settings, TechniqueName};
use cutis_scene::{
    Material, NormalMap, NormalSpace, ScalarMap, Scattering, Scene, SecondMedium, Texels, Texture,
};
use glam::Vec3;
use std::f32::consts::FRAC_1_SQRT_2;
use std::sync::Arc;

fn dark() -> Medium {
    Medium::new(1.5, 0.8, 1.3).expect("is physical")
}

/// A plane seen from above, of so many columns of a map.
fn plane_of(columns: Vec<[f32; 4]>, material: impl Fn(Arc<Texture>) -> Material) -> Scene {
    let texture = Texture::new(columns.len() as u32, 1, Texels::LinearF32(columns));
    let mut scene = plane(material(Arc::new(texture)), Vec3::Z * 1000.0, sun(1.0));
    // The picture is as wide as the plane.
    scene.camera.vertical_fov_rad = 0.199;
    scene
}

/// Mean of four by four pixels, which have a share between them, at a part of the width.
fn at(pixels: &[Vec3], part: f32) -> Vec3 {
    let first = (part * 48.0) as usize / 4 * 4;
    let block = (24..28).flat_map(|y| (first..first + 4).map(move |x| pixels[y * 48 + x]));
    block.sum::<Vec3>() / 16.0
}

/// Under even light each place sends back the diffuse reflectance of the mixture that a map says it is, without noise where
/// samples follow a single profile.
#[test]
fn every_place_is_of_the_mixture_that_the_map_says() {
    let columns = [0.0, 0.0, 0.0, 0.5, 0.5, 0.5, 1.0, 1.0, 1.0].map(|share| [0.25, share, 0.0, 1.0]);
    let scene = plane_of(columns.to_vec(), |map| {
        let share = ScalarMap { offset: 0.0, gain: 1.0, texture: Some((map, 1)) };
        let second = SecondMedium { scattering: Scattering::Medium([dark(); 3]), share };
        Material { mixed_with: Some(second), ..white(Scattering::Medium([medium(); 3])) }
    });
    let own =
        ImageSpaceSettings { uniform_samples: 0, count: SampleCount::All, ..ImageSpaceSettings::default() };
    let pixels = exitances(&draw(&scene, &settings(own)));
    for (part, share) in [(0.17, 0.0), (0.5, 0.5), (0.83, 1.0)] {
        let expected = Dipole::new(&medium().mixed(&dark(), share)).expect("is physical").total() as f32;
        let found = at(&pixels, part).x;
        eprintln!("share {share}: {found}, expected {expected}");
        // The table holds R to 1e-4; half way two neighbours stand for the mixture between them.
        assert!((found / expected - 1.0).abs() < 3e-3, "{share}: {found} against {expected}");
    }
    // Of the marble that is shipped little of the vein takes away much of the light.
    let medium = |sigma_a| Medium::new(sigma_a, 2.19, 1.5).expect("is physical");
    let [marble, vein] = [0.0021, 0.3].map(medium);
    for share in [0.005f32, 1.0 / 30.0, 0.2, 0.9] {
        let scattering = Scattering::Medium([vein; 3]);
        let second = SecondMedium { scattering, share: ScalarMap::constant(share) };
        let material = Material { mixed_with: Some(second), ..white(Scattering::Medium([marble; 3])) };
        let pixels = exitances(&draw(&plane(material, Vec3::Z * 1000.0, sun(1.0)), &settings(own)));
        let mixed = marble.mixed(&vein, f64::from(share));
        let expected = Dipole::new(&mixed).expect("is physical").total() as f32;
        let found = at(&pixels, 0.5).x;
        eprintln!("marble, share {share}: {found}, expected {expected}");
        assert!((found / expected - 1.0).abs() < 0.01, "{share}: {found} against {expected}");
    }
    let other =
        Settings { technique: TechniqueName::TextureSpace, ..settings(ImageSpaceSettings::default()) };
    let told =
        |settings| draw(&scene, &settings).warnings.iter().any(|words| words.contains("second medium"));
    assert!(told(other) && !told(settings(ImageSpaceSettings::default())));
}

/// A thin absorbing layer over a clearer one, as of skin; blue does not get far.
fn skin_of_two_layers() -> [Vec<TissueLayer>; 3] {
    let layer = |a, s, thickness_mm| TissueLayer {
        medium: Medium::new(a, s, 1.4).expect("is physical"),
        thickness_mm,
    };
    [[0.1, 0.02], [0.25, 0.1], [0.8, 0.4]]
        .map(|[a, b]| vec![layer(a, 4.8, 0.5), layer(b, 2.4, f64::INFINITY)])
}

/// Layers are sampled by their own profile, not by Gaussians that were fitted to it.
#[test]
fn layers_are_sampled_as_they_are() {
    let material = white(Scattering::Layers(skin_of_two_layers()));
    let stacks = skin_of_two_layers().map(|layers| Stack::in_air(&layers).expect("is physical"));
    let picture = settings(ImageSpaceSettings::default());
    let kernel = RadialKernel::new(&material, &picture).expect("can be sampled");
    for r_mm in [0.01, 0.1, 0.4, 1.0, 3.0, 9.0] {
        let found = kernel.at_mm(r_mm);
        for (channel, stack) in stacks.iter().enumerate() {
            // The kernel has the total of the fit, which keeps it to 1e-3 or so; the rest is interpolation.
            let expected = stack.at_mm(f64::from(r_mm)) as f32;
            let off = (found[channel] - expected).abs();
            assert!(
                off < 4e-3 * expected + 1e-6,
                "{r_mm} mm, {channel}: {} against {expected}",
                found[channel]
            );
        }
    }
    let own = ImageSpaceSettings { samples: 256, count: SampleCount::All, ..ImageSpaceSettings::default() };
    let pixels = exitances(&draw(&plane(material, Vec3::Z * 1000.0, sun(1.0)), &settings(own)));
    let totals = stacks.map(|stack| stack.total() as f32);
    // The middle, whose samples do not meet the border of the image.
    let middle: Vec<Vec3> =
        (16..32).flat_map(|y| (16..32).map(move |x| y * 48 + x)).map(|i| pixels[i]).collect();
    let found = mean(&middle);
    eprintln!("layers: {found}, expected {totals:?}");
    // Samples are drawn by the mean of three profiles; their noise is that of 80,000.
    assert!(
        (found / Vec3::from_array(totals) - 1.0).abs().max_element() < 5e-3,
        "{found} against {totals:?}"
    );
}

/// Under a layer of a quarter of its mean free path light comes out again beyond a ring that takes some away; and it is told that
/// the model is not made for it.
#[test]
fn light_beyond_a_thin_layer_s_ring_is_found() {
    let layer = |s, thickness_mm| TissueLayer {
        medium: Medium::new(0.05, s, 1.4).expect("is physical"),
        thickness_mm,
    };
    let thin = vec![layer(5.0, 0.05), layer(1.0, f64::INFINITY)];
    // One channel of them: every value of its profile is an integral of many waves.
    let thick = vec![layer(5.0, 2.0), layer(1.0, f64::INFINITY)];
    let total = Stack::in_air(&thin).expect("is physical").total() as f32;
    let scene = plane(white(Scattering::Layers([thin, thick.clone(), thick])), Vec3::Z * 1000.0, sun(1.0));
    let own = ImageSpaceSettings { samples: 512, count: SampleCount::All, ..ImageSpaceSettings::default() };
    let frame = draw(&scene, &settings(own));
    let pixels = exitances(&frame);
    let middle: Vec<Vec3> =
        (16..32).flat_map(|y| (16..32).map(move |x| y * 48 + x)).map(|i| pixels[i]).collect();
    let found = mean(&middle).x;
    eprintln!("thin layer: {found}, expected {total}");
    assert!((found / total - 1.0).abs() < 0.02, "{found} against {total}");
    assert!(
        frame.warnings.iter().any(|words| words.contains("layer 1: a slab of 0.05 mm")),
        "{:?}",
        frame.warnings
    );
}

/// A relief that tilts half of the plane by 45 degrees takes in as much less light.
#[test]
fn a_relief_turns_the_light_that_enters() {
    let tilted = [0.5 + 0.5 * FRAC_1_SQRT_2, 0.5, 0.5 + 0.5 * FRAC_1_SQRT_2, 1.0];
    let even = [0.5, 0.5, 1.0, 1.0];
    let scene = plane_of(vec![even, even, even, tilted, tilted, tilted], |texture| Material {
        normal: Some(NormalMap { texture, space: NormalSpace::Object, strength: 1.0 }),
        ..white(Scattering::Medium([medium(); 3]))
    });
    let own =
        ImageSpaceSettings { uniform_samples: 0, count: SampleCount::All, ..ImageSpaceSettings::default() };
    let pixels = exitances(&draw(&scene, &settings(own)));
    let [upright, aslant] = [0.2, 0.8].map(|part| at(&pixels, part).x);
    assert!((aslant / upright - FRAC_1_SQRT_2).abs() < 1e-3, "{aslant} of {upright}");
}

/// Gloss is that of the other techniques, pixel by pixel.
#[test]
fn a_gloss_map_shines_as_under_other_techniques() {
    let columns = [[0.0, 0.1, 0.0, 1.0], [1.0, 0.6, 0.0, 1.0]].to_vec();
    let mut scene = plane_of(columns, |map| Material {
        rho_s: ScalarMap { offset: 0.0, gain: 1.0, texture: Some((map.clone(), 0)) },
        roughness: ScalarMap { offset: 0.0, gain: 1.0, texture: Some((map, 1)) },
        ..white(Scattering::Medium([medium(); 3]))
    });
    scene.camera.position_mm = Vec3::new(0.0, -700.0, 700.0);
    let shine = |technique| {
        let settings = settings(ImageSpaceSettings::default());
        exitances(&draw(&scene, &Settings { technique, aovs: vec![Aov::Specular], ..settings }))
    };
    let [ours, others] = [TechniqueName::ImageSpace, TechniqueName::TextureSpace].map(shine);
    assert_eq!(ours, others);
    let brightest = ours.iter().fold(0.0f32, |most, s| most.max(s.x));
    assert!(brightest > 0.0 && ours.iter().any(|s| s.x < 0.01 * brightest), "{brightest}");
}
