//! The suite that judges techniques by the truth that is kept, on its quickest scene.

mod common;

use common::{assert_refused, cutis, names, run, stderr, stdout};
use std::path::{Path, PathBuf};
use std::process::Output;

/// The truth of the project.
fn kept() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../truth")
}

/// A copy of what the sphere needs.
fn copied(folder: &Path) {
    for name in ["sphere.exr", "bounds.toml"] {
        std::fs::copy(kept().join(name), folder.join(name)).expect("the truth is kept");
    }
}

fn sphere(folder: &Path, args: &[&str]) -> Output {
    run(folder, &[&["validate", "--only", "sphere", "--truth", "."], args].concat())
}

#[test]
fn the_sphere_is_as_good_as_before_and_the_object_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    copied(folder.path());
    let output = sphere(folder.path(), &["--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let json: serde_json::Value =
        serde_json::from_str(&stdout(&output)).expect("one object and nothing else");
    assert_eq!((json["passed"].as_bool(), json["width"].as_u64()), (Some(true), Some(96)));
    let [scene] = json["scenes"].as_array().expect("a list").as_slice() else { panic!("one scene: {json}") };
    assert_eq!(scene["name"], "sphere");
    let entries = scene["entries"].as_array().expect("a list");
    let entry = |name| entries.iter().find(|entry| entry["name"] == name).expect("it is judged");
    let rmse = |name| entry(name)["errors"]["relative_rmse"].as_f64().expect("a number");
    assert!(entries.iter().all(|entry| entry["name"] != "truth"));
    assert!(rmse("texture-space") < rmse("texture-space/none"), "diffusion is better than none: {scene}");
    for entry in entries {
        assert!(entry["worse"].as_array().is_some_and(Vec::is_empty) && !entry["bound"].is_null(), "{entry}");
        assert!(entry["spread"]["relative_rmse"].as_f64().is_some_and(|s| s > 0.0 && s < 0.1), "{entry}");
    }
    assert_eq!(names(folder.path()), ["bounds.toml", "sphere.exr"], "nothing is written");
}

#[test]
fn a_bound_that_is_missed_ends_with_code_1() {
    let folder = tempfile::tempdir().expect("a folder");
    copied(folder.path());
    // The opaque surface lets nothing through; a bound of nearly nothing is missed by it.
    let bounds = "[sphere]\n\"texture-space/none\" = { relative_rmse = 0.01, bias_rgb = [0.9, 0.9, 0.9], flip_hdr = 1.0 }\n";
    std::fs::write(folder.path().join("bounds.toml"), bounds).expect("written");
    let few = ["--techniques", "texture-space,texture-space/none"];
    let output = sphere(folder.path(), &[&["--table"][..], &few].concat());
    let (said, told) = (stdout(&output), stderr(&output));
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(told.contains("worse than its bound: sphere, texture-space/none: relative RMSE"), "{told}");
    assert!(!told.contains("worse than its bound: sphere, texture-space:"), "no bound, no complaint: {told}");
    let lines: Vec<_> = said.lines().collect();
    assert!(lines[0].starts_with("| scene | technique | relative RMSE, %"), "{said}");
    assert!(lines[1].starts_with("|---|") && lines[2].starts_with("| sphere | texture-space |"), "{said}");
    assert!(lines[..4].iter().all(|line| line.matches('|').count() == 7), "{said}");
    assert_eq!((lines[4], lines[5]), ("", "| relative RMSE, % | sphere | ms |"), "{said}");
    assert!(lines[6..].iter().all(|line| line.matches('|').count() == 4), "{said}");
    assert_eq!(lines.len(), 9, "two techniques and two heads: {said}");
}

#[test]
fn a_damaged_truth_is_refused_in_words() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("sphere.exr");
    let whole = std::fs::read(kept().join("sphere.exr")).expect("the truth is kept");
    let refused = |words: &str| {
        let said = assert_refused(folder.path(), &["validate", "--only", "sphere", "--truth", "."], words);
        assert!(said.contains("sphere.exr"), "{said}");
    };
    refused("there is no such file");
    std::fs::write(&file, &whole[..whole.len() / 2]).expect("written");
    refused("sphere.exr: picture: ");
    std::fs::write(&file, "no picture at all").expect("written");
    refused("sphere.exr: picture: ");
    let picture =
        ["render", "--size", "16x16", "--irradiance-size", "64", "--triangles", "2000", "--map-size", "0"];
    let output = run(folder.path(), &[&picture[..], &["--aov", "specular", "-o", "sphere.exr"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    refused("has 16 x 16 pixels, a truth has 96 x 96");
    std::fs::write(&file, &whole).expect("written");
    std::fs::write(folder.path().join("bounds.toml"), "[sphere]\nx = 5").expect("written");
    let said = stderr(&sphere(folder.path(), &[]));
    assert!(said.starts_with("error: ./bounds.toml: "), "{said}");
}

#[test]
fn words_that_make_no_sense_are_refused_before_the_work() {
    let folder = tempfile::tempdir().expect("a folder");
    let cases: &[(&[&str], &str)] = &[
        (
            &["--only", "cube"],
            "--only: there is no scene 'cube'; there are shadow-edge, sphere, thin-slab, gap",
        ),
        (
            &["--techniques", "truth"],
            "--techniques: there is no entry 'truth'; there are wrap, depth-absorption",
        ),
        (&["--truth", "nowhere"], "nowhere: there is no such folder of truth"),
        (&["--truth", ".", "--update", "--samples", "15"], "--samples must be 16 to 1048576, got 15"),
        (&["--truth", ".", "--update", "--samples", "2000000"], "samples per pixel must be"),
        (&["--samples", "64"], "--update"),
        (&["--json", "--table"], "cannot be used with"),
    ];
    for (args, words) in cases {
        assert_refused(folder.path(), &[&["validate"], *args].concat(), words);
    }
    assert!(names(folder.path()).is_empty(), "nothing was written");
}

#[test]
fn scenes_that_need_assets_are_skipped_in_words() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir(folder.path().join("empty")).expect("made");
    let mut command = cutis(folder.path());
    command.env("CUTIS_ASSETS", "empty").args(["validate", "--only", "ear-backlit", "--truth", "."]);
    let output = command.output().expect("starts");
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(said.starts_with("skipped: ear-backlit: assets:lee_perry_smith/LeePerrySmith.obj: "), "{said}");
}

#[test]
fn what_is_kept_is_small_and_says_how_it_was_made() {
    for entry in std::fs::read_dir(kept()).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|extension| extension != "exr") {
            continue;
        }
        let bytes = std::fs::read(&path).expect("there");
        assert!(bytes.len() < 150_000, "{}: {} bytes", path.display(), bytes.len());
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let header = String::from_utf8_lossy(&bytes[..4096]).into_owned();
        assert!(header.contains("cutis validate --update --samples "), "{name} does not say how");
        assert!(header.contains(&format!("--only {name}")), "{name} is another one's");
    }
}
