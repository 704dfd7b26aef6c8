//! What must change nothing: how finely a shape is cut into triangles, and the unit of length.

use super::{assert_alike, ball, even_environment, material, scene_of};
use crate::Silent;
use crate::settings::Settings;
use crate::technique::truth;
use crate::transport::estimate::Estimate;
use crate::transport::path::Transport;
use crate::transport::random::Random;
use cutis_scene::{Light, Mesh, Object, Scene};
use glam::{DVec3, Vec3};

/// Every triangle cut into four in its own plane. Normals in the middle of an edge are left as long as their mean is, so that
/// between the corners they stay what they were.
fn cut_in_four(object: &Object) -> Object {
    let old = &object.mesh;
    let mut mesh = Mesh::default();
    for triangle in &old.triangles {
        let base = mesh.positions_mm.len() as u32;
        let corners = triangle.map(|v| v as usize);
        let middles = [[0, 1], [1, 2], [2, 0]].map(|side| side.map(|corner| corners[corner]));
        for [a, b] in corners.map(|v| [v, v]).into_iter().chain(middles) {
            mesh.positions_mm.push((old.positions_mm[a] + old.positions_mm[b]) * 0.5);
            mesh.normals.push((old.normals[a] + old.normals[b]) * 0.5);
            mesh.uvs.push((old.uvs[a] + old.uvs[b]) * 0.5);
        }
        let parts = [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]];
        mesh.triangles.extend(parts.map(|part| part.map(|corner| base + corner)));
    }
    Object::new(object.name.clone(), mesh, object.material.clone())
}

/// Mean radiance over rays from a camera at `eye_mm` to a ball.
fn seen(scene: &Scene, seed: u64, paths: u64) -> Estimate {
    let transport = Transport::new(scene, 1).unwrap();
    let mut estimate = Estimate::default();
    for i in 0..paths {
        let mut random = Random::new(seed, i, 1);
        let (eye_mm, aim_mm) = (DVec3::new(0.0, 0.0, 100.0), random.direction() * 8.0);
        let sample = transport.radiance(eye_mm, (aim_mm - eye_mm).normalize(), &mut random);
        if sample.covered {
            estimate.add(sample.diffuse + sample.specular);
        }
    }
    estimate
}

fn lamp(scale: f32) -> Light {
    Light::Point {
        position_mm: Vec3::new(40.0, 60.0, 70.0) * scale,
        // As much light as far away as before.
        intensity_w_per_sr: Vec3::new(0.03, 0.02, 0.01) * scale * scale,
        radius_mm: 8.0 * scale,
    }
}

fn assert_cut_alike(paths: u64) {
    for roughness in [0.0, 0.4] {
        // So coarse that edges are seen: 64 flat faces around the equator would hide them.
        let coarse = ball(10.0, 8, material(0.05, 1.5, 1.4, roughness));
        let fine = cut_in_four(&coarse);
        assert_eq!(fine.mesh.triangles.len(), 4 * coarse.mesh.triangles.len());
        // Through a smooth surface a lamp is met too rarely.
        let lit = |object| match roughness {
            0.0 => scene_of(vec![object], vec![], Some(even_environment())),
            _ => scene_of(vec![object], vec![lamp(1.0)], None),
        };
        let [coarse, fine] = [coarse, fine].map(lit);
        let name = format!("coarse and fine, roughness {roughness}");
        assert_alike(&name, &seen(&coarse, 5, paths), &seen(&fine, 6, paths));
    }
}

#[test]
fn a_ball_cut_more_finely_is_as_bright() {
    assert_cut_alike(15_000);
}

#[test]
#[ignore = "slow suite: twenty times the paths"]
fn slow_a_ball_cut_more_finely_is_as_bright() {
    assert_cut_alike(300_000);
}

/// A ball in front of a camera, every length `scale` times as long.
fn scaled(scale: f32, roughness: f32) -> Scene {
    let per_mm = 1.0 / f64::from(scale);
    let object = ball(10.0 * scale, 12, material(0.05 * per_mm, 1.5 * per_mm, 1.4, roughness));
    let mut scene = scene_of(vec![object], vec![lamp(scale)], None);
    scene.camera.position_mm = Vec3::Z * 100.0 * scale;
    scene
}

#[test]
fn the_unit_of_length_is_of_no_account() {
    let settings = Settings { width: 16, height: 16, samples_per_pixel: 16, seed: 3, ..Settings::default() };
    let pixels =
        |scale, roughness| truth::render(&scaled(scale, roughness), &settings, &Silent).unwrap().pixels;
    for roughness in [0.0, 0.5] {
        // 1024 and not 1000: powers of two round nothing, every path is the same, and a length hidden in the program would
        // show in the last digits. Only sums of squares of coordinates in single precision may overflow, and do not.
        let (one, many) = (pixels(1.0, roughness), pixels(1024.0, roughness));
        assert!(one.iter().any(|p| p.x > 0.0), "there is something to be seen");
        for (a, b) in one.iter().zip(&many) {
            assert!((*a - *b).abs().max_element() <= 1e-6 * a.abs().max_element(), "{a} {b}");
        }
        // Times 1000 positions round, and a path in many parts from its twin: each changes the sum of 4096 by about a
        // 4096th. Five may.
        let thousand = pixels(1000.0, roughness);
        let sum = |pixels: &[glam::Vec4]| pixels.iter().map(|p| p.x).sum::<f32>();
        let off = (sum(&thousand) / sum(&one) - 1.0).abs();
        eprintln!("roughness {roughness}: a thousand times as large, {off:.1e} brighter or darker");
        assert!(off < 5.0 / 4096.0, "{off}");
    }
}
