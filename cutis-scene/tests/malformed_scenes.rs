//! Spoiled scene files, files that are not there, and options out of their range.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::refusal::refuse;
use common::{SQUARE_OBJ, small_jpeg, small_png, write};
use cutis_scene::{ColourSpace, ReadOptions, read_image, read_scene};
use std::path::PathBuf;

/// A scene file with a valid mesh and something after it.
fn scene(rest: &str) -> String {
    format!("[mesh]\npath = \"square.obj\"\nmillimetres_per_unit = 1.0\n{rest}\n")
}

/// A scene file with one light of a kind that has these lines.
fn light(lines: &str) -> String {
    scene(&format!("[[light]]\n{lines}"))
}

/// The coefficients of a layer.
const LAYER: &str =
    "sigma_a_per_mm = [0.1, 0.2, 0.4], sigma_s_reduced_per_mm = [2, 2, 2], refractive_index = 1.4";

#[test]
fn scene_files() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "square.obj", SQUARE_OBJ);
    write(folder.path(), "cut.jpg", &small_jpeg()[..300]);
    write(folder.path().parent().unwrap(), "cutis-outside.png", small_png());
    std::fs::create_dir(folder.path().join("folder")).unwrap();
    let outside = folder.path().join("link.png");
    #[cfg(unix)]
    std::os::unix::fs::symlink("/etc/hostname", &outside).unwrap();
    let slide =
        |more: &str| format!("kind = \"projector\"\nposition_mm = [0, 0, 9]\ndirection = [0, 0, -1]\n{more}");
    let two_environments = "kind = \"environment\"\n[[light]]\nkind = \"environment\"";
    let many_lights = "[[light]]\nkind = \"environment\"\n".repeat(1001);
    let cases: Vec<(&str, String, &str)> = vec![
        ("empty", String::new(), "key `mesh`: is missing"),
        ("syntax", scene("[camera\n"), "line 4"),
        ("table", "mesh = 5".to_owned(), "must be a table, found integer"),
        ("no-path", "[mesh]\nflip_v = true".to_owned(), "key `mesh.path`: is missing"),
        (
            "no-file",
            "[mesh]\npath = \"none.obj\"".to_owned(),
            "line 2, key `mesh.path`: `none.obj` cannot be opened",
        ),
        ("folder", "[mesh]\npath = \"folder\"".to_owned(), "not a regular file"),
        ("climb", "[mesh]\npath = \"../../x\"".to_owned(), "leads out of"),
        ("absolute", "[mesh]\npath = \"/etc/passwd\"".to_owned(), "leads out of"),
        ("empty-path", "[mesh]\npath = \"\"".to_owned(), "path is empty"),
        ("zero-byte", "[mesh]\npath = \"a\\u0000b\"".to_owned(), "zero byte"),
        ("assets-climb", "[mesh]\npath = \"assets:../x\"".to_owned(), "assets"),
        ("recursion", "[mesh]\npath = \"recursion.toml\"".to_owned(), "`.toml` is not known"),
        ("builtin", "[mesh]\nbuiltin = \"heart\"".to_owned(), "`heart` is not known"),
        ("both", scene("builtin = \"head\""), "only one can be the mesh"),
        ("unit", "[mesh]\npath = \"square.obj\"\nmillimetres_per_unit = -1".to_owned(), "must be above 0"),
        (
            "zero-unit",
            "[mesh]\npath = \"square.obj\"\nmillimetres_per_unit = 0".to_owned(),
            "must be above 0",
        ),
        ("nan-unit", "[mesh]\npath = \"square.obj\"\nmillimetres_per_unit = nan".to_owned(), "finite number"),
        ("flip", scene("flip_v = \"yes\""), "line 4, key `mesh.flip_v`: must be true or false, found string"),
        (
            "atlas",
            scene("atlas = \"old\""),
            "line 4, key `mesh.atlas`: `old` is not known; `own` and `new` are",
        ),
        (
            "atlas-builtin",
            "[mesh]\nbuiltin = \"head\"\natlas = \"new\"".to_owned(),
            "`new` is for mesh files",
        ),
        ("unknown-table", scene("[lamp]"), "key `lamp`: is not known; did you mean"),
        (
            "unknown-key",
            scene("[material]\nalbdo = \"a.png\""),
            "line 5, key `material.albdo`: is not known; did you mean `albedo`?",
        ),
        ("duplicate", scene("[material]\nf0 = 0.1\nf0 = 0.2"), "line 6"),
        (
            "missing-texture",
            scene("[material]\nalbedo = \"none.png\""),
            "line 5, key `material.albedo`: `none.png`",
        ),
        ("texture-climb", scene("[material]\nalbedo = \"../cutis-outside.png\""), "leads out of"),
        ("texture-link", scene("[material]\nnormal = \"link.png\""), "link"),
        (
            "texture-type",
            scene("[material]\nalbedo = 7"),
            "must be a path or a list of three numbers, found integer",
        ),
        ("texture-format", scene("[material]\nalbedo = \"square.obj\""), "none of PNG"),
        ("texture-cut", scene("[material]\nalbedo = \"cut.jpg\""), "is cut off"),
        ("colour", scene("[material]\nalbedo = [1, 0.5]"), "three numbers, found 2"),
        ("bright", scene("[material]\nalbedo = [2, 0, 0]"), "must be 0 to 1, got 2"),
        ("words", scene("[material]\nalbedo = [1, \"a\", 0]"), "must be a number, found string"),
        ("mix", scene("[material]\nalbedo_mix = 1.5"), "must be 0 to 1, got 1.5"),
        ("f0", scene("[material]\nf0 = inf"), "must be a finite number"),
        ("huge", scene("[material]\nf0 = 1e300"), "must be a finite number"),
        ("thin", scene("[material]\nthickness_scale = -0.5"), "must be 0 to 1000000, got -0.5"),
        ("long", scene("[material]\nmean_free_path_scale = 20"), "must be 0.1 to 10, got 20"),
        ("short", scene("[material]\nmean_free_path_scale = 0"), "must be 0.1 to 10, got 0"),
        ("thick", scene("[material]\nthickness_scale = 1e7"), "must be 0 to 1000000, got 10000000"),
        ("endless", scene("[material]\nthickness_scale = inf"), "must be a finite number"),
        ("nan", scene("[material]\nthickness_scale = nan"), "must be a finite number"),
        ("fat", scene("[material]\nthickness_scale = \"fat\""), "must be a number, found string"),
        (
            "layer",
            scene("[material]\nunder = [{ path = \"none.png\" }]"),
            "key `material.under[0].path`: `none.png`",
        ),
        ("layers", scene("[material]\nunder = \"map.png\""), "must be a list of tables"),
        (
            "bare-layer",
            scene("[material]\nunder = [{ colour = [1, 1, 1] }, {}]"),
            "`material.under[1].path`: is missing",
        ),
        ("bright-layer", scene("[material]\nunder = [{ colour = [1, 1.5, 1] }]"), "must be 0 to 1, got 1.5"),
        ("strange-layer", scene("[material]\nunder = [{ color = [1, 1, 1] }]"), "did you mean `colour`?"),
        (
            "many-layers",
            scene(&format!("[material]\nunder = [{}]", "{ colour = [1, 1, 1] }, ".repeat(9))),
            "has 9 layers under the surface; at most 8",
        ),
        ("no-layers", scene("[material]\nlayers = []"), "0 of them; must be 1 to 64"),
        ("word-layers", scene("[material]\nlayers = \"skin\""), "must be a list of tables"),
        (
            "endless-above",
            scene(&format!("[material]\nlayers = [{{ {LAYER} }}, {{ {LAYER} }}]")),
            "key `material.layers[0].thickness_mm`: is missing: only the last layer may be endless",
        ),
        (
            "no-thickness",
            scene(&format!("[material]\nlayers = [{{ {LAYER}, thickness_mm = 0 }}]")),
            "`material.layers[0].thickness_mm`: must be above 0",
        ),
        (
            "half-a-layer",
            scene("[material]\nlayers = [{ sigma_a_per_mm = [1, 1, 1], thickness_mm = 1 }]"),
            "`material.layers[0].sigma_s_reduced_per_mm`: is missing",
        ),
        (
            "two-tissues",
            scene(&format!("[material]\npreset = \"skin1\"\nlayers = [{{ {LAYER} }}]")),
            "`material.layers`: stands beside `preset`",
        ),
        (
            "one-shift",
            light(&slide("path = \"missing.png\"\nshift = [1]")),
            "must be a list of two numbers, found 1",
        ),
        ("far-shift", light(&slide("path = \"missing.png\"\nshift = [0, 1.5]")), "must be -1 to 1, got 1.5"),
        (
            "quick-drift",
            light(&slide("path = \"missing.png\"\ndrift_per_s = [0, nan]")),
            "must be a finite number",
        ),
        ("mixture", scene("[material]\nmixed_with = \"marble\""), "must be a table"),
        (
            "nothing-mixed",
            scene("[material]\npreset = \"marble\"\nmixed_with = { share = 0.5 }"),
            "`material.mixed_with.medium`: is missing",
        ),
        (
            "no-share",
            scene("[material]\npreset = \"marble\"\nmixed_with = { preset = \"marble\" }"),
            "`material.mixed_with.share`: is missing",
        ),
        (
            "all-of-it",
            scene("[material]\npreset = \"marble\"\nmixed_with = { preset = \"marble\", share = 1.5 }"),
            "must be 0 to 1, got 1.5",
        ),
        (
            "nothing-to-mix-with",
            scene("[material]\nmixed_with = { preset = \"marble\", share = 0.5 }"),
            "key `material.mixed_with`: has no medium to be mixed with: `three-layer-skin` is a kernel",
        ),
        (
            "layers-mixed",
            scene(&format!(
                "[material]\nlayers = [{{ {LAYER} }}]\nmixed_with = {{ preset = \"marble\", share = 0.5 }}"
            )),
            "the tissue has layers; only media mix",
        ),
        (
            "mistyped-second",
            scene("[material]\npreset = \"marble\"\nmixed_with = { preset = \"ketchpu\", share = 0.5 }"),
            "key `material.mixed_with.preset`: no preset is called \"ketchpu\"; the nearest name is \"ketchup\"",
        ),
        (
            "clear-second",
            scene(
                "[material]\npreset = \"marble\"\nmixed_with = { medium = { sigma_a_per_mm = [1, 1, 1], \
                 sigma_s_reduced_per_mm = [1, 1e-30, 1] }, share = 0.5 }",
            ),
            "`material.mixed_with.medium.sigma_s_reduced_per_mm`: must be 0.000000001 to 10000",
        ),
        (
            "jump-of-indices",
            scene(
                "[material]\nlayers = [{ sigma_a_per_mm = [1, 1, 1], sigma_s_reduced_per_mm = [1, 1, 1], thickness_mm = 1, \
                 refractive_index = 1.0 }, { sigma_a_per_mm = [1, 1, 1], sigma_s_reduced_per_mm = [1, 1, 1], \
                 refractive_index = [1.5, 2.5, 1] }]",
            ),
            "`material.layers[1].refractive_index`: is 2.5 under a layer of 1; neighbours may differ by a factor of 2",
        ),
        (
            "mixed-kernel",
            scene(
                "[material]\npreset = \"marble\"\nmixed_with = { preset = \"three-layer-skin\", share = 0.5 }",
            ),
            "key `material.mixed_with.preset`: `three-layer-skin` is a kernel; only media mix",
        ),
        (
            "own-kernel",
            scene(
                "[material]\nmixed_with = { kernel = { variances_mm2 = [1], weights = [[1, 1, 1]] }, share = 0 }",
            ),
            "is not known",
        ),
        ("space", scene("[material]\npreset = \"marble\"\nnormal_space = \"world\""), "`world` is not known"),
        ("lonely", scene("[material]\nnormal_strength = 2"), "has no `normal` to apply to"),
        (
            "channel",
            scene("[material]\nspecular = { path = \"cut.jpg\", channel = \"z\" }"),
            "`z` is not known",
        ),
        ("no-map", scene("[material]\nspecular = { gain = 1 }"), "key `material.specular.path`: is missing"),
        ("roughness", scene("[material]\nroughness = -0.1"), "must be 0 to 1"),
        ("tissue", scene("[material]\npreset = \"a\"\nmedium = {}"), "only one can be the tissue"),
        (
            "medium",
            scene("[material]\nmedium = { sigma_a_per_mm = [0, 0, 0] }"),
            "`material.medium.sigma_s_reduced_per_mm`: is missing",
        ),
        (
            "negative",
            scene("[material]\nmedium = { sigma_a_per_mm = [0, -1, 0] }"),
            "must be 0 to 10000, got -1",
        ),
        (
            "index",
            scene(
                "[material]\nmedium = { sigma_a_per_mm = [0, 0, 0], sigma_s_reduced_per_mm = [1, 1, 1], refractive_index = 0.5 }",
            ),
            "must be 1 to 3",
        ),
        ("kindless", light("intensity = 1"), "key `light[0].kind`: is missing"),
        ("kind", light("kind = \"laser\""), "`laser` is not known"),
        ("no-slide", light(&slide("")), "key `light[0].path`: is missing"),
        ("lost-slide", light(&slide("path = \"none.png\"")), "cannot be opened"),
        ("outside", light(&slide("path = \"../slide.png\"")), "key `light[0].path`"),
        ("wide", light(&slide("path = \"a.png\"\nvertical_fov_degrees = 180")), "got 180"),
        ("one-light", scene("[light]\nkind = \"point\""), "written [[light]]"),
        ("nowhere", light("kind = \"point\""), "key `light[0].position_mm`: is missing"),
        ("direction", light("kind = \"directional\"\ndirection = [0, 0, 0]"), "has no direction"),
        ("dark", light("kind = \"point\"\nposition_mm = [0, 0, 1]\nintensity = -2"), "got -2"),
        (
            "cones",
            light("kind = \"spot\"\nposition_mm = [0, 0, 1]\ndirection = [0, 0, 1]\ninner_cone_degrees = 60"),
            "must be below outer_cone_degrees",
        ),
        ("point-key", light("kind = \"point\"\nposition = [0, 0, 1]"), "did you mean `position_mm`?"),
        ("two", light(two_environments), "second environment"),
        ("many", scene(&many_lights), "1001 lights"),
        ("map", light("kind = \"environment\"\npath = \"none.hdr\""), "cannot be opened"),
        (
            "distance",
            scene("[camera]\ndistance_mm = -900"),
            "line 5, key `camera.distance_mm`: must be above 0",
        ),
        ("fov-0", scene("[camera]\nvertical_fov_degrees = 0"), "must be 0.1 to 170, got 0"),
        ("fov-180", scene("[camera]\nvertical_fov_degrees = 180"), "must be 0.1 to 170, got 180"),
        ("where", scene("[camera]\nposition_mm = [0, 0, 1]\ndistance_mm = 2"), "already says where"),
        ("same", scene("[camera]\nposition_mm = [0, 0, 1]\nlook_at_mm = [0, 0, 1]"), "the camera looks at"),
        ("deep", format!("a = {}", "[".repeat(100_000)), "line 1"),
    ];
    for (name, text, words) in cases {
        refuse(&write(folder.path(), &format!("{name}.toml"), text), words);
    }
    refuse(&write(folder.path(), "latin.toml", b"# \n# \xe9\n"), "line 2: is not text in UTF-8");
    refuse(&write(folder.path(), "long.toml", vec![b'#'; 1 << 21]), "a scene file has at most");
    std::fs::remove_file(folder.path().parent().unwrap().join("cutis-outside.png")).unwrap();
}

#[test]
fn folders_and_files_that_are_not_there() {
    let folder = tempfile::tempdir().unwrap();
    for extension in ["obj", "glb", "gltf", "toml", "png", "exr", "hdr", "jpg"] {
        let missing = folder.path().join(format!("missing.{extension}"));
        refuse(&missing, "cannot be opened");
        let inside = folder.path().join(format!("folder.{extension}"));
        std::fs::create_dir(&inside).unwrap();
        refuse(&inside, "is a folder");
    }
    let device = PathBuf::from("/dev/zero");
    if device.exists() {
        let error = read_image(&device, ColourSpace::Data, &mut Vec::new()).unwrap_err();
        assert!(error.reason.contains("not a regular file"), "{error}");
    }
}

#[test]
fn options_are_checked_too() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "square.obj", SQUARE_OBJ);
    for mm in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let options = ReadOptions { millimetres_per_unit: Some(mm), ..ReadOptions::default() };
        let error = read_scene(&path, &options).unwrap_err();
        assert_eq!(error.place, "millimetres_per_unit");
    }
    let albedo = Some(folder.path().join("none.png"));
    let error = read_scene(&path, &ReadOptions { albedo, ..ReadOptions::default() }).unwrap_err();
    assert!(error.file.contains("none.png"), "{error}");
}
