//! What must hold of the built-in head.

#![allow(clippy::unwrap_used, reason = "tests")]

use super::*;
use crate::topology::edges;
use crate::{Bvh, Charts};
use glam::Vec2;
use std::sync::LazyLock;

fn plain(triangles: usize) -> Object {
    built_in(HeadDetail { triangles, map_size: 0 })
}

/// Twice the unwrapped mesh, so that refinement has had something to do.
static FINE: LazyLock<Object> = LazyLock::new(|| plain(48_000));
/// Coarser than the unwrapped mesh of the default.
static COARSE: LazyLock<Object> = LazyLock::new(|| plain(10_000));

#[test]
fn the_head_is_one_closed_body_without_holes_through_it() {
    for head in [&*COARSE, &*FINE] {
        assert!(head.closed);
        let points = *head.point_of_vertex.iter().max().unwrap() as i64 + 1;
        let edges = edges(&head.mesh, &head.point_of_vertex).len() as i64;
        // Euler characteristic 2: a sphere, so nostrils, ears and the cut of the neck are mere dents.
        assert_eq!(points - edges + head.mesh.triangles.len() as i64, 2);
    }
}

#[test]
fn triangle_counts_are_met() {
    assert!(COARSE.mesh.triangles.len().abs_diff(10_000) <= 1, "{}", COARSE.mesh.triangles.len());
    assert!(FINE.mesh.triangles.len().abs_diff(48_000) <= 1, "{}", FINE.mesh.triangles.len());
}

#[test]
fn the_head_has_the_size_of_a_head() {
    let mesh = &FINE.mesh;
    let extent = |axis: Vec3, keep: &dyn Fn(&Vec3) -> bool| {
        let along = mesh.positions_mm.iter().filter(|p| keep(p)).map(|p| p.dot(axis));
        along.fold((f32::MAX, f32::MIN), |(lo, hi), x| (lo.min(x), hi.max(x)))
    };
    // Chin: the lowest place in front of the throat.
    let (chin, _) = extent(Vec3::Y, &|p| p.z > 70.0);
    let (_, vertex) = extent(Vec3::Y, &|_| true);
    assert!((vertex - chin - 230.0).abs() < 6.0, "height {}", vertex - chin);
    let (left, right) = extent(Vec3::X, &|p| p.y > 30.0);
    assert!((right - left - 155.0).abs() < 6.0, "breadth {}", right - left);
    let (back, front) = extent(Vec3::Z, &|p| p.y > 8.0);
    assert!((front - back - 195.0).abs() < 8.0, "depth {}", front - back);
}

/// Distance between the first two surfaces along a ray into the head.
fn thickness_mm(bvh: &Bvh, origin: Vec3, dir: Vec3) -> f32 {
    let first = bvh.closest(origin, dir, 100.0).unwrap().distance_mm;
    // A hundredth of a millimetre further, to be past the surface just met.
    bvh.closest(origin + dir * (first + 0.01), dir, 100.0).unwrap().distance_mm + 0.01
}

#[test]
fn the_rim_of_the_ear_is_thin_enough_to_glow() {
    let sculpture = Sculpture::new();
    let bvh = Bvh::build(std::slice::from_ref(&*FINE));
    let at = |u, v, w| sculpture.ear.world(Vec3::new(u, v, w));
    // Through the rim from the side, and through the plate just inside it, down the back of the ear.
    for (u, v) in [(24.0, 27.8), (30.3, 20.0), (32.7, 9.0), (31.3, -3.5), (27.0, -14.0), (27.5, 12.0)] {
        let t = thickness_mm(&bvh, at(u, v, 15.0), at(u, v, 14.0) - at(u, v, 15.0));
        assert!((2.0..4.0).contains(&t), "{t} mm at {u}, {v}");
    }
    // Behind the ear there is air before the skull.
    let behind = at(30.0, 5.0, -3.0);
    let gap = bvh.closest(behind, Vec3::NEG_X, 60.0).unwrap().distance_mm;
    assert!((8.0..25.0).contains(&gap), "gap {gap} mm");
}

#[test]
fn texture_coordinates_are_injective() {
    for head in [&*COARSE, &*FINE] {
        let mesh = &head.mesh;
        assert!((2..=12).contains(&head.charts.count), "{} charts", head.charts.count);
        let gutter = 7.9 / 2048.0;
        assert!(mesh.uvs.iter().all(|uv| uv.min_element() > gutter && uv.max_element() < 1.0 - gutter));
        assert!(Charts::overlap_fraction(mesh, 2048) < 1e-3);
        let area = |[a, b, c]: [Vec2; 3]| (b - a).perp_dot(c - a);
        // The image is seen from outside and upright: v grows downwards, so all areas are negative.
        assert!((0..mesh.triangles.len()).all(|t| area(mesh.corner_map_uvs(t)) < 0.0));
    }
}

#[test]
fn texels_on_the_face_are_even_and_fine() {
    let mesh = &FINE.mesh;
    let front = |&t: &usize| mesh.corners_mm(t).iter().all(|p| p.z > 30.0 && p.y.abs() < 110.0);
    let (mut inside, mut all) = (0.0, 0.0);
    for t in (0..mesh.triangles.len()).filter(front) {
        let [a, b, c] = mesh.corner_map_uvs(t).map(|uv| uv * 2048.0);
        let texel_mm = (mesh.area_mm2(t) / (0.5 * (b - a).perp_dot(c - a).abs())).sqrt();
        all += mesh.area_mm2(t);
        inside += if (0.2..0.36).contains(&texel_mm) { mesh.area_mm2(t) } else { 0.0 };
    }
    assert!(inside > 0.95 * all, "{}", inside / all);
}

#[test]
fn the_same_head_is_made_every_time() {
    let (a, b) = (&*COARSE, plain(10_000));
    assert_eq!(a.mesh.triangles, b.mesh.triangles);
    let bits = |v: &[Vec3]| v.iter().flat_map(|p| p.to_array()).map(f32::to_bits).collect::<Vec<_>>();
    assert_eq!(bits(&a.mesh.positions_mm), bits(&b.mesh.positions_mm));
    assert_eq!(a.mesh.uvs, b.mesh.uvs);
}

#[test]
fn left_and_right_are_mirror_images() {
    let sculpture = Sculpture::new();
    let flip = Vec3::new(-1.0, 1.0, 1.0);
    let asymmetry = |p: &Vec3| (sculpture.distance(*p) - sculpture.distance(*p * flip)).abs();
    assert!(FINE.mesh.positions_mm.iter().all(|p| asymmetry(p) < 1e-4));
}

#[test]
fn vertices_lie_on_the_sculpture() {
    let sculpture = Sculpture::new();
    let mut off: Vec<f32> = FINE.mesh.positions_mm.iter().map(|&p| sculpture.distance(p).abs()).collect();
    off.sort_by(f32::total_cmp);
    // In the sharpest creases Newton steps jump from side to side; elsewhere they end at once.
    assert!(off[off.len() * 99 / 100] < 0.02, "{}", off[off.len() * 99 / 100]);
}

#[test]
fn maps_are_skin() {
    let head = built_in(HeadDetail { triangles: 10_000, map_size: 256 });
    let material = &head.material;
    for (t, _) in head.mesh.triangles.iter().enumerate().step_by(97) {
        let uv = head.mesh.corner_map_uvs(t).iter().sum::<Vec2>() / 3.0;
        let point = head.surface_point(t as u32, 1.0 / 3.0, 1.0 / 3.0);
        let albedo = material.albedo.at(uv);
        assert!(albedo.min_element() > 0.01 && albedo.max_element() < 0.95, "{albedo}");
        let bent = material.normal.as_ref().unwrap().at(uv, point.normal, point.tangent);
        assert!(bent.dot(point.normal) > 0.7);
        assert!((0.7..=1.3).contains(&material.rho_s.at(uv)));
        assert!((0.23..=0.32).contains(&material.roughness.at(uv)));
    }
}
