//! Lights and surroundings.

use super::number::{factor, linear};
use crate::view::app::Viewer;
use cutis_scene::Light;
use eframe::egui::Ui;

/// Shows it.
pub fn show(viewer: &mut Viewer, ui: &mut Ui) {
    if viewer.scene.lights.iter().any(Light::moves) {
        ui.checkbox(&mut viewer.is_playing, "lights move")
            .on_hover_text("time goes on for images that drift");
        let hint = "how long lights that move have moved";
        linear("time [s]", hint, 0.0..=60.0, 0.0).show(ui, &mut viewer.looks[viewer.edited].time_s);
    }
    let look = &mut viewer.looks[viewer.edited];
    for (l, (light, change)) in viewer.scene.lights.iter().zip(&mut look.lights).enumerate() {
        ui.push_id(l, |ui| {
            ui.horizontal(|ui| {
                ui.checkbox(&mut change.on, format!("light {}, {}", l + 1, kind(light)));
                ui.radio_value(&mut viewer.light, l, "follows the mouse")
                    .on_hover_text("Shift and the left button move this light");
            });
            factor("× strength", "factor on the light's power", 0.01..=100.0).show(ui, &mut change.strength);
            let hint = "turn about the vertical axis through the middle of the scene";
            linear("turn [°]", hint, -180.0..=180.0, 0.0).show(ui, &mut change.turn_degrees);
            linear("lift [°]", "turn upwards", -89.0..=89.0, 0.0).show(ui, &mut change.lift_degrees);
            let hint = "factor on the light's radius: how soft its shadows are";
            linear("× extent", hint, 0.0..=10.0, 1.0).show(ui, &mut change.extent);
        });
    }
    if viewer.scene.environment.is_some() {
        let (around, original) = (&mut look.surroundings, &viewer.original.surroundings);
        ui.label("environment");
        let hint = "factor on the radiance of the environment";
        linear("× environment", hint, 0.0..=4.0, 1.0).show(ui, &mut around.strength);
        linear("environment turn [°]", "about the vertical axis", -180.0..=180.0, original.turn_degrees)
            .show(ui, &mut around.turn_degrees);
        ui.checkbox(&mut around.visible, "seen behind the scene");
    }
}

fn kind(light: &Light) -> &'static str {
    match light {
        Light::Directional { .. } => "directional",
        Light::Point { .. } => "point",
        Light::Spot { .. } => "spot",
        Light::Projector(_) => "projector",
    }
}
