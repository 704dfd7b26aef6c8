//! `cutis profile` from outside.

mod common;

use common::{json_of, number, run, stderr, stdout};
use serde_json::Value;
use std::fs;

fn json(words: &[&str]) -> Value {
    json_of(tempfile::tempdir().expect("a folder").path(), "profile", words)
}

const SHEET: [&str; 2] = ["--layer", "mu_a=0.05,mu_s=4,n=1.4,d=1.5"];

const TWO_LAYERS: &str = r#"
name = "two layers"
[[layer]]
sigma_a_per_mm = [0.1, 0.2, 0.5]
sigma_s_per_mm = 24
g = 0.8
refractive_index = 1.4
thickness_mm = 0.5
[[layer]]
sigma_a_per_mm = 0.05
sigma_s_reduced_per_mm = [2.0, 2.5, 3.0]
refractive_index = 1.38
"#;

#[test]
fn one_channel_is_the_flat_object_of_the_contract() {
    let report = json(&["skin1", "--channel", "r", "--gaussians", "4"]);
    assert_eq!(
        (&report["material"], &report["channel"], &report["source"]),
        (&"skin1".into(), &"r".into(), &"dipole".into())
    );
    let layer = &report["layers"][0];
    assert_eq!((number(&layer["sigma_a_per_mm"]), number(&layer["sigma_s_reduced_per_mm"])), (0.032, 0.74));
    assert_eq!((number(&layer["refractive_index"]), &layer["thickness_mm"]), (1.3, &Value::Null));
    let total = number(&report["total_diffuse_reflectance"]);
    let fit = &report["fit"];
    assert_eq!(fit["method"], "energy");
    assert!((number(&fit["energy"]) - total).abs() < 1e-12, "{fit}");
    // Known optimum under the constraint of energy for four Gaussians, in percent: 0.4554.
    assert!((number(&fit["relative_rms_power_error"]) - 0.004554).abs() < 1e-5, "{fit}");
    assert_eq!(fit["weights"].as_array().map(Vec::len), Some(4));
    assert_eq!(fit["variances_mm2"].as_array().map(Vec::len), Some(4));
    assert!(number(&report["wall_seconds"]) > 0.0);
    let optimal = json(&["skin1", "--channel", "r", "--gaussians", "4", "--fit", "optimal"]);
    assert!((number(&optimal["fit"]["relative_rms_power_error"]) - 0.004036).abs() < 1e-5);
    assert!(number(&optimal["fit"]["energy"]) < total);
}

#[test]
fn three_channels_come_with_a_joint_kernel() {
    let report = json(&["skin2", "--gaussians", "4"]);
    let channels = report["channels"].as_array().expect("a list");
    assert_eq!(channels.len(), 3);
    let joint = &report["joint_kernel"];
    for (c, channel) in channels.iter().enumerate() {
        assert_eq!(channel["channel"], ["r", "g", "b"][c]);
        assert!((number(&joint["energy"][c]) - number(&channel["total_diffuse_reflectance"])).abs() < 1e-9);
        // Shared variances cannot do better than their own.
        let shared = number(&joint["relative_rms_power_error"][c]);
        assert!(shared >= 0.999 * number(&channel["fit"]["relative_rms_power_error"]), "{c}");
    }
    assert_eq!(joint["weights"].as_array().map(Vec::len), joint["variances_mm2"].as_array().map(Vec::len));
}

#[test]
fn a_preset_that_is_a_kernel_comes_as_it_is() {
    let report = json(&["three-layer-skin"]);
    let red = &report["channels"][0];
    assert_eq!((&red["source"], &red["fit"]["method"]), (&"kernel".into(), &"given".into()));
    assert_eq!(red["layers"].as_array().map(Vec::len), Some(0));
    assert_eq!(red["fit"]["variances_mm2"].as_array().map(Vec::len), Some(6));
    let fewer = json(&["three-layer-skin", "--channel", "r", "--gaussians", "3"]);
    assert_eq!(fewer["fit"]["method"], "energy");
    assert!(number(&fewer["fit"]["relative_rms_power_error"]) > 0.001);
}

#[test]
fn layers_from_words_and_from_a_file_are_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("two.toml"), TWO_LAYERS).expect("written");
    let file = json_of(folder.path(), "profile", &["two.toml", "--channel", "g", "--gaussians", "3"]);
    let words = json(&[
        "--layer",
        "mu_a=0.2,mu_s=24,g=0.8,n=1.4,d=0.5",
        "--layer",
        "mu_a=0.05,mu_s=2.5,n=1.38",
        "--gaussians",
        "3",
    ]);
    assert_eq!((&file["material"], &file["source"]), (&"two layers".into(), &"multipole".into()));
    assert_eq!(words["channel"], Value::Null);
    for key in ["layers", "total_diffuse_reflectance"] {
        assert_eq!(file[key], words[key], "{key}");
    }
    assert_eq!(file["fit"]["weights"], words["fit"]["weights"]);
    let half_space = json(&["--layer", "mu_a=0.032,mu_s=0.74,n=1.3", "--gaussians", "2"]);
    assert_eq!(half_space["source"], "dipole");
}

#[test]
fn an_explanation_tells_lengths_apart_and_says_where_diffusion_fails() {
    let report = json(&["skin1", "--channel", "b", "--gaussians", "2", "--explain"]);
    let explained = &report["explanation"];
    // 1/(0.48 + 1.01) and 1/sqrt(3 · 0.48 · 1.49) by pocket calculator.
    let layer = &explained["layers"][0];
    assert!((number(&layer["transport_mean_free_path_mm"]) - 0.671_141).abs() < 1e-6);
    assert!((number(&layer["diffuse_mean_free_path_mm"]) - 0.682_696).abs() < 1e-5);
    assert_eq!(layer["diffusion_holds"], false);
    assert!(layer["verdict"].as_str().expect("words").contains("monte-carlo"));
    assert_eq!(number(&explained["total_transmittance"]), 0.0);
    let errors: Vec<f64> = explained["fits"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|trial| number(&trial["relative_rms_power_error"]))
        .collect();
    assert_eq!(errors.len(), 8);
    assert!(errors.windows(2).all(|pair| pair[1] <= pair[0]), "{errors:?}");
    let folder = tempfile::tempdir().expect("a folder");
    let output = run(folder.path(), &["profile", "skin1", "--channel", "b", "--gaussians", "2"]);
    assert!(stderr(&output).contains("reduced albedo 0.6779"), "{}", stderr(&output));
    assert!(stdout(&output).contains("skin1") && !stdout(&output).contains("reduced albedo"));
    let sheet = json(&["--layer", "mu_a=0,mu_s=5,n=1.4,d=1", "--gaussians", "1", "--explain"]);
    let both =
        number(&sheet["total_diffuse_reflectance"]) + number(&sheet["explanation"]["total_transmittance"]);
    assert!((both - 1.0).abs() < 1e-12, "without absorption all light comes out: {both}");
}

#[test]
fn layers_that_end_tell_what_comes_out_below() {
    let report = json(&[&SHEET[..], &["--gaussians", "2"]].concat());
    let total = number(&report["total_transmittance"]);
    let radial = &report["radial_profile"];
    let list = |key: &str| -> Vec<f64> { radial[key].as_array().expect(key).iter().map(number).collect() };
    let (r, t) = (list("r_mm"), list("transmittance_per_mm2"));
    assert_eq!((r.len(), list("reflectance_per_mm2").len()), (t.len(), t.len()));
    // ∫ 2 pi r² T d(ln r): the light that comes out is that of the total. 64 radii over five decades at most take steps of
    // 0.18, with which the trapezoid rule errs by far less than what lies beyond the last radius, some thousandths.
    let step = (r[1] / r[0]).ln();
    let sum: f64 = r.iter().zip(&t).map(|(r, t)| std::f64::consts::TAU * r * r * t * step).sum();
    assert!((sum / total - 1.0).abs() < 0.01, "{sum} of {total}");
    let simulated =
        [&SHEET[..], &["--source", "monte-carlo", "--photons", "40960", "--gaussians", "2"]].concat();
    let simulated = number(&json(&simulated)["total_transmittance"]);
    // Diffusion against the truth where reduced albedo is 0.99 and the sheet six mean free paths thick: within a tenth.
    assert!((total / simulated - 1.0).abs() < 0.1, "{total} against {simulated}");
    let endless = json(&["skin1", "--channel", "r", "--gaussians", "2"]);
    assert!(endless["total_transmittance"].is_null() && endless["radial_profile"].is_null());
}

#[test]
fn small_numbers_keep_their_digits() {
    let folder = tempfile::tempdir().expect("a folder");
    let words = ["profile", "--layer", "mu_a=1e5,mu_s=1e-4,n=1.4", "--gaussians", "2", "--explain"];
    let output = run(folder.path(), &words);
    assert!(output.status.success(), "{}", stderr(&output));
    let said = stdout(&output);
    for zeros in [" 0.000000", " 0.0000 %", " 0.0000 mm"] {
        assert!(!said.contains(zeros), "{said}");
    }
}

#[test]
fn every_formula_is_judged_for_the_layers() {
    let judged = |words: &[&str]| -> Vec<(String, bool)> {
        let report = json(&[words, &["--gaussians", "1", "--explain"]].concat());
        let sources = report["explanation"]["sources"].as_array().expect("a list").clone();
        let told = |s: &Value| (s["source"].as_str().expect("a name").to_owned(), s["holds"] == true);
        sources.iter().map(told).collect()
    };
    let expect = |holds: [bool; 4]| {
        ["dipole", "better-dipole", "multipole", "beam"].map(str::to_owned).into_iter().zip(holds).collect()
    };
    let clear: Vec<_> = expect([true, false, true, true]);
    assert_eq!(judged(&["marble", "--channel", "r"]), clear);
    let dark: Vec<_> = expect([false, true, false, true]);
    assert_eq!(judged(&["--layer", "mu_a=0.6,mu_s=0.4,n=1.4"]), dark);
    let sheet: Vec<_> = expect([false, false, true, false]);
    assert_eq!(judged(&SHEET), sheet);
}

#[test]
fn every_source_and_every_method_gives_a_profile_of_its_own() {
    let total = |words: &[&str]| number(&json(words)["total_diffuse_reflectance"]);
    let skin = ["skin1", "--channel", "r", "--source"];
    let of = |source| total(&[&skin[..], &[source]].concat());
    let dipole = of("dipole");
    assert!((of("multipole") - dipole).abs() < 1e-12);
    // With what was scattered once, and without diffusion theory's excess: all within a tenth of each other.
    for other in ["better-dipole", "beam"] {
        assert!((of(other) / dipole - 1.0).abs() < 0.1 && of(other) != dipole, "{other}");
    }
    let simulated = [&skin[..], &["monte-carlo", "--photons", "40000", "--seed", "3"]].concat();
    let report = json(&simulated);
    let (value, error) = (
        number(&report["total_diffuse_reflectance"]),
        number(&report["total_diffuse_reflectance_standard_error"]),
    );
    // 40,000 packets; the beam source is within 4 % of the truth at this albedo and index.
    assert!(error > 0.0 && error < 0.005, "{error}");
    assert!((value / of("beam") - 1.0).abs() < 0.06 + 4.0 * error / value, "{value}");
    assert!(number(&report["beam_standard_deviation_mm"]) > 0.0);
    assert_eq!(json(&[&simulated[..], &["--threads", "1"]].concat())["fit"], report["fit"]);
    for (method, gaussians) in [("fast", "8"), ("powers", "12")] {
        let report = json(&["skin1", "--channel", "r", "--fit", method, "--gaussians", gaussians]);
        assert_eq!(report["fit"]["method"], method);
        assert!(number(&report["fit"]["relative_rms_power_error"]) < 0.05, "{method}: {}", report["fit"]);
    }
    let rough = total(&["skin1", "--channel", "r", "--roughness", "0.4"]);
    assert!(rough > dipole, "a rough surface holds less back: {rough} against {dipole}");
}

#[test]
fn a_slab_too_thin_for_diffusion_gives_a_number_and_a_warning() {
    let thin = ["--layer", "mu_a=0.1,mu_s=2,n=1.4,d=0.2", "--layer", "mu_a=0.01,mu_s=2,n=1.4"];
    let report = json(&thin);
    assert!((0.0..1.0).contains(&number(&report["total_diffuse_reflectance"])));
    let warnings = report["warnings"].as_array().expect("a list");
    let told = |w: &Value| w.as_str().is_some_and(|w| w.contains("layer 1") && w.contains("monte-carlo"));
    assert!(warnings.iter().any(told), "{warnings:?}");
    // The simulation has nothing to be warned of.
    let simulated = json(&[&thin[..], &["--source", "monte-carlo", "--photons", "4096"]].concat());
    assert_eq!(simulated["warnings"].as_array().map(Vec::len), Some(0));
}

#[test]
fn a_simulated_profile_holds_all_the_light() {
    // A thin dense layer over a clear one: light spreads a thousand times as far as the top layer's mean free path.
    let layers = ["--layer", "mu_a=0.01,mu_s=100,n=1.4,d=0.02", "--layer", "mu_a=0.001,mu_s=0.2,n=1.4"];
    let packets = ["--photons", "10240", "--seed", "1"];
    let report = json(&[&layers[..], &packets, &["--source", "monte-carlo"]].concat());
    let folder = tempfile::tempdir().expect("a folder");
    let words = [&["simulate", "--json"], &layers[..], &packets].concat();
    let simulated: Value =
        serde_json::from_str(&stdout(&run(folder.path(), &words))).expect("one JSON object");
    // Per light that entered; the same packets. What the profile may miss without a warning is a thousandth.
    let entered = 1.0 - number(&simulated["specular_reflectance"]);
    let all = number(&simulated["diffuse_reflectance"]) / entered;
    let held = number(&report["total_diffuse_reflectance"]);
    assert!((held / all - 1.0).abs() < 1e-3, "{held} of {all}");
    assert_eq!(report["warnings"].as_array().map(Vec::len), Some(0));
}

#[test]
fn seven_taps_bound_the_variances() {
    let report = json(&["cream", "--gaussians", "4", "--seven-tap"]);
    let variances: Vec<f64> =
        report["joint_kernel"]["variances_mm2"].as_array().expect("a list").iter().map(number).collect();
    assert_eq!(variances.len(), 4);
    assert!(variances.windows(2).all(|v| v[1] <= 4.0 * v[0] * (1.0 + 1e-9)), "{variances:?}");
    // Cream's shortest mean free path is that of red: 1/(7.38 + 0.0002) mm.
    assert!(variances[0] <= (1.0f64 / 7.3802).powi(2) * (1.0 + 1e-9), "{variances:?}");
}
