//! Spoiled files must be refused quickly, in one line that names the file and the place, without a panic.

use super::write;
use cutis_scene::{ColourSpace, ReadOptions, SceneError, read_image, read_scene};
use std::path::Path;
use std::time::{Duration, Instant};

/// Far above the slowest case (0.1 s), far below what a person takes for a hang.
const QUICK: Duration = Duration::from_secs(5);

/// A spoiled file: name, bytes, and words that the message must hold.
pub type Case = (&'static str, Vec<u8>, &'static str);

fn read(path: &Path) -> Result<(), SceneError> {
    let is_image = path.extension().is_some_and(|e| ["png", "jpg", "exr", "hdr"].iter().any(|i| e == *i));
    match is_image {
        true => read_image(path, ColourSpace::Colour, &mut Vec::new()).map(drop),
        false => read_scene(path, &ReadOptions::default()).map(drop),
    }
}

/// Reads a file that must be refused; what is wrong with the answer, if anything.
fn complaint(path: &Path, words: &str) -> Option<String> {
    let start = Instant::now();
    let Err(error) = read(path) else {
        return Some(format!("{} was believed; expected `{words}`", path.display()));
    };
    let message = error.to_string();
    let name = path.file_name().unwrap().to_string_lossy();
    let flaw = if start.elapsed() > QUICK {
        "took too long"
    } else if message.contains('\n') || message.chars().count() > 1300 {
        "is more than a line"
    } else if !error.file.contains(&*name) && error.place != "image" {
        "names another file"
    } else if error.place.is_empty() || error.reason.is_empty() {
        "lacks a place or a reason"
    } else if !message.contains(words) {
        "says something else"
    } else {
        return None;
    };
    Some(format!("expected `{words}`, {flaw}: {message}"))
}

/// Fails unless the file is refused with these words.
pub fn refuse(path: &Path, words: &str) {
    assert_eq!(complaint(path, words), None);
}

/// Fails unless every file is refused; tells all that are not.
pub fn refuse_all(cases: Vec<Case>) {
    let folder = tempfile::tempdir().unwrap();
    let complaints: Vec<String> = cases
        .into_iter()
        .filter_map(|(name, bytes, words)| complaint(&write(folder.path(), name, bytes), words))
        .collect();
    assert!(complaints.is_empty(), "{complaints:#?}");
}
