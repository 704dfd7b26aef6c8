//! One of some values, chosen by name.

use eframe::egui::{ComboBox, Ui};
use std::fmt::Display;

/// Shows it.
pub fn choice<T: Display + PartialEq + Copy>(ui: &mut Ui, label: &str, value: &mut T, all: &[T]) {
    ComboBox::from_label(label).selected_text(value.to_string()).show_ui(ui, |ui| {
        for one in all {
            ui.selectable_value(value, *one, one.to_string());
        }
    });
}
