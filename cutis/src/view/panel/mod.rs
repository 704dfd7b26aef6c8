//! The panel: everything that can be changed, with unit, range and reset.

mod choice;
mod light;
mod method;
mod number;
mod picture;
mod pose;
mod profile_plot;
mod skin;
mod technique;
mod times;

use super::app::Viewer;
use super::painter::Painted;
use eframe::egui::{CollapsingHeader, Label, ScrollArea, Ui};

/// Shows it.
pub fn show(viewer: &mut Viewer, ui: &mut Ui) {
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        sides(viewer, ui);
        let section = |title: &str, open: bool| CollapsingHeader::new(title).default_open(open);
        section("Skin", true).show(ui, |ui| skin::show(viewer, ui));
        section("Light", true).show(ui, |ui| light::show(viewer, ui));
        section("Picture", true).show(ui, |ui| picture::show(viewer, ui));
        section("Pose", false).show(ui, |ui| pose::show(viewer, ui));
        section("Method", true).show(ui, |ui| method::show(viewer, ui));
        technique::show(viewer, ui);
        section("Times", false).show(ui, |ui| times::show(viewer, ui));
    });
}

/// Which of two looks is changed.
fn sides(viewer: &mut Viewer, ui: &mut Ui) {
    ui.horizontal(|ui| {
        let mut is_split = viewer.split.is_some();
        if ui.checkbox(&mut is_split, "A | B").on_hover_text("two looks side by side (s)").changed() {
            viewer.split = is_split.then_some(0.5);
        }
        if !is_split {
            viewer.edited = 0;
            return;
        }
        ui.label("change");
        ui.selectable_value(&mut viewer.edited, 0, "A");
        ui.selectable_value(&mut viewer.edited, 1, "B");
        let other = 1 - viewer.edited;
        if ui.button("copy the other").clicked() {
            viewer.looks[viewer.edited] = viewer.looks[other].clone();
        }
    });
}

/// The line below the picture.
pub fn status(viewer: &Viewer, ui: &mut Ui) {
    ui.horizontal(|ui| {
        let drawn = viewer.sides.iter().filter_map(|side| side.painted.as_ref());
        for painted in drawn.take(viewer.split.map_or(1, |_| 2)) {
            let milliseconds = painted.time.as_secs_f64() * 1e3;
            let Painted { technique, quality, machine, .. } = painted;
            ui.label(format!("{technique}, {quality}, {milliseconds:.0} ms, {machine}"));
            ui.separator();
        }
        if !viewer.is_settled() {
            ui.label("…").on_hover_text("a better picture is being drawn");
            ui.separator();
        }
        let message = viewer.message.as_deref().unwrap_or("F1: keys and mouse");
        ui.add(Label::new(message).truncate()).on_hover_text(message);
    });
}
