//! How long each pass took, and what should be known of the picture.

use crate::view::app::Viewer;
use eframe::egui::{Grid, Ui};

/// Shows it.
pub fn show(viewer: &Viewer, ui: &mut Ui) {
    let Some(painted) = &viewer.sides[viewer.edited].painted else {
        ui.label("nothing is drawn yet");
        return;
    };
    Grid::new("times").num_columns(2).striped(true).show(ui, |ui| {
        for pass in &painted.frame.passes {
            ui.label(&pass.name);
            ui.label(format!("{:.2} ms", pass.time.as_secs_f64() * 1e3));
            ui.end_row();
        }
    });
    for warning in &painted.frame.warnings {
        ui.label(format!("warning: {warning}"));
    }
}
