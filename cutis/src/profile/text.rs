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
    put!(text, "\nfit       Gaussians   R_d          energy       relative RMS power error   worst error");
    for channel in &report.channels {
        let (fit, name) = (&channel.fit, channel.channel.unwrap_or("all"));
        put!(
            text,
            "{name:3} {:8} {:6}      {:<11}  {:<11}  {:<24} {:.3e} /mm² at {} mm",
            fit.method,
            fit.weights.len(),
            digits(6, channel.total_diffuse_reflectance),
            digits(6, fit.energy),
            percent(fit.relative_rms_power_error),
            fit.worst_absolute_error_per_mm2,
            digits(3, fit.worst_error_at_mm)
        );
        if let Some(error) = channel.total_diffuse_reflectance_standard_error {
            put!(text, "    R_d is simulated: ± {}", digits(2, error));
        }
        if let Some(total) = channel.total_transmittance {
            put!(text, "    T_d {}, comes out below", digits(6, total));
        }
        if let Some(mm) = channel.beam_standard_deviation_mm {
            put!(text, "    under a beam of standard deviation {} mm", digits(4, mm));
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

/// So many significant digits, however small the number; powers of ten where zeros would take more room.
fn digits(count: usize, value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    if !(1e-4..1e6).contains(&size) {
        return format!("{value:.*e}", count - 1);
    }
    let before_point = size.log10().floor() as i32 + 1;
    format!("{value:.*}", (count as i32 - before_point).max(0) as usize)
}

fn percent(part: f64) -> String {
    format!("{} %", digits(4, 100.0 * part))
}

fn joint(text: &mut String, kernel: &JointReport) {
    let errors = kernel.relative_rms_power_error.map(percent).join("  ");
    put!(text, "\njoint kernel, method {}; relative RMS power error r g b: {errors}", kernel.method);
    put!(text, "variance [mm²]   weight r    weight g    weight b");
    for (variance, weights) in kernel.variances_mm2.iter().zip(&kernel.weights) {
        let [r, g, b] = weights.map(|w| digits(6, w));
        put!(text, "{:<16} {r:<11} {g:<11} {b}", digits(6, *variance));
    }
}

fn kernel(text: &mut String, channel: &ChannelReport) {
    put!(text, "\nvariance [mm²]   weight {}", channel.channel.unwrap_or_default());
    for (variance, weight) in channel.fit.variances_mm2.iter().zip(&channel.fit.weights) {
        put!(text, "{:<16} {}", digits(6, *variance), digits(6, *weight));
    }
}

fn explanation(text: &mut String, channel: &ChannelReport, explained: &Explanation) {
    let name = channel.channel.map_or_else(|| "all channels".to_owned(), |c| format!("channel {c}"));
    let transmittance =
        explained.total_transmittance.map_or_else(|| "not known".to_owned(), |t| digits(6, t));
    put!(text, "\n{name}: R_d {}, T_d {transmittance}", digits(6, explained.total_diffuse_reflectance));
    for trust in &explained.sources {
        let holds = if trust.holds { "holds" } else { "does not hold" };
        put!(text, "  {:<13} {holds}: {}", trust.source, trust.words);
    }
    for (i, layer) in explained.layers.iter().enumerate() {
        let diffuse = layer
            .diffuse_mean_free_path_mm
            .map_or_else(|| "endless".to_owned(), |l| format!("{} mm", digits(4, l)));
        put!(text, "  layer {}: reduced albedo {}", i + 1, digits(6, layer.albedo_reduced));
        let transport = digits(4, layer.transport_mean_free_path_mm);
        put!(text, "    transport mean free path {transport} mm (1/sigma_t')");
        put!(text, "    diffuse mean free path   {diffuse} (1/sigma_tr)");
        put!(text, "    {}", layer.verdict);
    }
    put!(text, "  Gaussians   energy       relative RMS power error ({})", channel.fit.method);
    for trial in &explained.fits {
        let (energy, error) = (digits(6, trial.energy), percent(trial.relative_rms_power_error));
        put!(text, "  {:<11} {energy:<11}  {error}", trial.gaussians);
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
