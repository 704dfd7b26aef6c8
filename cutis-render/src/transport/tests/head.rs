//! The scanned head in the light of a lamp: what leaves, region by region, from packets of the lamp and from paths of the eye.
//!
//! At the texels the map is asked for their middles, from the lamp for their means. Both are averaged over squares of many
//! texels that lie wholly inside of a chart; texels at seams, where the middle may lie beside the surface, are left out.

use super::{scanned_head, scene_of};
use crate::Silent;
use crate::passes::atlas::{Atlas, NO_CHART};
use crate::settings::Settings;
use crate::technique::truth::{ExitanceMap, Start};
use crate::transport::path::Transport;
use cutis_scene::{ColourMap, Light, Material, ScalarMap, Scattering, Scene};
use glam::{DVec3, Vec3};

/// Texels along a side of the map, and along a side of a region.
const SIZE: usize = 256;
const REGION: usize = 32;
/// Texels that a region must hold.
const TEXELS_MIN: usize = 200;
/// Light that a region must have, over the mean of all.
const LIT: f64 = 0.1;

fn head_and_lamp(test: &str) -> Option<Scene> {
    let material = Material {
        scattering: Scattering::Preset("skin1".to_owned()),
        albedo: ColourMap { factor: Vec3::ONE, texture: None },
        roughness: ScalarMap::constant(0.3),
        ..Material::default()
    };
    // From the front left and above, as large as a soft box: no texel is half in its shadow for long.
    let lamp = Light::Point {
        position_mm: Vec3::new(-420.0, 380.0, 700.0),
        intensity_w_per_sr: Vec3::splat(1.0),
        radius_mm: 150.0,
    };
    Some(scene_of(vec![scanned_head(test, material)?], vec![lamp], None))
}

/// Texels whose eight neighbours are of the same chart.
fn inner_texels(atlas: &Atlas) -> Vec<usize> {
    let chart = |x: usize, y: usize| atlas.charts.chart[y * SIZE + x];
    let inside = |texel: &usize| {
        let (x, y) = (texel % SIZE, texel / SIZE);
        let own = chart(x, y);
        let margin = 1..SIZE - 1;
        own != NO_CHART
            && margin.contains(&x)
            && margin.contains(&y)
            && (x - 1..=x + 1).all(|x| (y - 1..=y + 1).all(|y| chart(x, y) == own))
    };
    (0..SIZE * SIZE).filter(inside).collect()
}

/// Mean exitance of some texels and its standard error.
fn mean_of(map: &ExitanceMap, texels: &[usize]) -> (DVec3, DVec3) {
    let count = texels.len() as f64;
    let sum: DVec3 = texels.iter().map(|&t| map.exitance_w_per_m2[t]).sum();
    let variance: DVec3 = texels.iter().map(|&t| map.standard_error_w_per_m2[t].powf(2.0)).sum();
    (sum / count, variance.powf(0.5) / count)
}

fn assert_regions_alike(test: &str, samples: u32) {
    let Some(scene) = head_and_lamp(test) else { return };
    let transport = Transport::new(&scene, 1).unwrap();
    let map = |start| {
        let settings = Settings {
            irradiance_size: SIZE as u32,
            samples_per_pixel: samples,
            seed: 7,
            ..Settings::default()
        };
        ExitanceMap::starting(start, &transport, &settings, &Silent)
    };
    let (from_lamp, from_texels) = (map(Start::Light), map(Start::Texel));
    let inner = inner_texels(&Atlas::new(&scene.objects[0], SIZE));
    let per_side = SIZE / REGION;
    let region_of = |texel: usize| texel / SIZE / REGION * per_side + texel % SIZE / REGION;
    let overall = inner.iter().map(|&t| from_lamp.exitance_w_per_m2[t].x).sum::<f64>() / inner.len() as f64;
    let (mut compared, mut chi2) = (0.0, 0.0);
    for region in 0..per_side * per_side {
        let texels: Vec<usize> = inner.iter().copied().filter(|&t| region_of(t) == region).collect();
        if texels.len() < TEXELS_MIN {
            continue;
        }
        let ((a, a_error), (b, b_error)) = (mean_of(&from_lamp, &texels), mean_of(&from_texels, &texels));
        // In the dark, exits are too few to know how far they may be off.
        if a.x.max(b.x) < LIT * overall {
            continue;
        }
        let error = (a_error.powf(2.0) + b_error.powf(2.0)).powf(0.5);
        let apart = (a - b) / error;
        eprintln!("region {region} of {} texels: {a:.5} and {b:.5}, {apart:+.2} errors", texels.len());
        compared += 1.0;
        chi2 += apart.x * apart.x;
        // Some 20 regions of 3 channels, four standard errors: a false alarm in 260 seeds.
        assert!(apart.abs().cmple(DVec3::splat(4.0)).all(), "region {region}: {a} and {b}, {apart} errors");
    }
    eprintln!("chi² {chi2:.1} of {compared} regions");
    assert!(compared > 12.0, "there are regions: {compared}");
    assert!(chi2 < compared + 3.0 * f64::sqrt(2.0 * compared), "chi² {chi2} of {compared} regions");
}

#[test]
fn the_head_is_lit_alike_from_the_lamp_and_from_the_texels() {
    assert_regions_alike("the_head_is_lit_alike_from_the_lamp_and_from_the_texels", 2);
}

#[test]
#[ignore = "slow suite: sixteen times the samples"]
fn slow_the_head_is_lit_alike_from_the_lamp_and_from_the_texels() {
    assert_regions_alike("slow_the_head_is_lit_alike_from_the_lamp_and_from_the_texels", 32);
}
