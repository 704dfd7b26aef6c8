//! A number that can be changed: slider, unit, and the way back.

use eframe::egui::{Slider, SliderClamping, Ui};
use std::ops::RangeInclusive;

/// What a slider is about.
#[derive(Debug, Clone)]
pub struct Number {
    /// Name, with the unit in brackets if there is one.
    pub name: &'static str,
    /// What it means.
    pub hint: &'static str,
    /// Least and greatest.
    pub range: RangeInclusive<f32>,
    /// Whether steps are factors.
    pub is_logarithmic: bool,
    /// What it goes back to.
    pub original: f32,
}

impl Number {
    /// Slider and button for the way back.
    pub fn show(self, ui: &mut Ui, value: &mut f32) {
        self.with_decimals(3, ui, value);
    }

    fn with_decimals(self, most: usize, ui: &mut Ui, value: &mut f32) {
        ui.horizontal(|ui| {
            let is_changed = *value != self.original;
            let back = ui.add_enabled(is_changed, eframe::egui::Button::new("reset").small());
            if back.on_hover_text(format!("back to {:.3}: {}", self.original, self.name)).clicked() {
                *value = self.original;
            }
            // A scene may hold more than the slider reaches; only what a person moves is held to its range.
            let slider = Slider::new(value, self.range)
                .clamping(SliderClamping::Edits)
                .logarithmic(self.is_logarithmic)
                .text(self.name);
            ui.add(slider.max_decimals(most)).on_hover_text(self.hint);
        });
    }

    /// The same for a number that counts; it is exact up to 2^24.
    pub fn show_whole(self, ui: &mut Ui, value: &mut u32) {
        let mut shown = *value as f32;
        self.with_decimals(0, ui, &mut shown);
        if shown != *value as f32 {
            *value = shown.round().max(0.0) as u32;
        }
    }
}

/// A factor around 1, as a slider.
pub fn factor(name: &'static str, hint: &'static str, range: RangeInclusive<f32>) -> Number {
    Number { name, hint, range, is_logarithmic: true, original: 1.0 }
}

/// A number with even steps.
pub fn linear(name: &'static str, hint: &'static str, range: RangeInclusive<f32>, original: f32) -> Number {
    Number { name, hint, range, is_logarithmic: false, original }
}
