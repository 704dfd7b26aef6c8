//! The scanned head, and when the benches print the reports that are not criterion's.
#![allow(dead_code, reason = "every bench uses its own part")]

use cutis_scene::{Light, ReadOptions, Scene, read_scene};
use std::path::{Path, PathBuf};

/// Whether to print them: in a full bench run, and alone after `cargo bench … -- table` (a filter that no bench of
/// criterion's matches). Not in test runs, lists, or with any other filter or option.
pub fn reports_wanted() -> bool {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (harness, others): (Vec<&str>, Vec<&str>) =
        arguments.iter().map(String::as_str).partition(|&argument| argument == "--bench");
    !harness.is_empty() && (others.is_empty() || others == ["table"])
}

/// The scan under one point light without extent and the environment; none without the assets.
pub fn real_head() -> Option<Scene> {
    let given = std::env::var_os("CUTIS_ASSETS").filter(|value| !value.is_empty()).map(PathBuf::from);
    let usual = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/assets");
    let folder = given.unwrap_or_else(usual);
    if !folder.join("lee_perry_smith").is_dir() {
        eprintln!("no lee_perry_smith/ in CUTIS_ASSETS: nothing is measured");
        return None;
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/lee_perry_smith.toml");
    let options = ReadOptions { assets_folder: Some(folder), ..ReadOptions::default() };
    let mut scene = read_scene(&path, &options).expect("the scene of the scan is valid");
    scene.lights.truncate(1);
    if let Some(Light::Point { radius_mm, .. }) = scene.lights.first_mut() {
        *radius_mm = 0.0;
    }
    Some(scene)
}
