//! Pictures of the built-in head, as small as they can be.

mod common;

use common::{TINY, assert_refused, cutis, names, number, run, stderr, stdout};
use exr::prelude::{ReadChannels, ReadLayers};
use std::path::Path;

fn render(folder: &Path, args: &[&str]) -> String {
    let output = run(folder, &[&TINY[..], args].concat());
    assert_eq!(output.status.code(), Some(0), "{args:?}: {}", stderr(&output));
    stdout(&output)
}

#[test]
fn a_png_of_the_built_in_head_is_no_black_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    assert_eq!(render(folder.path(), &[]), "cutis.png\n");
    assert_eq!(names(folder.path()), ["cutis.png"]);
    let picture = image::open(folder.path().join("cutis.png")).expect("a PNG");
    assert_eq!((picture.width(), picture.height()), (48, 40));
    let bright = picture.to_rgb8().pixels().filter(|p| p.0.iter().any(|&c| c > 60)).count();
    // A head fills at least a tenth of its picture.
    assert!(bright > 48 * 40 / 10, "{bright}");
}

#[test]
fn an_exr_holds_the_layers_by_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let layers = ["--aov", "irradiance", "--aov", "normal", "--aov", "irradiance"];
    render(folder.path(), &[&["-o", "head.exr", "--bits", "32"][..], &layers].concat());
    assert_eq!(names(folder.path()), ["head.exr"]);
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_file(folder.path().join("head.exr"))
        .expect("an EXR");
    let channels = image.layer_data.iter().flat_map(|layer| &layer.channel_data.list);
    let found: Vec<_> = channels.map(|channel| channel.name.to_string()).collect();
    for name in ["R", "G", "B", "A", "irradiance.R", "irradiance.G", "irradiance.B"] {
        assert_eq!(found.iter().filter(|found| *found == name).count(), 1, "{name} in {found:?}");
    }
    assert_eq!(found.iter().filter(|name| name.starts_with("normal.")).count(), 3, "{found:?}");
}

#[test]
fn textures_are_parts_of_their_own_size() {
    let folder = tempfile::tempdir().expect("a folder");
    render(folder.path(), &["-o", "head.exr", "--aov", "stretch", "--aov-space", "texture"]);
    let meta = exr::meta::MetaData::read_from_file(folder.path().join("head.exr"), false).expect("an EXR");
    let sizes: Vec<_> =
        meta.headers.iter().map(|header| header.layer_size.into()).collect::<Vec<(usize, usize)>>();
    assert_eq!(sizes, [(48, 40), (64, 64)]);
    let name = meta.headers[1].own_attributes.layer_name.as_ref().map(ToString::to_string);
    assert_eq!(name.as_deref(), Some("stretch"));
}

#[test]
fn layers_of_a_png_lie_beside_it_and_their_range_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = run(folder.path(), &[&TINY[..], &["-o", "head.png", "--aov", "normal"]].concat());
    assert_eq!(names(folder.path()), ["head.normal.png", "head.png"]);
    assert_eq!(stdout(&output), "head.png\n");
    assert!(stderr(&output).contains("head.normal.png: black is -1, white is 1"), "{}", stderr(&output));
}

#[test]
fn the_json_object_is_complete_and_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    let printed = render(folder.path(), &["--json", "--aov", "albedo", "--seed", "7", "-v"]);
    let json: serde_json::Value = serde_json::from_str(&printed).expect("one JSON object and nothing else");
    assert_eq!(json["technique"], "texture-space");
    assert_eq!(json["backend"], "cpu");
    assert!(json["adapter"].as_str().is_some_and(|name| !name.is_empty()));
    assert_eq!((json["width"].as_u64(), json["height"].as_u64()), (Some(48), Some(40)));
    assert_eq!(json["seed"], 7);
    assert_eq!(json["output"], "cutis.png");
    assert_eq!(json["layers"][0]["name"], "albedo");
    assert!(json["warnings"].is_array());
    assert!(json["peak_memory_mib"].as_f64().is_none_or(|mib| mib > 1.0));
    let passes = json["passes"].as_array().expect("a list");
    let total: f64 = passes.iter().map(|pass| pass["milliseconds"].as_f64().expect("a number")).sum();
    let wall = json["wall_seconds"].as_f64().expect("a number");
    assert!(wall > 0.0 && total <= wall * 1e3, "{total} ms of {wall} s");
    for name in ["read", "irradiance", "links", "heat flow", "resolve", "bloom", "tone map", "write"] {
        assert!(
            passes.iter().any(|pass| pass["name"].as_str().is_some_and(|n| n.starts_with(name))),
            "{name}"
        );
    }
}

#[test]
fn the_same_seed_gives_the_same_bytes_on_one_thread_and_on_two() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["a.png", "a.exr"] {
        let bytes = |threads: &str, seed: &str| {
            render(folder.path(), &["-o", name, "--threads", threads, "--seed", seed, "--aov", "irradiance"]);
            std::fs::read(folder.path().join(name)).expect("written")
        };
        let first = bytes("1", "3");
        assert!(first == bytes("2", "3"), "{name} differs between one thread and two");
        assert!(first == bytes("2", "3"), "{name} differs between two runs");
        assert!(first != bytes("2", "4"), "{name} does not depend on the seed");
    }
}

#[test]
fn a_failed_run_leaves_the_old_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("cutis.png"), "old").expect("written");
    std::fs::write(folder.path().join("bad.obj"), "v 1 2 nan\nf 1 1 1\n").expect("written");
    assert_refused(folder.path(), &["render", "bad.obj", "--size", "32x32"], "bad.obj");
    assert_eq!(std::fs::read_to_string(folder.path().join("cutis.png")).expect("there"), "old");
    assert_eq!(names(folder.path()), ["bad.obj", "cutis.png"]);
}

#[test]
fn talk_in_a_log_is_plain_lines_one_per_pass() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = run(folder.path(), &[&TINY[..], &["-v"]].concat());
    let said = stderr(&output);
    assert!(!said.contains('\u{1b}'), "{said:?}");
    assert_eq!(said.lines().filter(|line| line.trim() == "INFO resolve").count(), 1, "{said}");
    assert!(said.contains("backend cpu"), "{said}");
    assert_eq!(stderr(&run(folder.path(), &TINY)), "", "no bar where nobody can see it");
}

#[test]
fn wishes_without_effect_are_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = run(folder.path(), &[&TINY[..], &["-o", "a.exr", "--exposure-ev", "-1"]].concat());
    assert_eq!(output.status.code(), Some(0));
    assert!(stderr(&output).contains("--exposure-ev has no effect"), "{}", stderr(&output));
}

#[test]
fn layers_that_are_not_there_are_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = run(folder.path(), &[&TINY[..], &["--aov", "normal", "--aov-space", "texture"]].concat());
    assert_eq!(output.status.code(), Some(0));
    assert!(stderr(&output).contains("no layer 'normal'"), "{}", stderr(&output));
    assert_eq!(names(folder.path()), ["cutis.png"]);
}

/// Two squares of 20 mm, one on forty times as many texels along u as the other: in an atlas that is made texels are nearly alike.
#[test]
fn texels_of_very_different_widths_are_told_and_mended() {
    let folder = tempfile::tempdir().expect("a folder");
    let mesh = "v 0 0 0\nv 20 0 0\nv 20 20 0\nv 0 20 0\nv 30 0 0\nv 50 0 0\nv 50 20 0\nv 30 20 0\n\
                vt 0.01 0.1\nvt 0.03 0.1\nvt 0.03 0.9\nvt 0.01 0.9\nvt 0.1 0.1\nvt 0.9 0.1\nvt 0.9 0.9\nvt 0.1 0.9\n\
                f 1/1 2/2 3/3\nf 1/1 3/3 4/4\nf 5/5 6/6 7/7\nf 5/5 7/7 8/8\n";
    std::fs::write(folder.path().join("squares.obj"), mesh).expect("written");
    let texels_mm = |atlas: &str| {
        let mut command = cutis(folder.path());
        // No atlas is kept in the user's cache.
        command.env("CUTIS_CACHE", "").args(["render", "squares.obj", "--backend", "cpu", "--size", "32x32"]);
        command.args(["--millimetres-per-unit", "1", "--irradiance-size", "64", "--ambient-samples", "1"]);
        let output =
            command.args(["--diffusion-report", "--json", "--atlas", atlas]).output().expect("starts");
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let json: serde_json::Value = serde_json::from_str(&stdout(&output)).expect("one JSON object");
        let texels = &json["diffusion_reports"][0]["texels"];
        ["narrowest_mm", "widest_mm", "even_mm"].map(|name| number(&texels[name]))
    };
    let [narrowest, widest, even] = texels_mm("own");
    // 0.8 of 64 texels for 20 mm, and 0.02 of them; squares of 0.656 of the texture for 800 mm².
    assert!((narrowest - 0.390_625).abs() < 1e-3 && (widest - 15.625).abs() < 0.01, "{narrowest} {widest}");
    assert!((even - (800.0f64 / 0.656).sqrt() / 64.0).abs() < 1e-3, "{even}");
    let [narrowest, widest, even] = texels_mm("new");
    // An atlas may be stretched by a quarter.
    assert!(widest < 1.27 * narrowest && (narrowest..=widest).contains(&even), "{narrowest} {widest} {even}");
}
