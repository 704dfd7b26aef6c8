//! The words of the command line: help, completions, presets, and what is said to words that make no sense.

mod common;

use common::{assert_refused, cutis, names, run, stderr, stdout};
use std::process::Stdio;

#[test]
fn help_tells_units_ranges_and_defaults() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = run(folder.path(), &["render", "--help"]);
    assert!(output.status.success());
    let help = stdout(&output).split_whitespace().collect::<Vec<_>>().join(" ");
    let told = [
        "[pixels, 1x1 to 16384x16384, default 1024x1024]",
        "[EV (stops), -32 to 32, default 0]",
        "[mm, above 0",
        "[texels, 16 to 16384, default 2048]",
        "[1 to 1048576, default 4]",
        "[fraction, 0 to 1, default 0.04]",
        "[possible values: none, separable, heat-flow]",
        "[cosine, 0 to 1, default 0.2]",
        "[mm, 0 to 1000, default 0.5]",
        "[factor, 0 to 64, default 1]",
        "[1 to 4096, default 32]",
        "Technique image-space (Mertens et al. 2003):",
    ];
    for words in told {
        assert!(help.contains(words), "{words} is not in {help}");
    }
}

#[test]
fn no_words_are_answered_with_help_and_code_2() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = run(folder.path(), &[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("Usage: cutis") && output.stdout.is_empty());
    assert!(run(folder.path(), &["--version"]).status.success());
}

#[test]
fn nonsense_ends_with_code_2_and_one_clear_line() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("bad.toml"), "mesh = 5").expect("written");
    std::fs::write(folder.path().join("map.png"), "not a picture").expect("written");
    let cases: &[(&[&str], &str)] = &[
        (&["--technique", "raytrace"], "texture-space"),
        (&["--diffusion", "magic"], "separable"),
        (&["--size", "0x0"], "width must be 1 to 16384 pixels, got 0"),
        (&["--size", "70000x70000"], "width must be 1 to 16384 pixels, got 70000"),
        (&["--size", "big"], "WIDTHxHEIGHT"),
        (&["--samples", "0"], "samples per pixel must be 1 to 1048576"),
        (&["--samples", "-3"], "-3"),
        (&["--exposure-ev", "NaN"], "exposure must be -32 to 32 EV, got NaN"),
        (&["--exposure-ev", "-33"], "exposure must be -32 to 32 EV, got -33"),
        (&["--bloom", "NaN"], "bloom must be 0 to 1, got NaN"),
        (&["--tone-mapper", "filmic"], "none, reinhard, aces, agx, neutral"),
        (&["--aov", "depth"], "irradiance"),
        (
            &["--backend", "gpu", "--technique", "truth"],
            "the technique truth is not drawn on graphics adapters",
        ),
        (&["--threads", "0"], "--threads must be 1 to 1024, got 0"),
        (&["--triangles", "7"], "--triangles must be 1000 to 4000000, got 7"),
        (&["--millimetres-per-unit", "0"], "above 0 mm, got 0"),
        (&["--millimetres-per-unit", "NaN"], "above 0 mm, got NaN"),
        (&["--gaussians", "17"], "gaussians must be 1 to 16"),
        (&["--irradiance-size", "8"], "16 to 16384 texels"),
        (&["nowhere.glb"], "nowhere.glb: there is no such file"),
        (&["--albedo", "nowhere.png"], "nowhere.png: there is no such file"),
        (&["bad.toml"], "bad.toml"),
        (&["--albedo", "map.png", "--triangles", "1000"], "map.png"),
        (&["-o", "nowhere/a.png"], "there is no folder nowhere"),
        (&["-o", "a.tga"], ".png (8 or 16 bits) and .exr"),
        (&["-o", "a"], "without extension"),
        (&["-o", "a.png", "--bits", "32"], "8 or 16 bits per channel, not 32"),
        (&["--atlas", "new"], "--atlas new is for mesh files"),
        (&["--atlas", "old"], "own, new"),
        (&["--no-such-flag"], "--no-such-flag"),
    ];
    for (args, words) in cases {
        assert_refused(folder.path(), &[&["render"], *args].concat(), words);
    }
    assert_eq!(names(folder.path()), ["bad.toml", "map.png"], "nothing was written");
}

#[test]
fn presets_hold_the_measured_media_and_the_skin() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = run(folder.path(), &["presets", "--json"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let json: serde_json::Value = serde_json::from_str(&stdout(&output)).expect("one JSON object");
    let materials = json["materials"].as_array().expect("a list");
    let measured: Vec<_> = materials.iter().filter(|m| m["measured"] == true).collect();
    assert_eq!(measured.len(), 12);
    for material in measured {
        assert!(material["sigma_a_per_mm"][2].as_f64().expect("a number") >= 0.0);
        assert!(material["sigma_s_reduced_per_mm"][2].as_f64().expect("a number") > 0.0);
    }
    let skin = materials.iter().find(|m| m["name"] == "three-layer-skin").expect("it is there");
    assert_eq!(skin["kernel"]["variances_mm2"].as_array().expect("a list").len(), 6);
    for list in ["heads", "environments", "techniques", "papers", "tone_mappers", "layers"] {
        assert!(!json[list].as_array().expect("a list").is_empty(), "{list}");
    }
    let table = stdout(&run(folder.path(), &["presets"]));
    assert!(table.contains("three-layer-skin") && table.contains("1/mm"), "{table}");
}

#[test]
fn completions_are_printed_for_every_shell() {
    let folder = tempfile::tempdir().expect("a folder");
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let output = run(folder.path(), &["completions", shell]);
        assert!(output.status.success(), "{shell}");
        let script = stdout(&output);
        assert!(script.contains("cutis") && script.contains("tone-mapper"), "{shell}");
        assert!(script.contains("absorption-ramp") && script.contains("as-in"), "{shell}");
    }
}

#[test]
fn a_pipe_that_closes_early_is_no_error() {
    let folder = tempfile::tempdir().expect("a folder");
    for args in [&["presets", "--json"][..], &["completions", "zsh"], &["render", "--help"]] {
        let mut child = cutis(folder.path())
            .args(args)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        drop(child.stdout.take());
        let output = child.wait_with_output().expect("it ends");
        assert!(output.status.success(), "{args:?}: {}", stderr(&output));
        assert!(output.stderr.is_empty(), "{args:?}: {}", stderr(&output));
    }
}
