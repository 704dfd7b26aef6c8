//! `cutis diff`: how far a picture is from a reference.

use crate::cli::DiffArgs;
use crate::job::refused;
use crate::measure::{Measured, MeasuredReport, Seen, map_png, pixels_per_degree_in_range};
use crate::{Outcome, talk, whole_file};
use cutis_render::difference::magma;
use cutis_scene::{PictureFile, read_picture};
use miette::{IntoDiagnostic, Result, bail, miette};
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

/// Runs the command.
pub fn run(args: &DiffArgs) -> Result<Outcome> {
    let start = Instant::now();
    check(args)?;
    let layer = args.layer.as_deref();
    let [test, reference] = [&args.picture, &args.reference].map(|path| read_picture(path, layer));
    let (test, reference) = (test.map_err(refused)?, reference.map_err(refused)?);
    check_pair(args, &test, &reference)?;
    let (width, height, linear) = (test.width, test.height, test.scene_referred);
    let [test, reference] = [test, reference].map(seen);
    let measured = Measured::new(&test, &reference, args.pixels_per_degree).map_err(refused)?;
    if let Some(path) = &args.output {
        let map = map_png(test.width, &measured.flip().errors, magma)?;
        whole_file::write_all(&[(path.as_path(), &map)])?;
    }
    let report = Report {
        version: env!("CARGO_PKG_VERSION"),
        picture: shown(&args.picture),
        reference: shown(&args.reference),
        layer: args.layer.clone(),
        width,
        height,
        encoding: if linear { "linear" } else { "display" },
        pixels_per_degree: args.pixels_per_degree,
        measured: MeasuredReport::new(&measured),
        map: args.output.as_deref().map(shown),
        wall_seconds: start.elapsed().as_secs_f64(),
    };
    if args.json {
        talk::say(&serde_json::to_string_pretty(&report).into_diagnostic()?)?;
    } else {
        talk::say(text(&report).trim_end())?;
    }
    let failed = args.fail_above.is_some_and(|limit| measured.flip().mean > limit);
    Ok(if failed { Outcome::CheckFailed } else { Outcome::Done })
}

/// The result as one JSON object.
#[derive(Debug, Serialize)]
struct Report {
    version: &'static str,
    picture: String,
    reference: String,
    layer: Option<String>,
    width: u32,
    height: u32,
    encoding: &'static str,
    pixels_per_degree: f64,
    #[serde(flatten)]
    measured: MeasuredReport,
    map: Option<String>,
    wall_seconds: f64,
}

/// Everything that can be checked before a file is read.
fn check(args: &DiffArgs) -> Result<()> {
    pixels_per_degree_in_range(args.pixels_per_degree)?;
    if let Some(limit) = args.fail_above.filter(|limit| !(0.0..=1.0).contains(limit)) {
        bail!("--fail-above must be 0 to 1, got {limit}");
    }
    let Some(path) = &args.output else { return Ok(()) };
    if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
        bail!("{}: the map is written as .png", path.display());
    }
    whole_file::check(path)
}

/// Refuses two pictures that have nothing to do with each other.
fn check_pair(args: &DiffArgs, test: &PictureFile, reference: &PictureFile) -> Result<()> {
    let (a, b) = (args.picture.display(), args.reference.display());
    if (test.width, test.height) != (reference.width, reference.height) {
        let size = |file: &PictureFile| format!("{} x {}", file.width, file.height);
        bail!(
            "{a} has {} pixels and {b} has {}; only pictures of one size compare",
            size(test),
            size(reference)
        );
    }
    if test.scene_referred != reference.scene_referred {
        let kind = |file: &PictureFile| {
            if file.scene_referred { "linear light" } else { "a picture for a screen" }
        };
        return Err(miette!(
            help = "render both as .png or both as .exr",
            "{a} holds {} and {b} {}; that compares nothing",
            kind(test),
            kind(reference)
        ));
    }
    Ok(())
}

fn seen(file: PictureFile) -> Seen {
    if file.scene_referred {
        Seen::developed(file.width, file.height, file.pixels, 0.0)
    } else {
        Seen::on_screen(file.width, &file.pixels)
    }
}

fn shown(path: &Path) -> String {
    path.display().to_string()
}

fn text(report: &Report) -> String {
    let Report { picture, reference, width, height, encoding, measured, .. } = report;
    let mut text = format!("{picture} against {reference}: {width} x {height} pixels, {encoding}\n");
    let mut line = |name: &str, value: String| {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{name:<14} {value}");
    };
    if let Some(layer) = &report.layer {
        line("layer", layer.clone());
    }
    line("RMSE", format!("{:.6}", measured.rmse));
    line(
        "relative MSE",
        format!("{:.6}  (epsilon {})", measured.relative_mse, measured.relative_mse_epsilon),
    );
    let bias = [0, 1, 2].map(|c| bias(measured.bias_rgb[c], measured.relative_bias_rgb[c]));
    line("bias R, G, B", bias.join("  "));
    let ldr = &measured.flip_ldr;
    line("FLIP (LDR)", format!("{:.6} mean, {:.6} largest", ldr.mean, ldr.max));
    if let Some(hdr) = &measured.flip_hdr {
        line(
            "FLIP (HDR)",
            format!(
                "{:.6} mean, {:.6} largest, {} exposures from {:.2} to {:.2} EV",
                hdr.mean, hdr.max, hdr.exposures, hdr.start_exposure_ev, hdr.stop_exposure_ev
            ),
        );
    }
    if let Some(map) = &report.map {
        line("map", map.clone());
    }
    text
}

fn bias(absolute: f64, relative: Option<f64>) -> String {
    let relative = relative.map_or_else(String::new, |part| format!(" ({:+.2} %)", 100.0 * part));
    format!("{absolute:+.6}{relative}")
}
