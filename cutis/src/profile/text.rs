//! The result as a table for people.

use super::explain::Explanation;
use super::report::{ChannelReport, JointReport, Report, TranslationReport};
use cutis_optics::translate::Value;
use std::fmt::Write;

/// Writing to a String cannot fail.
macro_rules! put {
    ($text:expr, $($words:tt)*) => { { let _ = writeln!($text, $($words)*); } };
}

/// The whole report.
pub fn text(report: &Report) -> String {
    let mut text = String::new();
    put!(text, "{}  ({}; source {})", report.material, report.origin, report.source);
    layers(&mut text, report);
    put!(text, "\nfit       Gaussians   R_d        energy     relative RMS power error   worst error");
    for channel in &report.channels {
        let (fit, name) = (&channel.fit, channel.channel.unwrap_or("all"));
        put!(
            text,
            "{name:3} {:8} {:6}      {:.6}   {:.6}   {:<24} {:.3e} /mm² at {:.3} mm",
            fit.method,
            fit.weights.len(),
            channel.total_diffuse_reflectance,
            fit.energy,
            format!("{:.4} %", 100.0 * fit.relative_rms_power_error),
            fit.worst_absolute_error_per_mm2,
            fit.worst_error_at_mm
        );
        if let Some(error) = channel.total_diffuse_reflectance_standard_error {
            put!(text, "    R_d is simulated: ± {error:.6}");
        }
        if let Some(mm) = channel.beam_standard_deviation_mm {
            put!(text, "    under a beam of standard deviation {mm:.4} mm");
        }
    }
    match &report.joint_kernel {
        Some(kernel) => joint(&mut text, kernel),
        None => report.channels.iter().for_each(|channel| kernel(&mut text, channel)),
    }
    for channel in &report.channels {
        channel.explanation.iter().for_each(|explained| explanation(&mut text, channel, explained));
    }
    report.translations.iter().for_each(|t| translation(&mut text, t));
    put!(text, "\n{:.2} s", report.wall_seconds);
    text
}

fn layers(text: &mut String, report: &Report) {
    if report.channels.iter().all(|channel| channel.layers.is_empty()) {
        return;
    }
    put!(text, "\nlayer      sigma_a [1/mm]   sigma_s' [1/mm]   index    thickness [mm]");
    for channel in &report.channels {
        for (i, layer) in channel.layers.iter().enumerate() {
            let thickness = layer.thickness_mm.map_or_else(|| "endless".to_owned(), |d| d.to_string());
            put!(
                text,
                "{:3} {:<6} {:<16} {:<17} {:<8} {thickness}",
                channel.channel.unwrap_or("all"),
                i + 1,
                six_digits(layer.sigma_a_per_mm),
                six_digits(layer.sigma_s_reduced_per_mm),
                layer.refractive_index
            );
        }
    }
}

/// A number without the digits that arithmetic left.
fn six_digits(value: f64) -> f64 {
    format!("{value:.5e}").parse().expect("a number was printed")
}

fn joint(text: &mut String, kernel: &JointReport) {
    let errors = kernel.relative_rms_power_error.map(|e| format!("{:.4} %", 100.0 * e)).join("  ");
    put!(text, "\njoint kernel, method {}; relative RMS power error r g b: {errors}", kernel.method);
    put!(text, "variance [mm²]   weight r    weight g    weight b");
    for (variance, [r, g, b]) in kernel.variances_mm2.iter().zip(&kernel.weights) {
        put!(text, "{variance:<16.6} {r:<11.6} {g:<11.6} {b:.6}");
    }
}

fn kernel(text: &mut String, channel: &ChannelReport) {
    put!(text, "\nvariance [mm²]   weight {}", channel.channel.unwrap_or_default());
    for (variance, weight) in channel.fit.variances_mm2.iter().zip(&channel.fit.weights) {
        put!(text, "{variance:<16.6} {weight:.6}");
    }
}

fn explanation(text: &mut String, channel: &ChannelReport, explained: &Explanation) {
    let name = channel.channel.map_or_else(|| "all channels".to_owned(), |c| format!("channel {c}"));
    let transmittance =
        explained.total_transmittance.map_or_else(|| "not known".to_owned(), |t| format!("{t:.6}"));
    put!(text, "\n{name}: R_d {:.6}, T_d {transmittance}", explained.total_diffuse_reflectance);
    for (i, layer) in explained.layers.iter().enumerate() {
        let diffuse =
            layer.diffuse_mean_free_path_mm.map_or_else(|| "endless".to_owned(), |l| format!("{l:.4} mm"));
        put!(text, "  layer {}: reduced albedo {:.6}", i + 1, layer.albedo_reduced);
        put!(text, "    transport mean free path {:.4} mm (1/sigma_t')", layer.transport_mean_free_path_mm);
        put!(text, "    diffuse mean free path   {diffuse} (1/sigma_tr)");
        put!(text, "    {}", layer.verdict);
    }
    put!(text, "  Gaussians   energy     relative RMS power error ({})", channel.fit.method);
    for trial in &explained.fits {
        let error = 100.0 * trial.relative_rms_power_error;
        put!(text, "  {:<11} {:.6}   {error:.4} %", trial.gaussians, trial.energy);
    }
}

fn translation(text: &mut String, translation: &TranslationReport) {
    put!(text, "\n{}: {}", translation.target, translation.place);
    for field in &translation.fields {
        let value = match &field.value {
            Value::Flag(flag) => flag.to_string(),
            Value::Word(word) => (*word).to_owned(),
            Value::Number(number) => number.to_string(),
            Value::Rgb([r, g, b]) => format!("{r} {g} {b}"),
        };
        let unit = if field.unit == "none" { String::new() } else { format!(" {}", field.unit) };
        put!(text, "  {:32} {value}{unit}  ({})", field.name, field.meaning);
    }
    translation.notes.iter().for_each(|note| put!(text, "  note: {note}"));
    put!(text, "  loss: relative RMS power error under a beam of standard deviation b, change of the total");
    for (name, loss) in ["r", "g", "b"].iter().zip(&translation.loss) {
        let lit = |error: &cutis_optics::translate::loss::LitError| {
            format!(
                "{:.2} % (b = {:.4} mm)",
                100.0 * error.relative_rms_power_error,
                error.beam_standard_deviation_mm
            )
        };
        // Adding 0 takes the sign from what rounds to nothing.
        let change = (1e6 * loss.relative_change_of_total).round() * 1e-4 + 0.0;
        put!(text, "  {name}  {}   {}   {change:+.4} %", lit(&loss.fine), lit(&loss.wide));
    }
}
