//! Numbers of `image-space`.

use super::optional;
use crate::view::panel::choice::choice;
use crate::view::panel::number::{Number, linear};
use cutis_render::technique::image_space::{ImageSpaceProfile, ImageSpaceSettings, SampleCount};
use eframe::egui::Ui;

/// Radius of the disc that is begun with, mm.
const DISC_MM: f32 = 5.0;

/// Shows them.
pub fn show(settings: &mut ImageSpaceSettings, ui: &mut Ui) {
    let usual = ImageSpaceSettings::default();
    let hint = "samples of the diffusion profile for a sample of the picture";
    let number = linear("samples", hint, 1.0..=4096.0, usual.samples as f32);
    Number { is_logarithmic: true, ..number }.show_whole(ui, &mut settings.samples);
    let hint = "samples that are spread evenly over a disc: they find light beyond a shadow's border";
    let number = linear("uniform samples", hint, 0.0..=4096.0, usual.uniform_samples as f32);
    Number { is_logarithmic: true, ..number }.show_whole(ui, &mut settings.uniform_samples);
    let hint = "radius of that disc; left to the program it holds 95 % of the light";
    let radius = Number { is_logarithmic: true, ..linear("disc radius [mm]", hint, 0.05..=100.0, DISC_MM) };
    optional(ui, "a radius for the disc", &mut settings.uniform_radius_mm, DISC_MM, radius);
    ui.checkbox(&mut settings.jacobian, "Jacobian").on_hover_text(
        "areas on the tangent plane are turned into areas on the body; the paper leaves that out",
    );
    ui.checkbox(&mut settings.light_views, "views of lights")
        .on_hover_text("light that enters on the far side is taken from images that the lights see");
    choice(ui, "divided by samples", &mut settings.count, &SampleCount::ALL);
    choice(ui, "profile", &mut settings.profile, &ImageSpaceProfile::ALL);
}
