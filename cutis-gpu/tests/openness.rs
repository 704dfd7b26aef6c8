//! How open a surface is to its surroundings: a floor before a wall against the closed form, and a head against rays.

mod common;

use common::{difference, head_in_the_studio, patch, patch_under_a_spot, read, renderer, tolerances};
use cutis_gpu::GpuRenderer;
use cutis_render::lit_scene::LitScene;
use cutis_render::{Settings, Silent};
use cutis_scene::validation::shapes::cuboid;
use cutis_scene::{Material, Object, Scene, studio};
use glam::{Vec2, Vec3, Vec4};
use std::f32::consts::TAU;

/// Side of the floor, mm.
const SIDE_MM: f32 = 40.0;
/// Where the wall stands, mm.
const WALL_X_MM: f32 = 30.0;
/// How high it is, mm.
const WALL_HEIGHT_MM: f32 = 15.0;

fn settings(irradiance_size: u32) -> Settings {
    Settings { width: 8, height: 8, irradiance_size, samples_per_pixel: 1, ..Settings::default() }
}

/// A wall across the whole of a floor.
fn wall_on_a_floor() -> Scene {
    let mut scene = patch_under_a_spot(patch(|u| f64::from(SIDE_MM) * u, |v| f64::from(SIDE_MM) * v));
    let half_mm = Vec3::new(1.0, 0.5 * SIDE_MM, 0.5 * WALL_HEIGHT_MM);
    let middle = Vec3::new(WALL_X_MM + half_mm.x, -0.5 * SIDE_MM, half_mm.z);
    scene.objects.push(Object::new("wall", cuboid(middle, half_mm), Material::default()));
    scene.environment = Some(studio::studio_environment());
    scene
}

fn openness(renderer: &GpuRenderer, scene: &Scene, irradiance_size: u32) -> Vec<Vec4> {
    let ready = renderer.scene(scene, &settings(irradiance_size), &Silent).expect("is uploaded");
    ready.draw(&renderer.gpu).expect("is drawn");
    read(&renderer.gpu, &ready.objects[0].ambient, 0)
}

/// Share of the cosine-weighted hemisphere over a point of the floor that the wall takes: the view factor of a rectangle
/// that stands upright on a differential element's plane (Howell, *A catalog of radiation heat transfer configuration
/// factors*, B-5).
fn taken_by_the_wall(place_mm: Vec2) -> f32 {
    let before_mm = WALL_X_MM - place_mm.x;
    let slant_mm = before_mm.hypot(WALL_HEIGHT_MM);
    let of_side = |length_mm: f32| {
        (length_mm / before_mm).atan() - before_mm / slant_mm * (length_mm / slant_mm).atan()
    };
    (of_side(place_mm.y) + of_side(SIDE_MM - place_mm.y)) / TAU
}

#[test]
fn a_wall_takes_its_view_factor_of_the_sky() {
    let Some(renderer) = renderer("a_wall_takes_its_view_factor_of_the_sky") else { return };
    let open = openness(renderer, &wall_on_a_floor(), 512);
    let size = (open.len() as f32).sqrt() as usize;
    let (mut worst, mut sum, mut count) = (0.0f32, 0.0, 0);
    for (texel, open) in open.iter().enumerate() {
        let place_mm =
            (Vec2::new((texel % size) as f32, (texel / size) as f32) + 0.5) / size as f32 * SIDE_MM;
        let on_floor =
            place_mm.min_element() > 1.0 && place_mm.y < SIDE_MM - 1.0 && place_mm.x < WALL_X_MM - 1.0;
        if on_floor {
            let off = (open.w - (1.0 - taken_by_the_wall(place_mm))).abs();
            (worst, sum, count) = (worst.max(off), sum + off, count + 1);
            assert!(open.x <= 1e-3, "the open side is the other one: {open}");
        }
    }
    let mean = sum / count as f32;
    eprintln!("{count} texels: off by {mean:.4} on the mean, {worst:.4} at worst");
    assert!(count > size * size / 2);
    assert!(mean < tolerances::WALL[0] && worst < tolerances::WALL[1], "{mean}, {worst}");
}

#[test]
fn a_head_is_as_open_as_rays_find_it() {
    let Some(renderer) = renderer("a_head_is_as_open_as_rays_find_it") else { return };
    let scene = head_in_the_studio();
    let got = openness(renderer, &scene, 512);
    let cpu = LitScene::new(&scene, &settings(512), &Silent).expect("draws");
    let ambient = &cpu.maps()[0].ambient;
    let covered = |t: usize| ambient.map()[t].w > 0.0;
    let open_only = |map: &[Vec4]| map.iter().map(|v| Vec4::splat(v.w)).collect::<Vec<_>>();
    difference(&open_only(&got), &open_only(ambient.map()), covered).check("openness", tolerances::OPENNESS);
    difference(&got, ambient.map(), covered).check("bent normals", tolerances::BENT_NORMALS);
}
