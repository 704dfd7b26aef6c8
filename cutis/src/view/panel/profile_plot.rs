//! How far light spreads: the kernel as curves of the three channels.

use cutis_render::prepare::Kernel;
use eframe::egui::{Color32, Ui};
use egui_plot::{GridInput, Legend, Line, Plot, PlotPoints, uniform_grid_spacer};
use std::f32::consts::TAU;

/// Points of a curve.
const POINTS: usize = 128;
/// Standard deviations of the widest Gaussian that are shown.
const DEVIATIONS: f32 = 2.5;
/// Names and colours of the channels.
const CHANNELS: [(&str, Color32); 3] = [
    ("red", Color32::from_rgb(230, 70, 60)),
    ("green", Color32::from_rgb(80, 190, 90)),
    ("blue", Color32::from_rgb(90, 130, 240)),
];

/// Shows it: share of the light that leaves in a ring, per millimetre of its radius.
pub fn show(ui: &mut Ui, kernel: &Kernel) {
    let reach_mm = (DEVIATIONS * kernel.reach_mm()).max(0.1);
    Plot::new("profile")
        .height(150.0)
        .legend(Legend::default())
        .x_grid_spacer(uniform_grid_spacer(steps))
        .y_grid_spacer(uniform_grid_spacer(steps))
        .x_axis_label("r [mm]")
        .y_axis_label("2πr R(r) [1/mm]")
        .allow_scroll(false)
        .allow_drag(false)
        .allow_zoom(false)
        .include_x(0.0)
        .include_x(reach_mm)
        .include_y(0.0)
        .show(ui, |plot| {
            for (c, (name, colour)) in CHANNELS.into_iter().enumerate() {
                let point = |i: usize| {
                    // Closer together at the centre, where the narrowest Gaussian peaks.
                    let r_mm = reach_mm * (i as f32 / POINTS as f32).powi(2);
                    [f64::from(r_mm), f64::from(ring_per_mm(kernel, c, r_mm))]
                };
                let points: PlotPoints = (0..=POINTS).map(point).collect();
                plot.line(Line::new(name, points).color(colour));
            }
        });
}

/// Distances of lines: two or more of the widest with their numbers, whatever is shown.
fn steps(shown: GridInput) -> [f64; 3] {
    let half = 0.5 * (shown.bounds.1 - shown.bounds.0).max(1e-9);
    let power = 10f64.powf(half.log10().floor());
    let round = [5.0, 2.0, 1.0].into_iter().find(|round| round * power <= half).unwrap_or(1.0) * power;
    [round, 0.5 * round, 0.1 * round]
}

/// Light that leaves between r and r + dr, over dr, 1/mm.
fn ring_per_mm(kernel: &Kernel, channel: usize, r_mm: f32) -> f32 {
    let terms = kernel.variances_mm2.iter().zip(&kernel.weights);
    let terms = terms.filter(|(v, _)| **v > 0.0);
    terms.map(|(v, w)| TAU * r_mm * w[channel] * (-0.5 * r_mm * r_mm / v).exp() / (TAU * v)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn the_area_under_a_curve_is_the_weight() {
        let kernel = Kernel {
            variances_mm2: vec![0.0, 0.04, 1.0],
            weights: vec![Vec3::ONE, Vec3::splat(0.3), Vec3::splat(0.5)],
        };
        let step = 1e-3;
        let area: f32 = (0..8000).map(|i| step * ring_per_mm(&kernel, 1, (i as f32 + 0.5) * step)).sum();
        assert!((area - 0.8).abs() < 1e-3, "{area}");
    }
}
