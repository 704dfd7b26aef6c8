//! Numbers of `texture-blur`.

use crate::view::panel::choice::choice;
use crate::view::panel::number::linear;
use cutis_render::technique::texture_blur::{BlurWeights, BlurWidth, TextureBlurSettings};
use eframe::egui::Ui;

/// Shows them.
pub fn show(settings: &mut TextureBlurSettings, ui: &mut Ui) {
    let usual = TextureBlurSettings::default();
    choice(ui, "weights", &mut settings.weights, &BlurWeights::ALL);
    let hint = "how often the light map is blurred, each time along u and along v";
    linear("passes", hint, 0.0..=64.0, usual.passes as f32).show_whole(ui, &mut settings.passes);
    let mut by_material = settings.width == BlurWidth::Material;
    let hint = "so wide that all passes together spread red as far as the material does";
    if ui.checkbox(&mut by_material, "as wide as the material asks for").on_hover_text(hint).changed() {
        settings.width = if by_material { BlurWidth::Material } else { BlurWidth::Listing(1.0) };
    }
    if let BlurWidth::Listing(factor) = &mut settings.width {
        let hint = "times the listing's, whose taps lie two texels apart";
        linear("× width", hint, 0.0..=64.0, 1.0).show(ui, factor);
    }
    linear("blend", "share of the blurred map in what leaves", 0.0..=1.0, usual.blend)
        .show(ui, &mut settings.blend);
    ui.checkbox(&mut settings.depth, "light through thin parts")
        .on_hover_text("as depth-absorption finds it, in the map before it is blurred");
}
