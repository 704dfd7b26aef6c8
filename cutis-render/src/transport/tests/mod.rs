//! The transport against what is known without it: exact solutions, flat slabs, and what must not change anything.
//!
//! The quick ones take a minute together; the slow suite is `cargo test --release -p cutis-render --lib -- --ignored slow`.
#![allow(clippy::unwrap_used, reason = "tests")]
#![allow(clippy::print_stderr, reason = "measured numbers are worth a line, and a skipped test must say so")]

mod convergence;
mod furnace;
mod head;
mod invariance;
mod lamps;
mod shadow_edge;
mod slab;

use super::estimate::Estimate;
use super::path::Transport;
use super::random::Random;
use cutis_optics::Medium;
use cutis_scene::{
    Camera, ColourMap, Environment, Light, Material, Mesh, Object, ReadOptions, ScalarMap, Scattering, Scene,
    Texels, Texture, read_scene,
};
use glam::{DVec3, Vec2, Vec3};
use std::f32::consts::{PI, TAU};
use std::path::{Path, PathBuf};
use std::sync::Arc;

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

/// The scanned head, of this material; `None` with a word on stderr where the shelf of assets is not at hand.
pub fn scanned_head(test: &str, material: Material) -> Option<Object> {
    let given = std::env::var_os("CUTIS_ASSETS").filter(|value| !value.is_empty()).map(PathBuf::from);
    let shelf = given.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/assets"));
    let file = shelf.join("lee_perry_smith/LeePerrySmith.obj");
    if !file.is_file() {
        let why = format!("{} does not exist; set CUTIS_ASSETS", file.display());
        assert!(std::env::var_os("CUTIS_REQUIRE_ASSETS").is_none_or(|v| v != "1"), "{test}: {why}");
        eprintln!("SKIPPED: {test}: {why}");
        return None;
    }
    // A unit of the file is 95 cm: 43 cm across the shoulders.
    let options = ReadOptions { millimetres_per_unit: Some(950.0), ..ReadOptions::default() };
    let mut object = read_scene(&file, &options).unwrap().objects.remove(0);
    object.material = material;
    Some(object)
}

/// Mean radiance over rays that come from all around, from `reach_mm` away, and aim at a ball of `aim_mm` around a place.
fn seen_from_everywhere(
    scene: &Scene,
    centre_mm: DVec3,
    [reach_mm, aim_mm]: [f64; 2],
    paths: u64,
) -> Estimate {
    let transport = Transport::new(scene, 1).unwrap();
    let mut estimate = Estimate::default();
    for i in 0..paths {
        let mut random = Random::new(11, i, 0);
        let from = random.direction() * reach_mm;
        let to = random.direction() * aim_mm;
        let sample = transport.radiance(centre_mm + from, (to - from).normalize(), &mut random);
        if sample.covered {
            estimate.add(sample.diffuse + sample.specular);
        }
    }
    estimate
}

fn assert_alike(name: &str, a: &Estimate, b: &Estimate) {
    let error = (a.standard_error().powf(2.0) + b.standard_error().powf(2.0)).powf(0.5);
    eprintln!("{name}: {} ± {}, {} ± {}", a.mean(), a.standard_error(), b.mean(), b.standard_error());
    // Three channels of four standard errors: a false alarm in 5000 runs.
    assert!(
        (a.mean() - b.mean()).abs().cmple(error * 4.0).all(),
        "{name}: {} {} {error}",
        a.mean(),
        b.mean()
    );
}
