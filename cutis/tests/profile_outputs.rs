//! `cutis profile` from outside: plots and exports.

mod common;

use common::{assert_refused, json_of, names, number, run, stderr, stdout};
use serde_json::Value;
use std::fs;

const SHEET: [&str; 2] = ["--layer", "mu_a=0.05,mu_s=4,n=1.4,d=1.5"];

#[test]
fn plots_are_pictures_with_lines_and_words() {
    let folder = tempfile::tempdir().expect("a folder");
    let words = ["profile", "skin1", "--gaussians", "2", "--plot"];
    for name in ["a.svg", "a.png"] {
        let output = run(folder.path(), &[&words[..], &[name]].concat());
        assert!(output.status.success(), "{}", stderr(&output));
    }
    let svg = fs::read_to_string(folder.path().join("a.svg")).expect("written");
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
    for told in ["skin1: dipole", "r R(r) [1/mm]", "R(r) [1/mm²]", "k [1/mm]", "Jensen"] {
        assert!(svg.contains(told), "{told}");
    }
    assert!(svg.matches("<polyline").count() > 20);
    let picture = image::open(folder.path().join("a.png")).expect("a PNG").to_rgb8();
    assert_eq!(picture.dimensions(), (2400, 1800));
    let like = |wanted: [u8; 3]| {
        let near = |p: &&image::Rgb<u8>| p.0.iter().zip(wanted).all(|(a, b)| a.abs_diff(b) < 40);
        picture.pixels().filter(near).count()
    };
    // Each channel's lines are there, and words in dark ink: in the title's strip nothing else is dark.
    for pen in [[196, 30, 30], [20, 130, 50], [30, 70, 190]] {
        assert!(like(pen) > 1000, "{pen:?}");
    }
    let title = image::imageops::crop_imm(&picture, 0, 0, 2400, 60).to_image();
    assert!(title.pixels().filter(|p| p.0[0] < 100).count() > 500, "the title has ink");
    assert_eq!(names(folder.path()), ["a.png", "a.svg"]);
}

#[test]
fn every_export_is_what_its_name_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut words = vec!["profile", "skin1", "--gaussians", "3"];
    for name in ["k.json", "k.csv", "k.wgsl", "k.glsl", "k.hlsl", "m.mtlx", "m.gltf"] {
        words.extend(["--export", name]);
    }
    let output = run(folder.path(), &words);
    assert!(output.status.success(), "{}", stderr(&output));
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).expect("written");
    let kernel: Value = serde_json::from_str(&read("k.json")).expect("JSON");
    assert_eq!(kernel["weights"][0].as_array().map(Vec::len), Some(3));
    assert!(read("k.csv").contains("variance_mm2,weight_red,weight_green,weight_blue"));
    assert!(
        read("k.wgsl").contains("array<vec3<f32>, 3>") && read("k.glsl").contains("vec3 CUTIS_WEIGHTS[3]")
    );
    assert!(read("k.hlsl").contains("static const float3 CUTIS_WEIGHTS[3]"));
    assert!(read("m.mtlx").contains("open_pbr_surface") && read("m.mtlx").contains("lin_rec709"));
    let gltf: Value = serde_json::from_str(&read("m.gltf")).expect("JSON");
    assert_eq!(gltf["asset"]["version"], "2.0");
    assert!(!read("m.gltf").contains("scatter"), "drafts stay behind their flag");
    assert!(stdout(&output).contains("loss"), "{}", stdout(&output));
}

#[test]
fn formats_can_be_named_and_translations_are_reported() {
    let folder = tempfile::tempdir().expect("a folder");
    let report = json_of(
        folder.path(),
        "profile",
        &[
            "marble",
            "--gaussians",
            "3",
            "--drafts=scatter",
            "--export",
            "u.json",
            "--export",
            "d",
            "--export-as",
            "unreal",
            "--export-as",
            "gltf",
        ],
    );
    let translations = report["translations"].as_array().expect("a list");
    assert_eq!((&translations[0]["target"], &translations[1]["target"]), (&"unreal".into(), &"gltf".into()));
    for translation in translations {
        for c in 0..3 {
            let loss = &translation["loss"][c];
            let wide = number(&loss["wide"]["relative_rms_power_error"]);
            assert!((0.001..0.5).contains(&wide), "{loss}");
            assert!(number(&loss["relative_change_of_total"]).abs() < 1e-9);
        }
        let fields = translation["fields"].as_array().expect("a list");
        assert!(
            fields.iter().all(|f| f["unit"].is_string() && f["meaning"].is_string() && !f["value"].is_null())
        );
    }
    let draft = fs::read_to_string(folder.path().join("d")).expect("written");
    assert!(draft.contains("KHR_materials_scatter"), "{draft}");
}

#[test]
fn outputs_are_written_all_or_none() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::create_dir(folder.path().join("sub")).expect("made");
    for [one, other] in [["k.json", "./k.json"], ["k.json", "sub/../k.json"], ["sub/k.csv", "sub/k.csv"]] {
        let said =
            assert_refused(folder.path(), &["profile", "skin1", "--export", one, "--export", other], one);
        assert!(said.contains(other) && said.contains("are one file"), "{said}");
    }
    // The plot is an output like any other.
    let plot = ["profile", "skin1", "--plot", "a.svg", "--export", "a.svg", "--export-as", "json"];
    assert!(stderr(&run(folder.path(), &plot)).contains("are one file"));
    assert_eq!(names(folder.path()), ["sub"]);
    // A name too long for the file system stands for any trouble with the second file.
    let name = "x".repeat(300) + ".csv";
    let output = run(folder.path(), &["profile", "skin1", "--export", "k.json", "--export", &name]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert_eq!(names(folder.path()), ["sub"], "neither is there");
}

#[test]
fn transmittance_is_drawn_printed_and_exported() {
    let folder = tempfile::tempdir().expect("a folder");
    let files = ["--plot", "a.svg", "--export", "a.csv", "--export-as", "radial-csv", "--gaussians", "2"];
    let output = run(folder.path(), &[&["profile"], &SHEET[..], &files].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stdout(&output).contains("T_d 0."), "{}", stdout(&output));
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).expect("written");
    assert!(read("a.svg").contains("all channels, transmitted"));
    let csv = read("a.csv");
    assert_eq!(csv.lines().next(), Some("r_mm,reflectance_per_mm2,transmittance_per_mm2"));
    assert_eq!(csv.lines().count(), 65);
    let files = ["--export", "b.csv", "--export-as", "radial-csv", "--gaussians", "2"];
    assert!(run(folder.path(), &[&["profile", "skin1"], &files[..]].concat()).status.success());
    let header = "r_mm,reflectance_r_per_mm2,reflectance_g_per_mm2,reflectance_b_per_mm2";
    assert_eq!(read("b.csv").lines().next(), Some(header));
}

#[test]
fn the_ends_of_what_a_medium_may_be_are_drawn_and_translated() {
    let folder = tempfile::tempdir().expect("a folder");
    for words in ["mu_a=1e9,mu_s=1e-9", "mu_a=0,mu_s=1e9", "mu_a=1e-12,mu_s=1e-9,n=3"] {
        let files = ["--gaussians", "2", "--plot", "a.svg", "--export", "a.mtlx", "--export", "a.gltf"];
        let report = json_of(folder.path(), "profile", &[&["--layer", words], &files[..]].concat());
        assert!(number(&report["fit"]["relative_rms_power_error"]) < 1.0, "{words}");
        assert!(report["translations"][0]["loss"][0]["wide"]["relative_rms_power_error"].is_number());
    }
}
