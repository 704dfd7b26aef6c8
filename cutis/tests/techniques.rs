//! Techniques with numbers of their own: every flag, every picture, every report.

mod common;

use common::{TINY, assert_refused, names, run, stderr, stdout};

#[test]
fn every_flag_out_of_its_range_is_refused_by_its_name() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("map.png"), "not a picture").expect("written");
    let pixel = image::RgbImage::from_pixel(1, 1, image::Rgb([9, 9, 9]));
    pixel.save(folder.path().join("one.png")).expect("written");
    let cases: &[(&[&str], &str)] = &[
        (&["--wrap", "-1"], "--wrap: wrap must be 0 to 1, got -1"),
        (&["--wrap", "NaN"], "--wrap: wrap must be 0 to 1, got NaN"),
        (&["--scatter-width", "1.5"], "--scatter-width: scatter width must be 0 to 1, got 1.5"),
        (
            &["--scatter-colour", "0,2,0"],
            "--scatter-colour: scatter colour must be 0 to 1 in every channel, got 2",
        ),
        (&["--scatter-colour", "-0.5,0,0"], "got -0.5"),
        (&["--scatter-colour", "red"], "'--scatter-colour <R,G,B>': must be three numbers"),
        (&["--wrap-form", "magic"], "table, formula"),
        (&["--wrap-energy-conserving", "maybe"], "on, off"),
        (&["--wrap-radius", "0"], "--wrap-radius: radius of the body must be above 0"),
        (&["--wrap-shine", "magic"], "measured, power"),
        (&["--shininess", "0"], "--shininess: shininess must be 1 to 1000, got 0"),
        (&["--wrap-specular", "0,0,1.01"], "--wrap-specular: specular colour must be"),
        (&["--wrap-shadow-offset", "-2"], "--wrap-shadow-offset: shadow offset must be 0 to 1000 mm, got -2"),
        (&["--sigma-t", "1,-1,1"], "--sigma-t: sigma_t must be not negative and finite, in 1/mm, got -1"),
        (&["--sigma-t", "inf,1,1"], "got inf"),
        (&["--absorption-ramp", "0:1,1,1"], "'--absorption-ramp <STOPS>': a colour ramp needs two stops"),
        (&["--absorption-ramp", "5:1,1,1;4:0,0,0"], "got 4 mm after 5 mm"),
        (&["--absorption-ramp", "0:1,1,1;4:0,0,0", "--sigma-t", "1,1,1"], "cannot be used with"),
        (&["--absorption-ramp-image", "one.png"], "--absorption-ramp-length"),
        (
            &["--absorption-ramp-image", "one.png", "--absorption-ramp-length", "20"],
            "--absorption-ramp-image one.png: a colour ramp needs two stops at least, got 1",
        ),
        (
            &["--absorption-ramp-image", "one.png", "--absorption-ramp-length", "0"],
            "--absorption-ramp-length must be above 0 mm and finite, got 0",
        ),
        (
            &["--absorption-ramp-image", "none.png", "--absorption-ramp-length", "9"],
            "none.png: there is no such file",
        ),
        (&["--absorption-ramp-image", "map.png", "--absorption-ramp-length", "9"], "map.png"),
        (&["--growth", "-0.1"], "--growth: growth must be 0 to 1000 mm, got -0.1"),
        (&["--entry", "magic"], "distance, surface"),
        (&["--depth-samples", "0"], "--depth-samples: samples of the depth map must be 1 to 64, got 0"),
        (
            &["--depth-filter-radius", "1e4"],
            "--depth-filter-radius: radius of the filter must be 0 to 1000 mm",
        ),
        (&["--depth-layers", "17"], "--depth-layers: layers of the depth map must be 1 to 16, got 17"),
        (&["--blur-weights", "magic"], "printed, normalised"),
        (&["--blur-passes", "65"], "--blur-passes: passes of the blur must be 0 to 64, got 65"),
        (&["--blur-blend", "1.1"], "--blur-blend: blend of the blur must be 0 to 1, got 1.1"),
        (
            &["--blur-width", "-1"],
            "--blur-width: width of the blur must be 0 to 64 times the listing's, got -1",
        ),
        (&["--blur-width", "wide"], "must be a number or 'material'"),
        (&["--blur-depth", "2"], "on, off"),
        (&["--profile-samples", "0"], "--profile-samples: samples of the profile must be 1 to 4096, got 0"),
        (&["--profile-samples", "-5"], "-5"),
        (&["--uniform-samples", "4097"], "--uniform-samples: uniform samples must be 0 to 4096, got 4097"),
        (&["--uniform-radius", "0"], "--uniform-radius: radius of the uniform samples must be above 0"),
        (&["--jacobian", "1"], "on, off"),
        (&["--sample-count", "some"], "valid, all"),
        (&["--light-views", ""], "on, off"),
        (&["--sampled-profile", "magic"], "medium, gaussians"),
        (&["--as-in", "nobody-1999"], "green-2004, mertens-2003"),
        (&["--as-in", "green-2004"], "--technique wrap, depth-absorption, texture-blur"),
        (&["--longest-side", "0"], "--longest-side must be above 0 mm, got 0"),
        (&["--time", "-1"], "--time must be 0 to 100000 s, got -1"),
        (&["--time", "inf"], "--time must be 0 to 100000 s, got inf"),
        (&["--longest-side", "NaN"], "--longest-side must be above 0 mm, got NaN"),
        (&["--material", "jade"], "skin1"),
    ];
    for (args, words) in cases {
        assert_refused(folder.path(), &[&["render"], *args].concat(), words);
    }
    assert_eq!(names(folder.path()), ["map.png", "one.png"], "nothing was written");
}

/// The keys of every technique's numbers, as they are documented.
const KEYS: [(&str, &[&str]); 4] = [
    (
        "wrap",
        &[
            "energy_conserving",
            "form",
            "radius_mm",
            "scatter_colour_rgb",
            "scatter_width",
            "shadow_offset_mm",
            "shine",
            "shininess",
            "specular_colour_rgb",
            "wrap",
        ],
    ),
    ("depth-absorption", &["entry", "fall_off", "filter_radius_mm", "growth_mm", "layers", "samples"]),
    ("texture-blur", &["blend", "depth", "passes", "weights", "width_factor"]),
    (
        "image-space",
        &[
            "count",
            "jacobian",
            "light_views",
            "profile",
            "round",
            "samples",
            "uniform_radius_mm",
            "uniform_samples",
        ],
    ),
];

#[test]
fn every_technique_draws_the_head_and_tells_its_numbers() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut pictures: Vec<(&str, Vec<u8>)> = Vec::new();
    for (technique, keys) in KEYS {
        let output = run(folder.path(), &[&TINY[..], &["--json", "--technique", technique]].concat());
        // Code 1 would say that some pixels hold no finite number.
        assert_eq!(output.status.code(), Some(0), "{technique}: {}", stderr(&output));
        let json: serde_json::Value = serde_json::from_str(&stdout(&output)).expect("one JSON object");
        assert_eq!((json["technique"].as_str(), json["as_in"].is_null()), (Some(technique), true));
        let settings = json["technique_settings"].as_object().expect("an object");
        let mut found: Vec<_> = settings.keys().map(String::as_str).collect();
        found.sort_unstable();
        assert_eq!(found, keys, "{technique}");
        let picture = image::open(folder.path().join("cutis.png")).expect("a PNG").to_rgb8();
        let bright = picture.pixels().filter(|p| p.0.iter().any(|&c| c > 60)).count();
        // A head fills at least a tenth of its picture.
        assert!(bright > 48 * 40 / 10, "{technique}: {bright}");
        let twin = pictures.iter().find(|(_, other)| *other == *picture.as_raw());
        assert!(twin.is_none(), "{technique} looks like {:?}", twin.map(|(name, _)| name));
        pictures.push((technique, picture.into_raw()));
    }
}

#[test]
fn flags_of_another_technique_are_told_and_change_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let wrap = ["--technique", "wrap", "--json"];
    let draw = |own: &[&str]| {
        let output = run(folder.path(), &[&TINY[..], &wrap, own].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let json: serde_json::Value = serde_json::from_str(&stdout(&output)).expect("one JSON object");
        (stderr(&output), json, std::fs::read(folder.path().join("cutis.png")).expect("written"))
    };
    let (quiet, _, before) = draw(&[]);
    assert!(!quiet.contains("has no effect"), "{quiet}");
    let idle = ["--depth-layers", "2", "--blur-passes", "3", "--jacobian", "off"];
    let (said, json, after) = draw(&idle);
    for flag in ["--depth-layers", "--blur-passes", "--jacobian"] {
        let words = format!("{flag} has no effect: the technique is wrap");
        assert!(said.contains(&format!("warning: {words}")), "{said}");
        assert!(json["warnings"].as_array().expect("a list").iter().any(|w| *w == words), "{json}");
    }
    assert!(before == after, "they change nothing");
    let (said, json, after) = draw(&["--wrap", "0.6"]);
    assert!(!said.contains("has no effect") && before != after, "{said}");
    assert_eq!(json["technique_settings"]["wrap"].as_f64().map(|x| (x * 1e3).round()), Some(600.0));
}

/// The picture of a ramp in a file is that of the same stops in words.
#[test]
fn a_ramp_is_read_from_words_and_from_a_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut ramp = image::RgbImage::from_pixel(2, 3, image::Rgb([7, 8, 9]));
    ramp.put_pixel(0, 1, image::Rgb([255, 255, 255]));
    ramp.put_pixel(1, 1, image::Rgb([255, 0, 0]));
    ramp.save(folder.path().join("ramp.png")).expect("written");
    let draw = |own: &[&str]| {
        let technique = ["--technique", "depth-absorption", "--json"];
        let output = run(folder.path(), &[&TINY[..], &technique, own].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let json: serde_json::Value = serde_json::from_str(&stdout(&output)).expect("one JSON object");
        json["technique_settings"]["fall_off"].clone()
    };
    let words = draw(&["--absorption-ramp", "5:1,1,1;15:1,0,0"]);
    let picture = draw(&["--absorption-ramp-image", "ramp.png", "--absorption-ramp-length", "20"]);
    assert_eq!(words["kind"], "ramp");
    assert_eq!(words, picture);
    assert_eq!(words["stops"][1]["distance_mm"].as_f64(), Some(15.0));
}

#[test]
fn a_paper_is_drawn_and_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let paper = ["--as-in", "mertens-2003", "--json", "--profile-samples", "4"];
    let output = run(folder.path(), &[&TINY[..], &paper].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let json: serde_json::Value = serde_json::from_str(&stdout(&output)).expect("one JSON object");
    assert_eq!(
        (json["technique"].as_str(), json["as_in"].as_str()),
        (Some("image-space"), Some("mertens-2003"))
    );
    assert_eq!((json["material"].as_str(), json["longest_side_mm"].as_f64()), (Some("skin1"), Some(100.0)));
    assert_eq!(json["technique_settings"]["jacobian"], false);
    assert_eq!(json["technique_settings"]["samples"], 4);
    assert_eq!(json["width"], 48, "the size that was asked for wins");
}
