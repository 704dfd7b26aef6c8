//! Runs the built program.

use std::path::Path;
use std::process::{Command, Output};

/// Small enough for a test: a picture of a few thousand pixels with the least of everything, by the
/// processor.
#[allow(dead_code, reason = "not every test file renders")]
pub const TINY: [&str; 15] = [
    "render",
    "--backend",
    "cpu",
    "--size",
    "48x40",
    "--samples",
    "1",
    "--irradiance-size",
    "64",
    "--ambient-samples",
    "4",
    "--triangles",
    "2000",
    "--map-size",
    "64",
];

/// The program, in a folder.
pub fn cutis(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_cutis"));
    command.current_dir(folder);
    command
}

/// Runs the program in a folder.
#[allow(dead_code, reason = "not every test file needs it")]
pub fn run(folder: &Path, args: &[&str]) -> Output {
    cutis(folder).args(args).output().expect("the program starts")
}

/// What was printed on stdout.
#[allow(dead_code, reason = "not every test file needs it")]
pub fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("text")
}

/// What was printed on stderr.
pub fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("text")
}

/// Runs the program and asserts that it refuses: code 2, nothing on stdout, on stderr one error with these words and at most
/// help below it. Returns what it said.
#[allow(dead_code, reason = "not every test file needs it")]
pub fn assert_refused(folder: &Path, args: &[&str], words: &str) -> String {
    let output = run(folder, args);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{args:?}: {said}");
    assert!(output.stdout.is_empty(), "{args:?}");
    let mut lines = said.lines();
    let first = lines.next().expect("something is said");
    assert!(first.starts_with("error: ") && first.contains(words), "{args:?}: {said}");
    assert!(lines.all(|line| line.starts_with("help: ")), "{args:?}: {said}");
    said
}

/// The one object that a command prints with `--json`.
#[allow(dead_code, reason = "not every test file needs it")]
pub fn json_of(folder: &Path, command: &str, words: &[&str]) -> serde_json::Value {
    let output = run(folder, &[&[command, "--json"], words].concat());
    assert!(output.status.success(), "{words:?}: {}", stderr(&output));
    serde_json::from_str(&stdout(&output)).expect("one JSON object and nothing else")
}

/// A number of such an object.
#[allow(dead_code, reason = "not every test file needs it")]
pub fn number(value: &serde_json::Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// Names in a folder, sorted.
#[allow(dead_code, reason = "not every test file looks")]
pub fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut names: Vec<_> =
        entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}
