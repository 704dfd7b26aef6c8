//! `cutis compare`: small pictures of the built-in head, and the page they end up on.

mod common;

use common::{assert_refused, names, run, stderr, stdout};
use std::path::Path;
use std::process::Output;

/// As small as a comparison can be.
const SMALL: [&str; 7] = ["compare", "--size", "96x96", "--irradiance-size", "256", "--samples", "1"];
/// Two that are there today.
const BOTH: [&str; 2] = ["--techniques", "texture-space,texture-space/none"];

fn compare(folder: &Path, args: &[&str]) -> Output {
    let output = run(folder, &[&SMALL[..], args].concat());
    assert_eq!(output.status.code(), Some(0), "{args:?}: {}", stderr(&output));
    output
}

/// The built-in head with and without diffusion; everything that can be asked of one run.
#[test]
fn page_object_and_table_say_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let wanted = ["--reference", "texture-space", "-o", "page.html", "--csv", "table.csv", "--json"];
    let output = compare(folder.path(), &[&BOTH[..], &wanted].concat());
    assert_eq!(names(folder.path()), ["page.html", "table.csv"]);
    let json: serde_json::Value =
        serde_json::from_str(&stdout(&output)).expect("one object and nothing else");
    let page = std::fs::read_to_string(folder.path().join("page.html")).expect("written");
    let table = std::fs::read_to_string(folder.path().join("table.csv")).expect("written");
    the_object_is_complete(&json);
    the_page_is_complete(&page);
    the_table_is_that_of_the_object(&table, &json);
}

fn the_object_is_complete(json: &serde_json::Value) {
    assert_eq!((json["scene"].as_str(), json["width"].as_u64()), (Some("built-in head"), Some(96)));
    assert_eq!(json["reference"], "texture-space");
    assert!(json["reference_noise"].is_null(), "this technique does not know its noise");
    let [reference, opaque] = json["techniques"].as_array().expect("a list").as_slice() else {
        panic!("two techniques: {json}");
    };
    assert!(reference["is_reference"] == true && reference["parts"].as_array().is_some_and(Vec::is_empty));
    assert_eq!(
        (opaque["name"].as_str(), opaque["diffusion"].as_str()),
        (Some("texture-space/none"), Some("none"))
    );
    let parts = opaque["parts"].as_array().expect("a list");
    assert_eq!(
        parts.iter().map(|p| p["part"].as_str()).collect::<Vec<_>>(),
        [Some("picture"), Some("diffuse")]
    );
    let number = |value: &serde_json::Value| value.as_f64().expect("a number");
    for part in parts {
        assert!(number(&part["rmse"]) > 0.0);
        for flip in ["flip_ldr", "flip_hdr"] {
            assert!((0.0..1.0).contains(&number(&part[flip]["mean"])) && number(&part[flip]["max"]) > 0.0);
        }
    }
    // The surface reflects the same in both: the difference is that of the diffuse part, up to rounding.
    assert!((number(&parts[0]["rmse"]) / number(&parts[1]["rmse"]) - 1.0).abs() < 1e-4, "{parts:?}");
    for technique in [reference, opaque] {
        let passes = technique["passes"].as_array().expect("a list");
        let total: f64 = passes.iter().map(|pass| number(&pass["milliseconds"])).sum();
        assert!(total > 0.0 && total <= number(&technique["milliseconds"]), "{technique}");
        assert!(technique["peak_memory_mib"].as_f64().is_none_or(|mib| mib > 1.0));
    }
}

fn the_page_is_complete(page: &str) {
    assert!(!page.contains("http:") && !page.contains("https:"), "nothing is loaded from elsewhere");
    assert!(!page.contains("{{") && page.contains("default-src 'none'"));
    // Picture, FLIP, luminance of two parts, and two pictures of the reference.
    assert_eq!(page.matches("src=\"data:image/png;base64,iVBORw0KGgo").count(), 2 + 6);
    assert_eq!(page.matches("<svg").count(), 1, "the profile of the one material");
    let words = [
        "<h1>built-in head</h1>",
        "texture-space/none",
        "FLIP HDR",
        "Relative MSE",
        "W/(m² sr)",
        "id=\"wipe\"",
        "Passes: ",
        "irradiance",
        "class=\"scale\"",
        "96 × 96 pixels",
        "Diffusion profile",
    ];
    for words in words {
        assert!(page.contains(words), "{words} is not on the page");
    }
}

fn the_table_is_that_of_the_object(table: &str, json: &serde_json::Value) {
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 1 + 3, "head, reference, two parts: {table}");
    assert!(rows.iter().all(|row| row.len() == rows[0].len()), "{table}");
    let column = |name: &str| rows[0].iter().position(|head| *head == name).expect("a column");
    let of_table = |row: usize, name: &str| rows[row][column(name)].parse::<f64>().expect("a number");
    assert_eq!((rows[1][column("is_reference")], rows[1][column("rmse_w_per_m2_sr")]), ("true", ""));
    for (row, part) in [(2, 0), (3, 1)] {
        let expected = &json["techniques"][1]["parts"][part];
        let same = |name: &str, value: &serde_json::Value| {
            let [table, object] = [of_table(row, name), value.as_f64().expect("a number")];
            // What reads the object may miss the last digit.
            assert!((table - object).abs() <= 2.0 * f64::EPSILON * table.abs(), "{name}: {table}, {object}");
        };
        same("rmse_w_per_m2_sr", &expected["rmse"]);
        same("flip_hdr_mean", &expected["flip_hdr"]["mean"]);
        same("relative_bias_b", &expected["relative_bias_rgb"][2]);
    }
}

#[test]
fn identical_entries_are_one_and_the_reference_is_added() {
    let folder = tempfile::tempdir().expect("a folder");
    let techniques = ["--techniques", "texture-space/none, texture-space/none"];
    let output = compare(folder.path(), &[&techniques[..], &["--reference", "texture-space"]].concat());
    let said = stdout(&output);
    let lines: Vec<_> = said.lines().collect();
    assert_eq!(lines[0], "report.html");
    assert!(lines[2].starts_with("texture-space/none") && lines[2].contains("picture"), "{said}");
    assert!(lines[3].starts_with("texture-space/none") && lines[3].contains("diffuse part"), "{said}");
    assert!(lines[4].starts_with("texture-space ") && lines[4].contains("reference"), "{said}");
    assert_eq!((lines.len(), stderr(&output).as_str()), (5, ""), "{said}");
}

#[test]
fn words_that_make_no_sense_are_refused_before_the_work() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("bad.toml"), "mesh = 5").expect("written");
    let cases: &[(&[&str], &str)] = &[
        (&["--techniques", "raytrace"], "--techniques: there is no technique 'raytrace'; there are"),
        (&["--techniques", "texture-space/magic"], "there is no diffusion 'magic'; there are none"),
        (&["--techniques", "texture-space,"], "there is no technique ''"),
        (&["--techniques", "wrap:wrap=2"], "--techniques: wrap:wrap=2: --wrap: wrap must be 0 to 1, got 2"),
        (&["--techniques", "wrap:blur-passes=2"], "--blur-passes has no effect: the technique is wrap"),
        (&["--wrap", "2"], "--wrap: wrap must be 0 to 1, got 2"),
        (&["--backend", "abacus"], "auto, cpu, gpu"),
        (&["--reference", "magic"], "--reference: there is no technique 'magic'"),
        (&["-o", "page.toml"], "page.toml: this file is written as .html"),
        (&["-o", "nowhere/page.html"], "there is no folder nowhere"),
        (&["--csv", "table.html"], "table.html: this file is written as .csv"),
        (&["--size", "0x9"], "width must be 1 to 16384 pixels"),
        (&["--samples", "0"], "samples per pixel must be"),
        (&["--reference-samples", "0"], "samples per pixel must be"),
        (&["--threads", "0"], "--threads must be 1 to 1024"),
        (&["--pixels-per-degree", "NaN"], "--pixels-per-degree must be 1 to 1000"),
        (&["nowhere.glb"], "nowhere.glb: there is no such file"),
        (&["bad.toml"], "bad.toml"),
    ];
    for (args, words) in cases {
        assert_refused(folder.path(), &[&["compare"], *args].concat(), words);
    }
    assert_eq!(names(folder.path()), ["bad.toml"], "nothing was written");
}

/// A small head, for comparisons that need no detail.
const HEAD: &str = "[mesh]\nbuiltin = \"head\"\ntriangles = 2000\nmap_size = 64\n";

#[test]
fn every_technique_is_on_the_page_and_entries_have_numbers_of_their_own() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("head.toml"), HEAD).expect("written");
    let techniques = "wrap:scatter-colour=0.5,0,0,depth-absorption,texture-blur,texture-space,image-space:profile-samples=2";
    let wanted = ["compare", "head.toml", "--techniques", techniques, "--reference", "image-space", "--json"];
    let small = ["--size", "32x32", "--irradiance-size", "64", "--samples", "1"];
    let flags = ["--profile-samples", "4", "--blur-passes", "2"];
    let output = run(folder.path(), &[&wanted[..], &small, &flags].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let json: serde_json::Value = serde_json::from_str(&stdout(&output)).expect("one object");
    let rows = json["techniques"].as_array().expect("a list");
    let names: Vec<_> = rows.iter().map(|row| row["name"].as_str().expect("a name")).collect();
    let expected = [
        "wrap:scatter-colour=0.5,0,0",
        "depth-absorption",
        "texture-blur",
        "texture-space",
        "image-space:profile-samples=2",
        "image-space",
    ];
    assert_eq!(names, expected);
    assert_eq!(rows[0]["technique_settings"]["scatter_colour_rgb"][0], 0.5);
    assert_eq!(rows[2]["technique_settings"]["passes"], 2, "the flag is for all");
    assert!(rows[3]["technique_settings"].is_null());
    assert_eq!(rows[4]["technique_settings"]["samples"], 2, "an entry's own number wins");
    assert_eq!(rows[5]["technique_settings"]["samples"], 4);
    for row in &rows[..5] {
        let rmse = row["parts"][0]["rmse"].as_f64().expect("a number");
        assert!(rmse > 0.0 && rmse.is_finite(), "{row}");
        assert_eq!(row["backend"], "cpu");
    }
    let page = std::fs::read_to_string(folder.path().join("report.html")).expect("written");
    for name in expected {
        assert!(page.contains(&format!("<h2>{name}")), "{name} has no card");
    }
}

#[test]
fn an_adapter_draws_what_it_knows_and_the_processor_the_rest() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("head.toml"), HEAD).expect("written");
    let wanted =
        ["compare", "head.toml", "--techniques", "texture-space,truth", "--backend", "gpu", "--json"];
    let small = ["--size", "16x16", "--irradiance-size", "64", "--samples", "1", "--close-holes"];
    let output = run(folder.path(), &[&wanted[..], &small, &["--reference-samples", "2"]].concat());
    if stderr(&output).contains("there is no graphics adapter") {
        let required = std::env::var_os("CUTIS_REQUIRE_GPU").is_some_and(|v| v == "1");
        assert!(!required, "{}", stderr(&output));
        eprintln!("SKIPPED: an_adapter_draws_what_it_knows_and_the_processor_the_rest: no adapter");
        return;
    }
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let json: serde_json::Value = serde_json::from_str(&stdout(&output)).expect("one object");
    let backends = [0, 1].map(|i| json["techniques"][i]["backend"].as_str().expect("a name").to_owned());
    assert_eq!(backends, ["gpu", "cpu"]);
    let words = "backend gpu: the processor, because the technique truth is not drawn on graphics adapters";
    assert!(stderr(&output).contains(words), "{}", stderr(&output));
    assert!(json["techniques"][0]["adapter"].as_str().is_some_and(|name| !name.is_empty()));
}
