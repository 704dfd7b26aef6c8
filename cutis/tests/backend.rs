//! Which machine draws, and how the program says so.

mod common;

use common::{TINY, cutis, stderr, stdout};
use std::path::Path;
use std::process::Output;

/// Arguments of [`TINY`] before those that choose the backend, and how many those are.
const BACKEND_FLAGS: (usize, usize) = (1, 2);

/// Renders something tiny by a backend; on a machine without any adapter if `hidden` (Vulkan's loader looks for drivers
/// nowhere else then).
fn render(folder: &Path, backend: &str, hidden: bool) -> Output {
    let (first, count) = BACKEND_FLAGS;
    let mut command = cutis(folder);
    command.args(&TINY[..first]).args(&TINY[first + count..]).args(["--backend", backend, "--json"]);
    if hidden {
        command
            .env("VK_DRIVER_FILES", folder.join("none.json"))
            .env("VK_ICD_FILENAMES", folder.join("none.json"));
    }
    command.output().expect("starts")
}

fn json(output: &Output) -> serde_json::Value {
    assert_eq!(output.status.code(), Some(0), "{}", stderr(output));
    serde_json::from_str(&stdout(output)).expect("one JSON object and nothing else")
}

#[test]
#[cfg(target_os = "linux")]
fn auto_without_an_adapter_is_the_processor_and_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = render(folder.path(), "auto", true);
    assert_eq!(json(&output)["backend"], "cpu");
    let said = stderr(&output);
    assert!(said.contains("backend auto: the processor, because there is no graphics adapter"), "{said}");
}

#[test]
#[cfg(target_os = "linux")]
fn gpu_without_an_adapter_is_an_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = render(folder.path(), "gpu", true);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("error: there is no graphics adapter"), "{}", stderr(&output));
    assert!(!folder.path().join("cutis.png").exists());
}

#[test]
fn gpu_takes_whatever_adapter_there_is_and_names_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = render(folder.path(), "gpu", false);
    if stderr(&output).contains("there is no graphics adapter") {
        let required = std::env::var_os("CUTIS_REQUIRE_GPU").is_some_and(|v| v == "1");
        assert!(!required, "{}", stderr(&output));
        eprintln!("SKIPPED: gpu_takes_whatever_adapter_there_is_and_names_it: no adapter");
        return;
    }
    let json = json(&output);
    assert_eq!(json["backend"], "gpu");
    assert!(json["adapter"].as_str().is_some_and(|name| !name.is_empty()));
    let passes: Vec<_> =
        json["passes"].as_array().expect("a list").iter().map(|p| p["name"].clone()).collect();
    for name in
        ["atlas", "shadow map", "shadows", "irradiance", "heat flow", "gather", "transmission", "resolve"]
    {
        assert!(passes.iter().any(|pass| pass == name), "{name} of {passes:?}");
    }
    let picture = image::open(folder.path().join("cutis.png")).expect("a picture").to_rgba8();
    assert!(picture.pixels().filter(|p| p.0[0] > 60).count() > 200, "the head is lit");
}

#[test]
fn heat_flows_on_adapters_too() {
    let folder = tempfile::tempdir().expect("a folder");
    let (first, count) = BACKEND_FLAGS;
    let mut command = cutis(folder.path());
    command.args(&TINY[..first]).args(&TINY[first + count..]);
    command.args(["--backend", "gpu", "--diffusion", "heat-flow", "--json"]);
    let output = command.output().expect("starts");
    if stderr(&output).contains("there is no graphics adapter") {
        let required = std::env::var_os("CUTIS_REQUIRE_GPU").is_some_and(|v| v == "1");
        assert!(!required, "{}", stderr(&output));
        eprintln!("SKIPPED: heat_flows_on_adapters_too: no adapter");
        return;
    }
    let json = json(&output);
    assert_eq!((&json["backend"], &json["diffusion"]), (&"gpu".into(), &"heat-flow".into()));
    let passes = json["passes"].as_array().expect("a list");
    assert!(passes.iter().any(|pass| pass["name"] == "heat flow"), "{passes:?}");
    assert!(!passes.iter().any(|pass| pass["name"] == "blur"), "{passes:?}");
}
