//! Numbers of `depth-absorption`.

use super::ramp;
use crate::view::panel::choice::choice;
use crate::view::panel::number::{Number, linear};
use cutis_render::technique::depth_absorption::{DepthAbsorptionSettings, EntryPoint, FallOff};
use eframe::egui::{ComboBox, Ui};
use glam::Vec3;
use std::sync::Arc;

/// Extinctions that are begun with, 1/mm.
const SIGMA_T_PER_MM: Vec3 = Vec3::new(0.3, 0.7, 1.0);

/// Shows them.
pub fn show(settings: &mut DepthAbsorptionSettings, ui: &mut Ui) {
    let usual = DepthAbsorptionSettings::default();
    fall_off(&mut settings.fall_off, ui);
    let hint =
        "how far the body is grown along its normals in the depth map, against the background at its edges";
    linear("growth [mm]", hint, 0.0..=10.0, usual.growth_mm).show(ui, &mut settings.growth_mm);
    choice(ui, "known of the entry", &mut settings.entry, &EntryPoint::ALL);
    let hint =
        "places on the light's side that are looked at: the more, the less features of the back show through";
    linear("samples", hint, 1.0..=64.0, usual.samples as f32).show_whole(ui, &mut settings.samples);
    let hint = "radius of the disc that the samples are spread over";
    linear("filter radius [mm]", hint, 0.0..=20.0, usual.filter_radius_mm)
        .show(ui, &mut settings.filter_radius_mm);
    let hint = "surfaces along the light's way that are told apart; 1: all behind the nearest is flesh, as in the paper";
    linear("layers", hint, 1.0..=16.0, usual.layers as f32).show_whole(ui, &mut settings.layers);
}

/// What a distance through the body leaves of the light.
fn fall_off(fall_off: &mut FallOff, ui: &mut Ui) {
    ComboBox::from_label("fall-off").selected_text(name(fall_off)).show_ui(ui, |ui| {
        let ramp = || FallOff::Ramp(Arc::new(ramp::usual()));
        for begun in [FallOff::Material, FallOff::Exponential(SIGMA_T_PER_MM), ramp()] {
            let is_chosen = name(&begun) == name(fall_off);
            if ui.selectable_label(is_chosen, name(&begun)).clicked() && !is_chosen {
                *fall_off = begun;
            }
        }
    });
    match fall_off {
        FallOff::Material => {}
        FallOff::Exponential(sigma_t) => {
            let channels = ["sigma_t red [1/mm]", "sigma_t green [1/mm]", "sigma_t blue [1/mm]"];
            for (c, name) in channels.into_iter().enumerate() {
                let hint = "extinction on the way through the body";
                let number = linear(name, hint, 0.0..=10.0, SIGMA_T_PER_MM[c]);
                Number { is_logarithmic: true, ..number }.show(ui, &mut sigma_t[c]);
            }
        }
        FallOff::Ramp(ramp) => ramp::show(ramp, ui),
    }
}

fn name(fall_off: &FallOff) -> &'static str {
    match fall_off {
        FallOff::Material => "the material's",
        FallOff::Exponential(_) => "exponential",
        FallOff::Ramp(_) => "colour ramp",
    }
}
