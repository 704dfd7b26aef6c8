#![allow(clippy::unwrap_used, reason = "tests")]

use cutis_scene::{Camera, Environment, Light, Object, Scene};
use glam::Vec3;

/// Objects in some light, seen from the front.
pub fn scene_of(objects: Vec<Object>, lights: Vec<Light>, environment: Option<Environment>) -> Scene {
    let camera = Camera {
        position_mm: Vec3::new(0.0, 0.0, 100.0),
        look_at_mm: Vec3::ZERO,
        up: Vec3::Y,
        vertical_fov_rad: 0.3,
        exposure_ev: 0.0,
    };
    Scene { objects, lights, environment, camera, background: None, warnings: Vec::new() }
}

use super::path::Transport;
use super::random::Random;
use crate::transport::estimate::Estimate;
use cutis_optics::Medium;
use cutis_scene::{ColourMap, Material, Mesh, ScalarMap, Scattering, Texels, Texture};
use glam::{DVec3, Vec2};
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

/// A body's material: one medium for all channels, its own colour.
pub fn material(sigma_a: f64, sigma_s: f64, index: f64, roughness: f32) -> Material {
    let medium = Medium::new(sigma_a, sigma_s, index).unwrap();
    Material {
        scattering: Scattering::Medium([medium; 3]),
        albedo: ColourMap { factor: Vec3::ONE, texture: None },
        roughness: ScalarMap::constant(roughness),
        ..Material::default()
    }
}

/// A closed ball, split along a seam of its texture.
pub fn ball(radius_mm: f32, rings: u32, material: Material) -> Object {
    let mut mesh = Mesh::default();
    for i in 0..=rings {
        for j in 0..=2 * rings {
            let uv = Vec2::new(j as f32 / (2 * rings) as f32, i as f32 / rings as f32);
            let (polar, azimuth) = (uv.y * PI, if j == 2 * rings { 0.0 } else { uv.x * TAU });
            let sin = if i == 0 || i == rings { 0.0 } else { polar.sin() };
            let dir = Vec3::new(sin * azimuth.cos(), polar.cos(), sin * azimuth.sin());
            mesh.positions_mm.push(dir * radius_mm);
            mesh.normals.push(dir.normalize());
            mesh.uvs.push(uv);
        }
    }
    let row = 2 * rings + 1;
    for i in 0..rings {
        for j in 0..2 * rings {
            let a = i * row + j;
            if i > 0 {
                mesh.triangles.push([a, a + 1, a + row]);
            }
            if i + 1 < rings {
                mesh.triangles.push([a + 1, a + row + 1, a + row]);
            }
        }
    }
    Object::new("ball", mesh, material)
}

/// A closed box with these half sizes.
pub fn cuboid(half_mm: Vec3, material: Material) -> Object {
    let mut mesh = Mesh::default();
    for normal in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|axis| [axis, -axis]) {
        let (u, v) = (normal.any_orthonormal_vector(), normal.cross(normal.any_orthonormal_vector()));
        let base = mesh.positions_mm.len() as u32;
        for (s, t) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            mesh.positions_mm.push((normal + u * s + v * t) * half_mm);
            mesh.normals.push(normal);
            mesh.uvs.push(Vec2::new(s, t) * 0.5 + 0.5);
        }
        mesh.triangles.extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
    }
    Object::new("box", mesh, material)
}

/// The same radiance from everywhere.
pub fn even_environment() -> Environment {
    let map = Arc::new(Texture::new(2, 1, Texels::LinearF32(vec![[1.0; 4]; 2])));
    Environment { map, rotation_rad: 0.0, radiance_scale: Vec3::ONE, visible: false }
}

/// Mean radiance over rays from all around that aim at a ball around the origin.
fn seen_from_everywhere(scene: &Scene, aim_mm: f64, paths: u64) -> Estimate {
    let transport = Transport::new(scene, 1).unwrap();
    let mut estimate = Estimate::default();
    for i in 0..paths {
        let mut random = Random::new(11, i, 0);
        let from = random.direction() * 200.0;
        let to = random.direction() * aim_mm;
        let sample = transport.radiance(from, (to - from).normalize(), &mut random);
        if sample.covered {
            estimate.add(sample.diffuse + sample.specular);
        }
    }
    estimate
}

#[test]
fn a_white_body_vanishes_in_a_white_furnace() {
    for roughness in [0.0, 0.3, 0.7] {
        for index in [1.0, 1.3, 1.5] {
            let white = || material(0.0, 1.0, index, roughness);
            for object in [ball(6.0, 16, white()), cuboid(Vec3::new(5.0, 3.0, 4.0), white())] {
                let name = object.name.clone();
                let scene = scene_of(vec![object], vec![], Some(even_environment()));
                let seen = seen_from_everywhere(&scene, 3.0, 4000);
                // Three standard errors, and 1e-4 for where paths are one and all alike.
                let (off, error) = ((seen.mean() - 1.0).abs(), seen.standard_error());
                println!("{name} n {index} m {roughness}: {:?} ± {:?}", seen.mean().x, error.x);
                assert!(
                    off.cmple(error * 3.0 + 1e-4).all(),
                    "{name} index {index} roughness {roughness}: {off} {error}"
                );
            }
        }
    }
}

#[test]
fn a_body_that_absorbs_is_darker_than_the_furnace() {
    let scene = scene_of(vec![ball(6.0, 16, material(0.1, 1.0, 1.4, 0.3))], vec![], Some(even_environment()));
    let seen = seen_from_everywhere(&scene, 3.0, 2000).mean();
    assert!(seen.max_element() < 0.8 && seen.min_element() > 0.1, "{seen}");
    assert!((seen - seen.x).abs().max_element() < 1e-9, "channels alike: {seen}");
}

/// A ball in the light of a lamp as large as it, from aside.
fn lamp_and_ball(rings: u32, roughness: f32) -> Scene {
    let lamp = Light::Point {
        position_mm: Vec3::new(40.0, 60.0, 70.0),
        intensity_w_per_sr: Vec3::new(0.03, 0.02, 0.01),
        radius_mm: 8.0,
    };
    scene_of(vec![ball(10.0, rings, material(0.05, 1.5, 1.4, roughness))], vec![lamp], None)
}

/// Mean radiance of light from inside over rays from the camera that meet the ball.
fn seen_by_camera(transport: &Transport, paths: u64) -> Estimate {
    let mut estimate = Estimate::default();
    for i in 0..paths {
        let mut random = Random::new(5, i, 1);
        let aim = random.direction() * 7.0;
        let from = DVec3::new(0.0, 0.0, 100.0);
        let sample = transport.radiance(from, (aim - from).normalize(), &mut random);
        if sample.covered {
            estimate.add(sample.diffuse);
        }
    }
    estimate
}

fn assert_alike(name: &str, a: &Estimate, b: &Estimate) {
    let error = (a.standard_error().powf(2.0) + b.standard_error().powf(2.0)).powf(0.5);
    println!("{name}: {} ± {}, {} ± {}", a.mean(), a.standard_error(), b.mean(), b.standard_error());
    // Three channels of four standard errors: a false alarm in 5000 runs.
    assert!(
        (a.mean() - b.mean()).abs().cmple(error * 4.0).all(),
        "{name}: {} {} {error}",
        a.mean(),
        b.mean()
    );
}

#[test]
fn lamps_asked_through_the_surface_shine_as_lamps_met_by_chance() {
    let scene = lamp_and_ball(24, 0.5);
    let asked = Transport::new(&scene, 1).unwrap();
    let mut met = Transport::new(&scene, 1).unwrap();
    met.bodies[0].connection_mm = 0.0;
    let (asked, met) = (seen_by_camera(&asked, 20_000), seen_by_camera(&met, 60_000));
    assert_alike("asked and met", &asked, &met);
    // What it is for: from a third of the paths less noise.
    assert!(asked.standard_error().x < met.standard_error().x, "{asked:?} {met:?}");
}

#[test]
fn light_from_lamps_leaves_as_the_eye_sees_it() {
    use super::exitance::{Entrances, of_place};
    for roughness in [0.3, 0.0] {
        let scene = lamp_and_ball(16, roughness);
        let transport = Transport::new(&scene, 1).unwrap();
        let entrances = Entrances::new(&transport);
        // In both halves of the ball, towards the lamp and away from it.
        let half = |place: DVec3| usize::from(place.dot(DVec3::new(40.0, 60.0, 70.0)) < 0.0);
        let (mut from_lamp, packets) = ([Estimate::default(); 2], 60_000);
        let area_mm2 = entrances.area_mm2() / 2.0;
        for number in 0..packets {
            let mut flux = [DVec3::ZERO; 2];
            entrances.walk(3, number, 1, |exit| {
                let (theta, phi) = (exit.uv.y * PI, exit.uv.x * TAU);
                let dir = Vec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
                flux[half(dir.as_dvec3())] += exit.flux / area_mm2;
            });
            (0..2).for_each(|h| from_lamp[h].add(flux[h]));
        }
        let mut from_places = [Estimate::default(); 2];
        let mut random = Random::new(8, 0, 0);
        for number in 0..if roughness > 0.0 { 30_000 } else { 400_000 } {
            let (meeting, place) = entrances.place(&mut random);
            let came = of_place(&transport, meeting, place, &mut Random::new(9, number, 0));
            let h = half(place);
            from_places[h].add(came);
        }
        for h in 0..2 {
            assert_alike(&format!("roughness {roughness}, half {h}"), &from_lamp[h], &from_places[h]);
        }
    }
}
