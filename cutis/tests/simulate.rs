//! `cutis simulate` from outside.

mod common;

use common::{assert_refused, run, stderr, stdout};
use serde_json::Value;

const SLAB: &str = "mu_a=1,mu_s=9,g=0.75,n=1.4,d=0.2";

fn report(extra: &[&str]) -> Value {
    let folder = tempfile::tempdir().expect("a folder");
    let words = [&["simulate", "--layer", SLAB, "--photons", "20000", "--json"], extra].concat();
    let output = run(folder.path(), &words);
    assert!(output.status.success(), "{}", stderr(&output));
    serde_json::from_str(&stdout(&output)).expect("one JSON object and nothing else")
}

#[test]
fn the_json_object_holds_what_was_counted() {
    let report = report(&[]);
    let number = |key: &str| report[key].as_f64().unwrap_or_else(|| panic!("{key} is a number"));
    let total = number("specular_reflectance")
        + number("diffuse_reflectance")
        + number("transmittance")
        + number("absorbed_fraction");
    // Russian roulette gives and takes by chance.
    assert!((total - 1.0).abs() < 1e-3, "{total}");
    for key in ["specular_reflectance", "diffuse_reflectance", "transmittance", "absorbed_fraction"] {
        assert!(number(&format!("{key}_standard_error")) >= 0.0);
    }
    assert_eq!(number("photons"), 20_000.0);
    assert!(number("photons_per_second") > 0.0);
    let rings = report["radial_profile"]["r_mm"].as_array().expect("is a list").len();
    assert_eq!(report["radial_profile"]["reflectance_per_mm2"].as_array().expect("is a list").len(), rings);
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let [one, two] = ["1", "2"].map(|n| report(&["--threads", n]));
    for key in ["diffuse_reflectance", "transmittance", "radial_profile", "absorbed_by_depth"] {
        assert_eq!(one[key], two[key], "{key}");
    }
    assert_ne!(one["diffuse_reflectance"], report(&["--seed", "2"])["diffuse_reflectance"]);
}

#[test]
fn nonsense_ends_with_code_2_and_one_clear_line() {
    let folder = tempfile::tempdir().expect("a folder");
    for (words, told) in [
        (vec!["--layer", "mu_a=1"], "`mu_s` is missing"),
        (vec!["--layer", "mu_a=1,mu_s=-2"], "layer 1: sigma_s_per_mm must be from 0 to 1e9 1/mm, got -2"),
        (
            vec!["--layer", "mu_a=1,mu_s=2", "--layer", "mu_a=1,mu_s=2"],
            "only the last layer may be infinitely thick",
        ),
        (vec!["--layer", SLAB, "--photons", "1"], "--photons must be 2048 to 10^12, got 1"),
        (vec!["--layer", SLAB, "--ring-width", "NaN"], "--ring-width must be above 0 mm"),
        (vec!["--layer", SLAB, "--threads", "0"], "--threads must be 1 to 1024, got 0"),
        (vec!["--layer", SLAB, "--rings", "0"], "--rings must be 1 to 100000, got 0"),
        (vec![], "--layer"),
    ] {
        assert_refused(folder.path(), &[vec!["simulate"], words].concat(), told);
    }
}
