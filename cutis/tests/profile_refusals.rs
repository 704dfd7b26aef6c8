//! What `cutis profile` refuses.

mod common;

use common::{assert_refused, names};
use std::fs;

#[test]
fn nonsense_ends_with_code_2_and_one_clear_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let cases: &[(&[&str], &str)] = &[
        (&[], "give a MATERIAL"),
        (&["skin3"], "the nearest name is \"skin1\""),
        (&["nowhere.toml"], "nowhere.toml: there is no such file"),
        (&["skin1", "--gaussians", "0"], "--gaussians must be 1 to 16, got 0"),
        (&["skin1", "--gaussians", "17"], "--gaussians must be 1 to 16, got 17"),
        (&["skin1", "--channel", "x"], "[possible values: r, g, b]"),
        (&["skin1", "--fit", "magic"], "optimal, energy"),
        (&["skin1", "--source", "tripole"], "dipole, better-dipole, multipole, beam, monte-carlo"),
        (&["skin1", "--source", "monte-carlo", "--photons", "5"], "--photons must be 2048 to 10^12, got 5"),
        (&["skin1", "--source", "beam", "--roughness", "0.3"], "beam knows smooth surfaces only"),
        (&["skin1", "--roughness", "2"], "--roughness must be 0 to 1, got 2"),
        (&["spectralon", "--source", "monte-carlo"], "light would walk in it for ever"),
        (&["skin1", "--beam", "1e-18"], "--beam must be at least"),
        (&["skin1", "--beam", "0"], "--beam must be above 0 mm, got 0"),
        (&["skin1", "--fit", "fast", "--seven-tap"], "nothing to bound"),
        (&["skin1", "--source", "beam", "--fit", "fast"], "has to know the poles"),
        (&["skin1", "--wavelength", "550"], "has no spectra"),
        (&["skin1", "--wavelength", "NaN"], "above 0 nm"),
        (&["skin1", "--layer", "mu_a=1,mu_s=1"], "--layer"),
        (&["three-layer-skin", "--source", "dipole"], "finished kernel without layers: --source"),
        (&["three-layer-skin", "--beam", "0.1"], "finished kernel without layers: --beam"),
        (&["skin1", "--plot", "a.jpg"], "a.jpg: a plot is written as .svg or .png"),
        (&["skin1", "--plot", "no/a.png"], "there is no folder no"),
        (&["skin1", "--export", "a.xyz"], "a.xyz: the extension must be"),
        (&["skin1", "--export", "a", "--export-as", "maya"], "unreal, hdrp, blender, openpbr, gltf"),
        (&["skin1", "--export", "a", "--export-as", "csv", "--export-as", "csv"], "2 times for 1 files"),
        (&["skin1", "--channel", "r", "--export", "a.mtlx"], "needs all three channels"),
        (&["--layer", "mu_a=1,mu_s=0"], "layer 1: sigma_s_reduced_per_mm must be at least"),
        (&["--layer", "mu_a=1,mu_s=2,g=1.5"], "layer 1: sigma_s_reduced_per_mm must not be negative"),
        (&["--layer", "mu_a=NaN,mu_s=2"], "layer 1: sigma_a_per_mm must be finite"),
        (&["--layer", "mu_a=0.1,mu_s=2,d=5", "--source", "dipole"], "use multipole or monte-carlo"),
    ];
    for (args, words) in cases {
        assert_refused(folder.path(), &[&["profile"], *args].concat(), words);
    }
    assert!(names(folder.path()).is_empty(), "nothing was written");
}

#[test]
fn hostile_files_are_refused_by_name_and_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let one = "[[layer]]\nsigma_a_per_mm = 0.1\nsigma_s_reduced_per_mm = 2\nrefractive_index = 1.4\n";
    let many = one.repeat(65);
    let long = format!("# {}\n{one}", "x".repeat(1 << 20));
    let cases: &[(&str, &str)] = &[
        ("", "bad.toml: there must be 1 to 64 layers, got 0"),
        ("layer = 5", "bad.toml, line 1"),
        ("\n\n[[layer]]\ncolour = 1", "line 4: unknown field `colour`"),
        (
            "[[layer]]\nsigma_a_per_mm = [1, 2]\nrefractive_index = 1",
            "line 2: expected a number, or an array of three",
        ),
        (
            "[[layer]]\nsigma_a_per_mm = 1\nrefractive_index = 1.4",
            "layer 1: give either sigma_s_reduced_per_mm, or",
        ),
        (
            "[[layer]]\nsigma_a_per_mm = 1\nsigma_s_per_mm = 2\ng = 1\nrefractive_index = 1.4",
            "layer 1: g must lie",
        ),
        (
            "[[layer]]\nsigma_a_per_mm = nan\nsigma_s_reduced_per_mm = 2\nrefractive_index = 1.4",
            "must be finite",
        ),
        ("[[layer]\nx", "line 1"),
        (&many, "1 to 64 layers, got 65"),
        (&long, "is longer than"),
    ];
    for (text, told) in cases {
        fs::write(folder.path().join("bad.toml"), text).expect("written");
        let said = assert_refused(folder.path(), &["profile", "bad.toml", "--json"], told);
        assert!(said.contains("bad.toml"), "{said}");
    }
    fs::write(folder.path().join("bad.toml"), [0xff, 0xfe, 0x00]).expect("written");
    assert_refused(folder.path(), &["profile", "bad.toml"], "not text in UTF-8");
    fs::create_dir(folder.path().join("folder.toml")).expect("made");
    assert_refused(folder.path(), &["profile", "folder.toml"], "is not a file");
}
