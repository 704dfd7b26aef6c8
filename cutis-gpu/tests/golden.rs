//! Small pictures as a person sees them: against those that are kept in `tests/golden`, and one backend against the other.
//!
//! The kept pictures prove only that nothing has changed. Where a change is meant, look at the new ones and keep them:
//! `CUTIS_RENEW_GOLDEN=1 cargo test -p cutis-gpu --test golden`, which writes them and fails, so that nobody does it by
//! accident. They are made by the processor, and the adapter is held against the same ones by a bound of its own. What was
//! drawn lies in `target/tmp` after a test.

mod common;

use common::{head_in_the_studio, patch, patch_under_a_spot, renderer, scanned_head};
use cutis_render::difference::{DEFAULT_PIXELS_PER_DEGREE, Pair, ldr_flip};
use cutis_render::film::{Film, check_output, write};
use cutis_render::{CpuRenderer, Frame, Renderer, Settings, Silent};
use cutis_scene::{Scene, read_picture};
use glam::Vec3;
use std::path::{Path, PathBuf};

/// Side of a picture, pixels.
const SIDE: u32 = 64;
/// Mean FLIP of a picture of the processor against the kept one: 0 where it was made; other processors may round sums
/// differently, so that some bytes are one off.
const SAME: f64 = 0.001;
/// Mean FLIP of the adapter against the processor for the scan: 0.028 on llvmpipe, with a third to spare.
const SCAN: f64 = 0.038;

fn settings() -> Settings {
    Settings { width: SIDE, height: SIDE, irradiance_size: 512, shadow_samples: 16, ..Settings::default() }
}

fn head() -> Scene {
    head_in_the_studio()
}

/// The ear from aside, made thinner: light comes through.
fn ear() -> Scene {
    let mut scene = head_in_the_studio();
    scene.environment = None;
    scene.camera.position_mm = Vec3::new(400.0, 0.0, 500.0);
    scene.camera.look_at_mm += Vec3::new(66.0, 13.0, -52.0);
    scene.camera.vertical_fov_rad = 0.13;
    scene.objects[0].material.thickness_scale = 0.4;
    scene
}

fn flat() -> Scene {
    patch_under_a_spot(patch(|u| 40.0 * u, |v| 40.0 * v))
}

/// A scene whose picture is kept.
struct Kept {
    name: &'static str,
    scene: fn() -> Scene,
    /// Mean FLIP of the adapter against it: what was measured on llvmpipe, with a third to spare; for the ear a seventh,
    /// so that a body as thick as it is (0.087) is told from one made thinner.
    twin: f64,
}

const KEPT: [Kept; 3] = [
    Kept { name: "head", scene: head, twin: 0.031 },
    Kept { name: "ear", scene: ear, twin: 0.078 },
    Kept { name: "patch", scene: flat, twin: 0.013 },
];

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/golden/{name}.png"))
}

fn keep(file: &Path, frame: &Frame) {
    let format = check_output(file, None).expect("is a PNG");
    write(file, format, frame, &Film::default()).expect("is written");
}

/// What the screen shows of a frame, by way of a file: rounded as the kept ones are.
fn on_screen(name: &str, frame: &Frame) -> Vec<Vec3> {
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.png"));
    keep(&file, frame);
    shown(&file)
}

/// What the screen shows of a picture in a file: display-linear light over black.
fn shown(file: &Path) -> Vec<Vec3> {
    let picture =
        read_picture(file, None).unwrap_or_else(|error| panic!("{error}; see the top of this test"));
    picture.pixels.iter().map(|p| p.truncate()).collect()
}

fn mean_flip(test: &[Vec3], reference: &[Vec3]) -> f64 {
    let pair = Pair::new(test, reference, SIDE as usize).expect("both have one size");
    ldr_flip(pair, DEFAULT_PIXELS_PER_DEGREE).mean
}

/// Keeps new pictures, if that is asked for.
fn renew(name: &str, frame: &Frame) -> bool {
    let is_wanted = std::env::var_os("CUTIS_RENEW_GOLDEN").is_some_and(|v| v == "1");
    if is_wanted {
        keep(&path(name), frame);
    }
    is_wanted
}

#[test]
fn the_processor_draws_what_is_kept() {
    let mut renewed = false;
    for Kept { name, scene, .. } in KEPT {
        let frame = CpuRenderer.render(&scene(), &settings(), &Silent).expect("draws");
        if renew(name, &frame) {
            renewed = true;
            continue;
        }
        let flip = mean_flip(&on_screen(&format!("cpu-{name}"), &frame), &shown(&path(name)));
        eprintln!("{name}: mean FLIP {flip:.5}");
        assert!(flip < SAME, "{name}: mean FLIP {flip} against the kept picture; see the top of this test");
    }
    assert!(
        !renewed,
        "the pictures are renewed: look at them, and run the test again without CUTIS_RENEW_GOLDEN"
    );
}

#[test]
fn the_adapter_draws_what_is_kept() {
    let Some(renderer) = renderer("the_adapter_draws_what_is_kept") else { return };
    for Kept { name, scene, twin } in KEPT {
        let frame = renderer.render(&scene(), &settings(), &Silent).expect("draws");
        let flip = mean_flip(&on_screen(&format!("gpu-{name}"), &frame), &shown(&path(name)));
        eprintln!("{name} on the adapter: mean FLIP {flip:.5}");
        assert!(flip < twin, "{name}: mean FLIP {flip} against the kept picture");
    }
}

#[test]
fn the_scanned_head_looks_alike_on_both() {
    let test = "the_scanned_head_looks_alike_on_both";
    let (Some(scene), Some(renderer)) = (scanned_head(test), renderer(test)) else { return };
    let cpu = CpuRenderer.render(&scene, &settings(), &Silent).expect("draws");
    let gpu = renderer.render(&scene, &settings(), &Silent).expect("draws");
    let flip = mean_flip(&on_screen("gpu-scan", &gpu), &on_screen("cpu-scan", &cpu));
    eprintln!("scan: mean FLIP {flip:.5}");
    assert!(flip < SCAN, "{flip}");
}

#[test]
fn kept_pictures_are_small() {
    for Kept { name, .. } in KEPT {
        let bytes = std::fs::metadata(path(name)).map_or(0, |file| file.len());
        assert!((500..12_000).contains(&bytes), "{name}: {bytes} bytes");
    }
}
