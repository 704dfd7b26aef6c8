//! Technique, backend, textures and what is seen of them.

use super::choice::choice;
use crate::backend::Backend;
use crate::cli::DIFFUSIONS;
use crate::view::app::Viewer;
use crate::view::shown::View;
use cutis_render::TechniqueName;
use cutis_render::settings::Quality;
use eframe::egui::{ComboBox, Ui};

/// Sizes of the irradiance texture that can be chosen, texels.
const SIZES: [u32; 5] = [256, 512, 1024, 2048, 4096];
/// Numbers of Gaussians that can be chosen.
const GAUSSIANS: [usize; 8] = [1, 2, 3, 4, 5, 6, 8, 12];

/// Shows it.
pub fn show(viewer: &mut Viewer, ui: &mut Ui) {
    let drawing = &mut viewer.looks[viewer.edited].drawing;
    choice(ui, "technique", &mut drawing.technique, TechniqueName::ALL);
    choice(ui, "diffusion", &mut drawing.diffusion, &DIFFUSIONS);
    choice(ui, "backend", &mut drawing.backend, &Backend::ALL);
    let mut quality = drawing.quality;
    choice(ui, "quality", &mut quality, &Quality::ALL);
    if quality != drawing.quality {
        drawing.set_quality(quality);
    }
    choice(ui, "irradiance texture [texels]", &mut drawing.irradiance_size, &SIZES);
    let before = drawing.gaussians;
    choice(ui, "Gaussians of a medium", &mut drawing.gaussians, &GAUSSIANS);
    if drawing.gaussians != before {
        // Gaussians of another kernel have other numbers.
        drawing.muted_gaussians.clear();
    }
    let views = viewer.views();
    ComboBox::from_label("view (d)").selected_text(name(viewer.shown.view)).show_ui(ui, |ui| {
        for view in views {
            ui.selectable_value(&mut viewer.shown.view, view, name(view));
        }
    });
    ui.checkbox(&mut viewer.shown.wireframe, "triangles (w)");
    if ui.button("see the whole scene").clicked() {
        viewer.frame_scene();
    }
}

fn name(view: View) -> String {
    match view {
        View::Picture => "picture".to_owned(),
        View::Maps => "maps of all passes".to_owned(),
        View::Map(aov) => format!("map {aov}"),
        View::Layer(aov) => aov.to_string(),
    }
}
