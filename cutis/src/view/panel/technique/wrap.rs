//! Numbers of `wrap`.

use super::{colour, optional};
use crate::view::panel::choice::choice;
use crate::view::panel::number::{Number, linear};
use cutis_render::technique::wrap::{WrapForm, WrapSettings, WrapShine};
use eframe::egui::Ui;

/// Radius of the body that is begun with, mm: about that of a head.
const BODY_MM: f32 = 80.0;

/// Shows them.
pub fn show(settings: &mut WrapSettings, ui: &mut Ui) {
    let usual = WrapSettings::default();
    let hint = "how far light goes on beyond the terminator, as a cosine; not with a radius of the body";
    linear("wrap", hint, 0.0..=1.0, usual.wrap).show(ui, &mut settings.wrap);
    let radius = Number {
        is_logarithmic: true,
        ..linear(
            "radius [mm]",
            "each channel wraps as far as the material spreads light over a body of this radius",
            1.0..=1000.0,
            BODY_MM,
        )
    };
    optional(ui, "wrap by the radius of the body", &mut settings.radius_mm, BODY_MM, radius);
    let hint = "width of the tint where light ends, in wrapped cosines";
    linear("scatter width", hint, 0.0..=1.0, usual.scatter_width).show(ui, &mut settings.scatter_width);
    let hint = "tint where light ends, linear, parts of the irradiance";
    colour(ui, "scatter colour", hint, &mut settings.scatter_colour, usual.scatter_colour);
    ui.checkbox(&mut settings.energy_conserving, "energy conserving")
        .on_hover_text("a whole ball sends back no more light than a Lambertian one");
    choice(ui, "evaluated by", &mut settings.form, &WrapForm::ALL);
    let hint = "how far above the surface a place beyond the terminator looks for what hides a light";
    linear("shadow offset [mm]", hint, 0.0..=20.0, usual.shadow_offset_mm)
        .show(ui, &mut settings.shadow_offset_mm);
    choice(ui, "shine", &mut settings.shine, &WrapShine::ALL);
    if settings.shine == WrapShine::Power {
        let hint = "exponent of N·H";
        let number = linear("shininess", hint, 1.0..=1000.0, usual.shininess);
        Number { is_logarithmic: true, ..number }.show(ui, &mut settings.shininess);
        let hint = "colour of the power, linear, parts of the irradiance";
        colour(ui, "specular colour", hint, &mut settings.specular_colour, usual.specular_colour);
    }
}
