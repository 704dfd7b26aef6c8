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

/// Names in a folder, sorted.
#[allow(dead_code, reason = "not every test file looks")]
pub fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut names: Vec<_> =
        entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}
