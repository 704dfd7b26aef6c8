//! The one error of this crate: what could not be read, where in it, and why.

use std::path::Path;

/// A file or value that cannot be used. Printed as `file: place: reason`, in one line.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{file}: {place}: {reason}")]
pub struct SceneError {
    /// The file as the user named it, or a word such as `built-in head`.
    pub file: String,
    /// Where in the file: a line, a key, a JSON path, a byte offset.
    pub place: String,
    /// What is wrong, with the numbers needed to mend it.
    pub reason: String,
}

impl SceneError {
    /// An error at `place` of `file`.
    pub fn new(file: &Path, place: impl Into<String>, reason: impl Into<String>) -> Self {
        Self { file: file.display().to_string(), place: place.into(), reason: reason.into() }
    }
}
