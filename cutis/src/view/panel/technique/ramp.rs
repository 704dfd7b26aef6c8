//! A colour ramp: stops that are moved, coloured, put in and taken out.

use cutis_render::prepare::ColourRamp;
use eframe::egui::{DragValue, Ui};
use glam::Vec3;
use std::sync::Arc;

/// Most stops that can be put in here.
const MOST: usize = 12;
/// Least distance between two stops, mm: the drags' step.
const STEP_MM: f32 = 0.1;

/// The one that is begun with: warm, as through an ear.
pub fn usual() -> ColourRamp {
    let stops = vec![(0.0, Vec3::new(1.0, 0.9, 0.8)), (4.0, Vec3::new(0.5, 0.1, 0.05)), (20.0, Vec3::ZERO)];
    ColourRamp::new(stops).expect("three growing distances")
}

/// Shows it.
pub fn show(ramp: &mut Arc<ColourRamp>, ui: &mut Ui) {
    let mut stops = ramp.stops().to_vec();
    let mut taken_out = None;
    for i in 0..stops.len() {
        let least_mm = if i == 0 { 0.0 } else { stops[i - 1].0 + STEP_MM };
        let most_mm = stops.get(i + 1).map_or(1000.0, |next| next.0 - STEP_MM).max(least_mm);
        ui.horizontal(|ui| {
            let drag = DragValue::new(&mut stops[i].0).range(least_mm..=most_mm).speed(STEP_MM);
            ui.add(drag.suffix(" mm").max_decimals(2)).on_hover_text("distance through the body");
            let mut rgb = stops[i].1.to_array();
            ui.color_edit_button_rgb(&mut rgb).on_hover_text("what is left of the light, linear");
            stops[i].1 = Vec3::from(rgb);
            if ramp.stops().len() > 2 && ui.small_button("take out").clicked() {
                taken_out = Some(i);
            }
        });
    }
    taken_out.map(|i| stops.remove(i));
    if stops.len() < MOST && ui.button("one more stop").clicked() {
        let last = stops[stops.len() - 1];
        stops.push((last.0 + 10.0 * STEP_MM, last.1));
    }
    if stops != ramp.stops()
        && let Ok(changed) = ColourRamp::new(stops)
    {
        *ramp = Arc::new(changed);
    }
}
