//! A shadow's edge on a flat surface: what leaves across it is the profile, summed over the half plane in the light.

use super::{cuboid, material, scene_of};
use crate::transport::estimate::Estimate;
use crate::transport::exitance::{Entrances, Exit};
use crate::transport::path::Transport;
use cutis_optics::simulate::{Grid, Layer, LayeredSlab, Rings, Simulation};
use cutis_scene::{Light, Scene};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// Half sizes of the block, mm: light that gets 6 mm far has fallen to e^-5, and a hundredth of that comes back up.
const BLOCK_MM: Vec3 = Vec3::new(10.0, 20.0, 6.0);
/// The medium, 1/mm, and its index: 1.2 mm fall by e.
const SIGMA_A: f64 = 0.2;
const SIGMA_S: f64 = 1.0;
const INDEX: f64 = 1.4;
/// Strips along the edge: their width, and how many to each side.
const STRIP_MM: f64 = 0.5;
const STRIPS: usize = 8;
/// Half their length, mm: their ends are 6 mm from those of the light.
const HALF_LENGTH_MM: f64 = 14.0;
/// Width of the rings in which the profile is known, mm, and their number.
const RING_MM: f64 = 0.02;
const RINGS: usize = 600;
/// Batches that the noise is told from: to 9 %.
const BATCHES: u64 = 64;

/// The block under light from straight above, half of it under a black board.
fn half_in_shadow() -> Scene {
    let block = cuboid(BLOCK_MM, material(SIGMA_A, SIGMA_S, INDEX, 0.0));
    // What enters the board never leaves: 10 mean free paths, a thousandth of which scatter.
    let mut board = cuboid(Vec3::new(5.5, 20.5, 0.5), material(10.0, 0.01, 1.0, 0.0));
    for p in &mut board.mesh.positions_mm {
        *p += Vec3::new(-5.5, 0.0, 10.0);
    }
    let light =
        Light::Directional { dir_to_light: Vec3::Z, irradiance_w_per_m2: Vec3::ONE, angular_radius_rad: 0.0 };
    scene_of(vec![block, board], vec![light], None)
}

/// The strip of the upper face in which light left, if it is in one: `STRIPS` in the shadow, then as many in the light.
fn strip_of(scene: &Scene, exit: &Exit) -> Option<usize> {
    let mesh = &scene.objects[0].mesh;
    let [a, ..] = mesh.triangles[exit.triangle as usize];
    let normal = mesh.normals[a as usize];
    if exit.object != 0 || normal != Vec3::Z {
        return None;
    }
    let (u, v) = (normal.any_orthonormal_vector(), normal.cross(normal.any_orthonormal_vector()));
    let [s, t] = (exit.atlas_uv * 2.0 - 1.0).to_array();
    let place_mm = (u * s + v * t) * BLOCK_MM;
    let strip = (f64::from(place_mm.x) / STRIP_MM + STRIPS as f64).floor();
    let inside = f64::from(place_mm.y.abs()) < HALF_LENGTH_MM && strip >= 0.0 && strip < 2.0 * STRIPS as f64;
    inside.then_some(strip as usize)
}

/// Exitance of each strip by packets from the light, W/m², and its standard error from how batches differ.
fn by_packets(scene: &Scene, packets: u64) -> Vec<Estimate> {
    let transport = Transport::new(scene, 1).unwrap();
    let entrances = Entrances::new(&transport);
    let per_batch = packets / BATCHES;
    let per = per_batch as f64 * STRIP_MM * 2.0 * HALF_LENGTH_MM;
    let mut strips = vec![Estimate::default(); 2 * STRIPS];
    for batch in 0..BATCHES {
        let mut flux = [DVec3::ZERO; 2 * STRIPS];
        entrances.walk(17, batch * per_batch, per_batch, |exit| {
            if let Some(strip) = strip_of(scene, exit) {
                flux[strip] += exit.flux / per;
            }
        });
        strips.iter_mut().zip(flux).for_each(|(strip, flux)| strip.add(flux));
    }
    strips
}

/// Share of a circle of radius `r_mm` around a place `x_mm` deep in the light that lies in the light.
fn share_in_light(x_mm: f64, r_mm: f64) -> f64 {
    1.0 - (x_mm / r_mm).clamp(-1.0, 1.0).acos() / PI
}

/// The same exitance from the profile of a flat body, by rings around the middles of tenths of a strip; and its standard
/// error, rings being independent.
fn by_profile(packets: u64) -> Vec<(f64, f64)> {
    let layer = Layer {
        sigma_a_per_mm: SIGMA_A,
        sigma_s_per_mm: SIGMA_S,
        g: 0.0,
        refractive_index: INDEX,
        thickness_mm: f64::from(2.0 * BLOCK_MM.z),
    };
    let rings = Rings::even(RING_MM, RINGS).unwrap();
    let grid = Grid { rings, depth_step_mm: 1.0, depth_bins: 1, cosine_bins: 1 };
    let slab = LayeredSlab::in_air(vec![layer]).unwrap();
    let estimates = Simulation { slab, grid, seed: 5 }.run(packets);
    let (shares, radii_mm) = (estimates.reflectance_by_ring(), estimates.ring_radii_mm());
    let of_strip = |strip: usize| {
        let (mut sum, mut variance) = (0.0, 0.0);
        for (ring, share) in shares.iter().enumerate() {
            // Beyond the last ring half of nearly nothing.
            let lit = radii_mm.get(ring).map_or(0.5, |&r_mm| {
                let at =
                    |tenth: usize| (strip as f64 - STRIPS as f64 + (tenth as f64 + 0.5) / 10.0) * STRIP_MM;
                (0..10).map(|tenth| share_in_light(at(tenth), r_mm)).sum::<f64>() / 10.0
            });
            sum += share.value * lit;
            variance += (share.standard_error * lit).powi(2);
        }
        (sum, variance.sqrt())
    };
    (0..2 * STRIPS).map(of_strip).collect()
}

fn assert_edge(packets: u64) {
    let (found, expected) = (by_packets(&half_in_shadow(), packets), by_profile(packets));
    let (mut chi2, mut sum, mut variance) = (0.0, 0.0, 0.0);
    for (strip, (found, (expected, error))) in found.iter().zip(expected).enumerate() {
        let x_mm = (strip as f64 - STRIPS as f64 + 0.5) * STRIP_MM;
        let (mean, error) = (found.mean().x, found.standard_error().x.hypot(error));
        let apart = (mean - expected) / error;
        eprintln!("{x_mm:+.2} mm: {mean:.5} ± {error:.5} against {expected:.5}, {apart:+.2} errors");
        chi2 += apart * apart;
        sum += mean - expected;
        variance += error * error;
        // 16 strips of 3.5 standard errors: a false alarm in 130 seeds.
        assert!(apart.abs() < 3.5, "{x_mm} mm from the edge: {mean} ± {error} against {expected}");
    }
    let apart = sum / variance.sqrt();
    eprintln!("all strips: {apart:+.2} errors");
    assert!(apart.abs() < 3.0, "all strips: {apart} errors");
    // Strips share no exits: their squared errors add up to 16, with a deviation of sqrt(32). Three of these.
    let count = 2.0 * STRIPS as f64;
    assert!(chi2 < count + 3.0 * (2.0 * count).sqrt(), "chi² {chi2} of {count} strips");
}

#[test]
fn across_a_shadow_s_edge_the_profile_is_summed_over_half_the_plane() {
    assert_edge(1_200_000);
}

#[test]
#[ignore = "slow suite: ten times the packets"]
fn slow_across_a_shadow_s_edge_the_profile_is_summed_over_half_the_plane() {
    assert_edge(12_000_000);
}
