//! Wrap lighting on both backends.

mod common;

use common::tolerances::{self, Tolerance};
use common::{difference, head_in_the_studio, patch, patch_under_a_spot, renderer, small_frame};
use cutis_render::settings::TechniqueSettings;
use cutis_render::technique::wrap::{WrapForm, WrapSettings, WrapShine};
use cutis_render::{CpuRenderer, Renderer, Settings, Silent, TechniqueName};
use cutis_scene::validation::shapes;
use cutis_scene::{Environment, Light, Material, Object, Scene};
use glam::Vec3;

fn same_on_both(test: &str, scene: &Scene, wrap: WrapSettings, allowed: Tolerance) {
    let Some(renderer) = renderer(test) else { return };
    let settings = Settings {
        technique: TechniqueName::Wrap,
        techniques: TechniqueSettings { wrap, ..TechniqueSettings::default() },
        ..small_frame()
    };
    let cpu = CpuRenderer.render(scene, &settings, &Silent).expect("draws");
    let gpu = renderer.render(scene, &settings, &Silent).expect("draws");
    let covered = |i: usize| cpu.pixels[i].w > 0.99 && gpu.pixels[i].w > 0.99;
    difference(&gpu.pixels, &cpu.pixels, covered).check(test, allowed);
}

#[test]
fn the_paper_s_table_on_the_built_in_head() {
    let usual = WrapSettings::default();
    same_on_both("the_paper_s_table", &head_in_the_studio(), usual, tolerances::WRAPPED_HEAD[0]);
}

/// A wall's wide shadow over a plate that the light only grazes, where the wrap mixes what the plate's texture knows with what a
/// place above it sees.
#[test]
fn a_shadow_where_the_light_ends() {
    let mut scene = patch_under_a_spot(patch(|u| 40.0 * u, |v| 40.0 * v));
    let [lo, hi] = scene.bounds_mm().expect("has points");
    let middle_mm = 0.5 * (lo + hi);
    let wall = shapes::cuboid(middle_mm + Vec3::new(8.0, 0.0, 2.0), Vec3::new(0.5, 8.0, 3.0));
    scene.objects.push(Object::new("wall", wall, Material::default()));
    scene.lights = vec![Light::Directional {
        dir_to_light: Vec3::new(1.0, 0.1, 0.15).normalize(),
        irradiance_w_per_m2: Vec3::splat(3.0),
        angular_radius_rad: 0.05,
    }];
    let wide = WrapSettings { wrap: 0.4, shadow_offset_mm: 4.0, ..WrapSettings::default() };
    same_on_both("a_shadow_where_the_light_ends", &scene, wide, tolerances::WRAPPED_SHADOW);
}

/// Every number other than usual, so that each is missed where it is not handed on: the wide wrap of each channel, green tint,
/// dull shine of a colour, energy.
#[test]
fn every_number_counts_by_the_formula() {
    let wrap = WrapSettings {
        form: WrapForm::Formula,
        scatter_width: 0.2,
        scatter_colour: Vec3::new(0.1, 0.4, 0.0),
        shininess: 6.0,
        energy_conserving: true,
        radius_mm: Some(3.0),
        shine: WrapShine::Power,
        specular_colour: Vec3::new(0.1, 0.3, 0.6),
        ..WrapSettings::default()
    };
    let scene = Scene { environment: None::<Environment>, ..head_in_the_studio() };
    same_on_both("every_number_counts", &scene, wrap, tolerances::WRAPPED_HEAD[1]);
}
