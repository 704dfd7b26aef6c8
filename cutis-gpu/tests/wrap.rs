//! Wrap lighting on both backends.

mod common;

use common::tolerances::{self, Tolerance};
use common::{difference, head_in_the_studio, renderer, small_frame};
use cutis_render::settings::TechniqueSettings;
use cutis_render::technique::wrap::{WrapForm, WrapSettings, WrapShine};
use cutis_render::{CpuRenderer, Renderer, Settings, Silent, TechniqueName};
use cutis_scene::{Environment, Scene};
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
