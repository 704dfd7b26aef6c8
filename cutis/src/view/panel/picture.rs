//! The film, and files.

use super::number::linear;
use crate::scene_source::SceneSource;
use crate::view::app::Viewer;
use cutis_render::film::{Bloom, ToneMapper};
use eframe::egui::{ComboBox, DragValue, Slider, TextEdit, Ui};
use std::path::PathBuf;

/// Shows it.
pub fn show(viewer: &mut Viewer, ui: &mut Ui) {
    let (look, original) = (&mut viewer.looks[viewer.edited], &viewer.original);
    let film = &mut look.film;
    linear("exposure [EV]", "each step doubles the light", -8.0..=8.0, original.film.exposure_ev)
        .show(ui, &mut film.exposure_ev);
    let strength = |bloom: Option<Bloom>| bloom.map_or(0.0, |bloom| bloom.strength);
    let mut bloom = strength(film.bloom);
    linear(
        "bloom",
        "share of the light that glows around bright things",
        0.0..=1.0,
        strength(original.film.bloom),
    )
    .show(ui, &mut bloom);
    film.bloom = (bloom > 0.0).then_some(Bloom { strength: bloom, ..film.bloom.unwrap_or_default() });
    size(&mut viewer.size, ui);
    ComboBox::from_label("tone mapper").selected_text(film.tone_mapper.to_string()).show_ui(ui, |ui| {
        for tone_mapper in ToneMapper::ALL {
            ui.selectable_value(&mut film.tone_mapper, tone_mapper, tone_mapper.to_string());
        }
    });
    if ui
        .button("write the picture")
        .on_hover_text("a PNG beside the others, under the next free number (p)")
        .clicked()
    {
        viewer.write_picture();
    }
    if ui
        .button("save the scene")
        .on_hover_text("a scene file of what is seen; film and method stay out of it")
        .clicked()
    {
        viewer.write_look();
    }
    turntable(viewer, ui);
    open(viewer, ui);
}

/// As large as the window leaves room, or always the same.
fn size(size: &mut Option<[u32; 2]>, ui: &mut Ui) {
    let mut is_fixed = size.is_some();
    let hint = "as large as this, whatever the window leaves room for; both sides alike";
    ui.horizontal(|ui| {
        if ui.checkbox(&mut is_fixed, "size [pixels]").on_hover_text(hint).changed() {
            *size = is_fixed.then_some([500; 2]);
        }
        for side in size.iter_mut().flatten() {
            ui.add(DragValue::new(side).range(1..=4096));
        }
    });
}

/// A turn around the scene, as files.
fn turntable(viewer: &mut Viewer, ui: &mut Ui) {
    let id = ui.scope_id().with("pictures of a turn");
    let mut pictures: u32 = ui.data(|data| data.get_temp(id).unwrap_or(36));
    ui.horizontal(|ui| {
        if viewer.turntable.is_some() {
            if ui.button("stop the turntable").clicked() {
                viewer.end_turntable();
            }
        } else if ui
            .button("turntable")
            .on_hover_text("a turn around the scene as numbered PNG files")
            .clicked()
        {
            viewer.begin_turntable(pictures);
        }
        ui.add(Slider::new(&mut pictures, 2..=720).logarithmic(true).text("pictures"));
    });
    ui.data_mut(|data| data.insert_temp(id, pictures));
}

/// A line for the name of a scene.
fn open(viewer: &mut Viewer, ui: &mut Ui) {
    let id = ui.scope_id().with("scene");
    let mut name: String = ui.data(|data| data.get_temp(id).unwrap_or_default());
    let hint = TextEdit::singleline(&mut name).hint_text("scene, head or environment; or drop one");
    let field = ui.add(hint).on_hover_text("file of a scene, head or environment; Enter opens it");
    if field.lost_focus() && ui.input(|input| input.key_pressed(eframe::egui::Key::Enter)) && !name.is_empty()
    {
        let source: SceneSource = crate::view::files::dropped(&PathBuf::from(&name), &viewer.source);
        viewer.open(ui.ctx(), source);
    }
    ui.data_mut(|data| data.insert_temp(id, name));
}
