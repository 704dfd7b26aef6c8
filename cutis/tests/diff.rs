//! `cutis diff`: pictures that are written here, compared by the program.

mod common;

use common::{TINY, assert_refused, json_of, names, number, run, stderr, stdout};
use image::{ImageBuffer, Rgb, Rgb32FImage, RgbImage};
use std::path::Path;

fn write_grey(folder: &Path, name: &str, code: u8) {
    RgbImage::from_pixel(24, 16, Rgb([code; 3])).save(folder.join(name)).expect("written");
}

fn write_light(folder: &Path, name: &str, light: f32) {
    let image: Rgb32FImage = ImageBuffer::from_pixel(24, 16, Rgb([light, 2.0 * light, 0.5 * light]));
    image.save(folder.join(name)).expect("written");
}

fn json(folder: &Path, args: &[&str]) -> serde_json::Value {
    json_of(folder, "diff", args)
}

#[test]
fn identical_pictures_are_no_distance_apart() {
    let folder = tempfile::tempdir().expect("a folder");
    write_grey(folder.path(), "a.png", 100);
    write_light(folder.path(), "a.exr", 3.0);
    for name in ["a.png", "a.exr"] {
        let report = json(folder.path(), &[name, name]);
        for key in ["rmse", "relative_mse"] {
            assert_eq!(number(&report[key]), 0.0, "{name} {key}");
        }
        assert_eq!(number(&report["flip_ldr"]["mean"]), 0.0);
        assert_eq!(number(&report["bias_rgb"][1]), 0.0);
        assert!(report["map"].is_null());
    }
}

#[test]
fn white_and_black_have_the_error_that_the_authors_program_prints() {
    let folder = tempfile::tempdir().expect("a folder");
    write_grey(folder.path(), "white.png", 255);
    write_grey(folder.path(), "black.png", 0);
    let report = json(folder.path(), &["white.png", "black.png", "-o", "map.png"]);
    // validation/flip_reference.py prints 0.9673918 for white against black.
    assert!((number(&report["flip_ldr"]["mean"]) - 0.967_392).abs() < 5e-5, "{report}");
    assert_eq!((number(&report["rmse"]), number(&report["bias_rgb"][0])), (1.0, 1.0));
    assert!(report["flip_hdr"].is_null() && report["relative_bias_rgb"][0].is_null());
    assert_eq!((report["encoding"].as_str(), report["map"].as_str()), (Some("display"), Some("map.png")));
    let map = image::open(folder.path().join("map.png")).expect("a PNG").to_rgb8();
    assert_eq!((map.width(), map.height()), (24, 16));
    // Index 247 of 255 of the map of magma (0.967 of 255, rounded).
    assert!(map.pixels().all(|p| p.0[0] > 250 && p.0[1] > 230 && p.0[2] < 190), "{:?}", map.get_pixel(0, 0));
}

#[test]
fn linear_light_has_hdr_flip_and_a_relative_bias() {
    let folder = tempfile::tempdir().expect("a folder");
    for extension in ["exr", "hdr"] {
        let (a, b) = (format!("a.{extension}"), format!("b.{extension}"));
        write_light(folder.path(), &a, 5.0);
        write_light(folder.path(), &b, 4.0);
        let report = json(folder.path(), &[&a, &b]);
        assert_eq!(report["encoding"], "linear");
        assert_eq!(number(&report["relative_bias_rgb"][2]), 0.25, "5 and 4 are exact in either format");
        assert_eq!(number(&report["bias_rgb"][1]), 2.0);
        assert!(number(&report["flip_hdr"]["mean"]) > 0.0 && number(&report["flip_hdr"]["exposures"]) >= 2.0);
    }
}

#[test]
fn a_limit_decides_the_exit_code() {
    let folder = tempfile::tempdir().expect("a folder");
    write_grey(folder.path(), "a.png", 120);
    write_grey(folder.path(), "b.png", 100);
    let code =
        |limit: &str| run(folder.path(), &["diff", "a.png", "b.png", "--fail-above", limit]).status.code();
    assert_eq!((code("0"), code("0.001"), code("1")), (Some(1), Some(1), Some(0)));
    let output = run(folder.path(), &["diff", "a.png", "b.png"]);
    assert_eq!(output.status.code(), Some(0), "without a limit any difference will do");
    let said = stdout(&output);
    for word in ["RMSE", "relative MSE", "bias R, G, B", "FLIP (LDR)", "24 x 16 pixels, display"] {
        assert!(said.contains(word), "{word} is not in {said}");
    }
}

#[test]
fn layers_of_a_rendered_exr_can_be_compared() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, seed) in [("a.exr", "1"), ("b.exr", "2")] {
        let args = ["-o", name, "--seed", seed, "--aov", "specular", "--aov", "normal"];
        let output = run(folder.path(), &[&TINY[..], &args].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
    let of = |more: &[&str]| json(folder.path(), &[&["a.exr", "b.exr"], more].concat());
    let (picture, specular) = (of(&[]), of(&["--layer", "specular"]));
    assert_eq!(specular["layer"], "specular");
    assert!(number(&picture["rmse"]) > 0.0 && number(&picture["rmse"]) != number(&specular["rmse"]));
    let words = "a.exr: picture: has no layer 'depth'; it has normal, specular";
    assert_refused(folder.path(), &["diff", "a.exr", "b.exr", "--layer", "depth"], words);
}

#[test]
fn what_cannot_be_compared_is_refused_in_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    write_grey(folder.path(), "a.png", 1);
    write_light(folder.path(), "a.exr", 1.0);
    write_light(folder.path(), "nan.exr", f32::NAN);
    RgbImage::new(16, 24).save(folder.path().join("turned.png")).expect("written");
    std::fs::write(folder.path().join("text.png"), "not a picture").expect("written");
    let before = names(folder.path());
    let cases: &[(&[&str], &str)] = &[
        (&["a.png", "turned.png"], "a.png has 24 x 16 pixels and turned.png has 16 x 24"),
        (&["a.png", "a.exr"], "a.png holds a picture for a screen and a.exr linear light"),
        (&["nan.exr", "a.exr"], "nan.exr: picture: 384 of its pixels are not finite numbers"),
        (&["text.png", "a.png"], "text.png: picture: is none of PNG, JPEG, OpenEXR and Radiance HDR"),
        (&["nowhere.png", "a.png"], "nowhere.png: picture: cannot be opened"),
        (&["a.png", "."], "is a folder"),
        (&["a.png", "a.png", "--layer", "normal"], "is no EXR file"),
        (&["a.png", "a.png", "-o", "map.jpg"], "map.jpg: the map is written as .png"),
        (&["a.png", "a.png", "-o", "nowhere/map.png"], "there is no folder nowhere"),
        (&["a.png", "a.png", "--fail-above", "2"], "--fail-above must be 0 to 1, got 2"),
        (&["a.png", "a.png", "--fail-above", "NaN"], "--fail-above must be 0 to 1, got NaN"),
        (&["a.png", "a.png", "--pixels-per-degree", "0.5"], "--pixels-per-degree must be 1 to 1000, got 0.5"),
        (&["a.png"], "<REFERENCE>"),
    ];
    for (args, words) in cases {
        assert_refused(folder.path(), &[&["diff"], *args].concat(), words);
    }
    assert_eq!(names(folder.path()), before, "nothing was written");
}
