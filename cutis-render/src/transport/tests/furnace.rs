//! A body that absorbs nothing, in the same light from everywhere, is seen as bright as that light: it cannot be seen.

use super::{ball, cuboid, even_environment, material, scanned_head, scene_of, seen_from_everywhere};
use crate::transport::estimate::Estimate;
use glam::{DVec3, Vec3};

/// Where rays come from, and how far around the middle they aim.
const BALL_MM: [f64; 2] = [200.0, 3.0];
const HEAD_MM: [f64; 2] = [1000.0, 150.0];

/// Three standard errors, a false alarm in 370 for each rough body (its channels are alike). Through a sharp surface no light
/// is asked for: every path ends in the same light, and not one may be lost. 1e-5 is for rounding: a path has at most some
/// 10,000 steps of 1e-16 in double precision, and the light is stored in single.
fn assert_vanished(name: &str, is_sharp: bool, seen: &Estimate) {
    let (off, error) = ((seen.mean() - 1.0).abs(), seen.standard_error());
    eprintln!("{name}: {:.5} ± {:.5}", seen.mean().x, error.x);
    let noise = if is_sharp { DVec3::ZERO } else { error * 3.0 };
    assert!(off.cmple(noise + 1e-5).all(), "{name}: {off} {error}");
}

#[test]
fn a_white_body_vanishes_in_a_white_furnace() {
    for roughness in [0.0, 0.3, 0.7] {
        for index in [1.0, 1.3, 1.5] {
            let white = || material(0.0, 1.0, index, roughness);
            for object in [ball(6.0, 16, white()), cuboid(Vec3::new(5.0, 3.0, 4.0), white())] {
                let name = object.name.clone();
                let scene = scene_of(vec![object], vec![], Some(even_environment()));
                let seen = seen_from_everywhere(&scene, DVec3::ZERO, BALL_MM, 4000);
                assert_vanished(
                    &format!("{name} index {index} roughness {roughness}"),
                    roughness == 0.0 || index == 1.0,
                    &seen,
                );
            }
        }
    }
}

#[test]
fn a_body_that_absorbs_is_darker_than_the_furnace() {
    let scene = scene_of(vec![ball(6.0, 16, material(0.1, 1.0, 1.4, 0.3))], vec![], Some(even_environment()));
    let seen = seen_from_everywhere(&scene, DVec3::ZERO, BALL_MM, 2000).mean();
    assert!(seen.max_element() < 0.8 && seen.min_element() > 0.1, "{seen}");
    assert!((seen - seen.x).abs().max_element() < 1e-9, "channels alike: {seen}");
}

/// The scanned head: nostrils and lips that face each other, long thin triangles, normals that bend.
fn the_head_vanishes(test: &str, paths: u64) {
    for roughness in [0.0, 0.3] {
        for index in [1.0, 1.3, 1.5] {
            // A hundredth of the head's width between two scatterings: it is deep, and light goes all through it.
            let Some(head) = scanned_head(test, material(0.0, 0.25, index, roughness)) else { return };
            let [low, high] = head.mesh.bounds_mm().unwrap();
            let scene = scene_of(vec![head], vec![], Some(even_environment()));
            let seen = seen_from_everywhere(&scene, (low + high).as_dvec3() * 0.5, HEAD_MM, paths);
            assert_vanished(
                &format!("head index {index} roughness {roughness}"),
                roughness == 0.0 || index == 1.0,
                &seen,
            );
        }
    }
}

#[test]
fn a_white_head_vanishes_in_a_white_furnace() {
    the_head_vanishes("a_white_head_vanishes_in_a_white_furnace", 1000);
}

#[test]
#[ignore = "slow suite: a hundred times the paths"]
fn slow_a_white_head_vanishes_in_a_white_furnace() {
    the_head_vanishes("slow_a_white_head_vanishes_in_a_white_furnace", 100_000);
}
