//! How the scene is deformed: a wave, shapes and joints.

use super::number::linear;
use crate::view::app::Viewer;
use cutis_scene::Wave;
use eframe::egui::{ComboBox, Ui};
use glam::Vec3;
use std::f32::consts::TAU;

/// The wave at first: amplitude and wavelength, mm.
const WAVE_MM: [f32; 2] = [8.0, 120.0];
/// Turns of a moving wave in a second.
const TURNS_PER_S: f32 = 0.5;

/// Shows it.
pub fn show(viewer: &mut Viewer, ui: &mut Ui) {
    let pose = &mut viewer.looks[viewer.edited].pose;
    let original = &viewer.original.pose;
    wave(&mut pose.wave, ui);
    for name in viewer.scene.morph_names() {
        let was = original.morph_weights.get(name).copied().unwrap_or(0.0);
        let mut weight = pose.morph_weights.get(name).copied().unwrap_or(was);
        ui.push_id(name, |ui| {
            ui.label(name);
            linear("shape", "weight of a morph target", -1.0..=1.0, was).show(ui, &mut weight);
        });
        if weight != pose.morph_weights.get(name).copied().unwrap_or(was) {
            pose.morph_weights.insert(name.to_owned(), weight);
        }
    }
    joint(viewer, ui);
    if ui.button("back to rest").on_hover_text("the pose of the scene as it was read").clicked() {
        viewer.looks[viewer.edited].pose = viewer.original.pose.clone();
    }
}

/// The procedural wave of d'Eon, Luebke & Enderton 2007.
fn wave(wave: &mut Option<Wave>, ui: &mut Ui) {
    let mut on = wave.is_some();
    if ui.checkbox(&mut on, "wave").on_hover_text("sideways, with crests above each other").changed() {
        *wave = on.then(|| Wave::sideways(WAVE_MM[0], WAVE_MM[1], 0.0));
    }
    let Some(wave) = wave else { return };
    linear("amplitude [mm]", "largest displacement", 0.0..=50.0, WAVE_MM[0]).show(ui, &mut wave.amplitude_mm);
    linear("wavelength [mm]", "from crest to crest", 10.0..=500.0, WAVE_MM[1])
        .show(ui, &mut wave.wavelength_mm);
    linear("phase [rad]", "where it is", 0.0..=TAU, 0.0).show(ui, &mut wave.phase_rad);
    let id = ui.scope_id().with("moves");
    let mut moves = ui.data(|data| data.get_temp(id).unwrap_or(false));
    ui.checkbox(&mut moves, "moves");
    ui.data_mut(|data| data.insert_temp(id, moves));
    if moves {
        let seconds = ui.input(|input| input.stable_dt);
        wave.phase_rad = (wave.phase_rad + TAU * TURNS_PER_S * seconds) % TAU;
        ui.ctx().request_repaint();
    }
}

/// A joint that is chosen, and its three angles.
fn joint(viewer: &mut Viewer, ui: &mut Ui) {
    let names = viewer.scene.joint_names();
    let Some(first) = names.first() else { return };
    let id = ui.scope_id().with("joint");
    let mut chosen: String = ui.data(|data| data.get_temp(id).unwrap_or_else(|| (*first).to_owned()));
    ComboBox::from_label("joint").selected_text(&chosen).show_ui(ui, |ui| {
        for name in &names {
            ui.selectable_value(&mut chosen, (*name).to_owned(), *name);
        }
    });
    let pose = &mut viewer.looks[viewer.edited].pose;
    let was = viewer.original.pose.joint_degrees.get(&chosen).copied().unwrap_or(Vec3::ZERO);
    let before = pose.joint_degrees.get(&chosen).copied().unwrap_or(was);
    let mut degrees = before;
    linear("about x [°]", "turn about the joint's own axis", -120.0..=120.0, was.x).show(ui, &mut degrees.x);
    linear("about y [°]", "turn about the joint's own axis", -120.0..=120.0, was.y).show(ui, &mut degrees.y);
    linear("about z [°]", "turn about the joint's own axis", -120.0..=120.0, was.z).show(ui, &mut degrees.z);
    if degrees != before {
        pose.joint_degrees.insert(chosen.clone(), degrees);
    }
    ui.data_mut(|data| data.insert_temp(id, chosen));
}
