//! Renders real files: the scanned head by the project's own scene file, a skinned hand, an open glTF mesh.
//!
//! They lie in the folder `CUTIS_ASSETS`; without it a test says that it is skipped, or fails if
//! `CUTIS_REQUIRE_ASSETS=1`.

mod common;

use common::{TINY, cutis, stderr};
use std::path::{Path, PathBuf};

/// Arguments at the end of [`TINY`] that are for the built-in head only.
const HEAD_FLAGS: usize = 4;

/// The folder of assets, or `None` with a line on stderr.
fn assets(test: &str) -> Option<PathBuf> {
    let given = std::env::var_os("CUTIS_ASSETS").map(PathBuf::from);
    let usual = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/assets");
    let folder = given.unwrap_or_else(usual);
    if folder.is_dir() {
        return Some(folder);
    }
    let why = format!("the assets folder {} does not exist; set CUTIS_ASSETS", folder.display());
    assert!(std::env::var_os("CUTIS_REQUIRE_ASSETS").is_none_or(|v| v != "1"), "{test}: {why}");
    eprintln!("SKIPPED: {test}: {why}");
    None
}

/// Renders a file and returns its picture: rgb and alpha of every pixel.
fn picture(assets: &Path, file: &Path) -> Vec<[u8; 4]> {
    let folder = tempfile::tempdir().expect("a folder");
    let mut command = cutis(folder.path());
    let output = command
        .env("CUTIS_ASSETS", assets)
        .args(&TINY[..TINY.len() - HEAD_FLAGS])
        .arg(file)
        .output()
        .expect("starts");
    assert_eq!(output.status.code(), Some(0), "{}: {}", file.display(), stderr(&output));
    let image = image::open(folder.path().join("cutis.png")).expect("a picture").to_rgba8();
    image.pixels().map(|pixel| pixel.0).collect()
}

/// Pixels that are neither transparent nor dark.
fn lit(picture: &[[u8; 4]]) -> usize {
    picture.iter().filter(|[r, g, b, a]| *a == 255 && r.max(g).max(b) > &60).count()
}

#[test]
fn the_scanned_head_is_red_blooded() {
    let Some(assets) = assets("the_scanned_head_is_red_blooded") else { return };
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/lee_perry_smith.toml");
    let picture = picture(&assets, &scene);
    assert!(lit(&picture) > picture.len() / 4, "{} of {} pixels are lit", lit(&picture), picture.len());
    let head = picture.iter().filter(|[r, g, b, _]| r.max(g).max(b) > &60);
    let sum = |c: usize| head.clone().map(|pixel| u32::from(pixel[c])).sum::<u32>();
    assert!(sum(0) > sum(1) && sum(1) > sum(2), "skin is redder than green, greener than blue");
}

#[test]
fn the_hand_and_the_open_mesh_are_no_black_pictures() {
    let Some(assets) = assets("the_hand_and_the_open_mesh_are_no_black_pictures") else { return };
    for file in [
        "webxr_hand/left.glb",
        "webxr_hand/right.glb",
        "gltf_samples/Suzanne/Suzanne.gltf",
        "lee_perry_smith/LeePerrySmith.glb",
    ] {
        let picture = picture(&assets, &assets.join(file));
        assert!(
            lit(&picture) > picture.len() / 20,
            "{file}: {} of {} pixels are lit",
            lit(&picture),
            picture.len()
        );
    }
}
