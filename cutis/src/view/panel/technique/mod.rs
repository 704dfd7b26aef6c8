//! Numbers that the chosen technique has of its own.

mod depth_absorption;
mod image_space;
mod ramp;
mod texture_blur;
mod wrap;

use super::number::Number;
use crate::techniques::paper::Paper;
use crate::techniques::take_own;
use crate::view::app::Viewer;
use cutis_render::TechniqueName;
use cutis_render::settings::TechniqueSettings;
use eframe::egui::{CollapsingHeader, Ui};
use glam::Vec3;

/// Shows them; nothing for a technique without any.
pub fn show(viewer: &mut Viewer, ui: &mut Ui) {
    let technique = viewer.looks[viewer.edited].drawing.technique;
    let Some(title) = title(technique) else { return };
    CollapsingHeader::new(title).id_salt(("technique", technique.to_string())).default_open(true).show(
        ui,
        |ui| {
            let settings = &mut viewer.looks[viewer.edited].drawing.techniques;
            match technique {
                TechniqueName::Wrap => wrap::show(&mut settings.wrap, ui),
                TechniqueName::DepthAbsorption => depth_absorption::show(&mut settings.depth_absorption, ui),
                TechniqueName::TextureBlur => texture_blur::show(&mut settings.texture_blur, ui),
                TechniqueName::ImageSpace => image_space::show(&mut settings.image_space, ui),
                TechniqueName::TextureSpace | TechniqueName::Truth => {}
            }
            papers(viewer, technique, ui);
        },
    );
}

fn title(technique: TechniqueName) -> Option<&'static str> {
    match technique {
        TechniqueName::Wrap => Some("Wrap (Green 2004)"),
        TechniqueName::DepthAbsorption => Some("Depth absorption (Green 2004)"),
        TechniqueName::TextureBlur => Some("Texture blur (Green 2004)"),
        TechniqueName::ImageSpace => Some("Image space (Mertens et al. 2003)"),
        TechniqueName::TextureSpace | TechniqueName::Truth => None,
    }
}

/// Ways back: to the defaults, and to what the technique's paper had.
fn papers(viewer: &mut Viewer, technique: TechniqueName, ui: &mut Ui) {
    if ui.button("reset all").on_hover_text("every number of this technique as by default").clicked() {
        let settings = &mut viewer.looks[viewer.edited].drawing.techniques;
        take_own(settings, &TechniqueSettings::default(), technique);
    }
    for paper in Paper::ALL.into_iter().filter(|paper| paper.techniques().contains(&technique)) {
        if ui.button(paper.title()).on_hover_text(hint(paper)).clicked() {
            viewer.draw_as_in(paper);
        }
    }
}

fn hint(paper: Paper) -> &'static str {
    match paper {
        Paper::Green2004 => "this technique with the numbers of the paper's listings",
        Paper::Mertens2003 => {
            "without Jacobian and views of lights; a picture of 500 x 500 pixels; the measured material skin1, whose mean free \
             path is as long on this scene as it is on one of 10 cm"
        }
    }
}

/// A colour with three numbers, linear.
fn colour(ui: &mut Ui, name: &'static str, hint: &'static str, value: &mut Vec3, original: Vec3) {
    ui.horizontal(|ui| {
        let back = eframe::egui::Button::new("reset").small();
        let [r, g, b] = original.to_array();
        let told = format!("back to {r}, {g}, {b}: {name}");
        if ui.add_enabled(*value != original, back).on_hover_text(told).clicked() {
            *value = original;
        }
        let mut rgb = value.to_array();
        ui.color_edit_button_rgb(&mut rgb);
        *value = Vec3::from(rgb);
        ui.label(name).on_hover_text(hint);
    });
}

/// A number that may be left to the program; `chosen` is what it begins with.
fn optional(ui: &mut Ui, words: &str, value: &mut Option<f32>, chosen: f32, number: Number) {
    let mut on = value.is_some();
    if ui.checkbox(&mut on, words).on_hover_text(number.hint).changed() {
        *value = on.then_some(chosen);
    }
    if let Some(value) = value {
        number.show(ui, value);
    }
}
