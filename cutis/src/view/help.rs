//! The list of keys over the picture.

use super::keys::{KEYS, MOUSE, TECHNIQUE_KEYS};
use cutis_render::TechniqueName;
use eframe::egui::{Align2, Context, Grid, RichText, Ui, Window};

/// Shows it as long as `open`.
pub fn show(context: &Context, open: &mut bool) {
    Window::new("Keys and mouse")
        .open(open)
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
        .show(context, |ui| Grid::new("keys").num_columns(2).striped(true).show(ui, rows));
}

fn rows(ui: &mut Ui) {
    let row = |ui: &mut Ui, key: &str, what: &str| {
        ui.label(RichText::new(key).monospace());
        ui.label(what);
        ui.end_row();
    };
    MOUSE.iter().for_each(|(button, what)| row(ui, button, what));
    KEYS.iter().for_each(|(key, _, what)| row(ui, key.symbol_or_name(), what));
    for (key, technique) in TECHNIQUE_KEYS.iter().zip(TechniqueName::ALL) {
        row(ui, key.symbol_or_name(), &format!("technique {technique}"));
    }
    row(ui, "drop a file", "scene or head (.toml, .glb, .gltf, .obj), environment (.hdr, .exr)");
}
