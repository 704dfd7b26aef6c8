//! How long each pass took, what it would cost another machine, and what should be known of the picture.

use crate::view::app::Viewer;
use crate::view::painter::Work;
use cutis_gpu::cost::{Cost, total};
use eframe::egui::{Grid, Ui};

/// Bytes of a megabyte.
const MEGABYTE: f64 = 1e6;

/// Shows it.
pub fn show(viewer: &Viewer, ui: &mut Ui) {
    let Some(painted) = &viewer.sides[viewer.edited].painted else {
        ui.label("nothing is drawn yet");
        return;
    };
    Grid::new("times").num_columns(2).striped(true).show(ui, |ui| {
        for pass in &painted.frame.passes {
            ui.label(&pass.name);
            ui.label(format!("{:.2} ms", pass.time.as_secs_f64() * 1e3));
            ui.end_row();
        }
    });
    if let Some(work) = &painted.work {
        costs(work, ui);
    }
    for warning in &painted.frame.warnings {
        ui.label(format!("warning: {warning}"));
    }
}

/// What a frame moves through memory, pass by pass: another adapter takes at least this over its bandwidth.
fn costs(work: &Work, ui: &mut Ui) {
    let sum = total(&work.costs);
    ui.label(format!("kept: {:.0} MB; a whole frame moves at least:", work.memory_bytes as f64 / MEGABYTE));
    Grid::new("costs").num_columns(4).striped(true).show(ui, |ui| {
        for title in ["pass", "reads [MB]", "writes [MB]", "taps [million]"] {
            ui.label(title);
        }
        ui.end_row();
        for cost in work.costs.iter().chain([&sum]) {
            row(cost, ui);
        }
    });
    ui.label(format!("on an adapter that moves 1 TB/s: {:.2} ms or more", sum.milliseconds(1000.0)));
}

fn row(cost: &Cost, ui: &mut Ui) {
    ui.label(cost.pass);
    ui.label(format!("{:.1}", cost.read_bytes as f64 / MEGABYTE));
    ui.label(format!("{:.1}", cost.written_bytes as f64 / MEGABYTE));
    ui.label(format!("{:.1}", cost.taps as f64 / 1e6));
    ui.end_row();
}
