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

/// Longest part of a message. Names and library messages may quote a hostile file at any length.
const MAX_CHARS: usize = 400;

impl SceneError {
    /// An error at `place` of `file`.
    pub fn new(file: &Path, place: impl Into<String>, reason: impl Into<String>) -> Self {
        Self {
            file: one_line(&file.display().to_string()),
            place: one_line(&place.into()),
            reason: one_line(&reason.into()),
        }
    }
}

/// Text as it may be shown in a terminal: one line, no control characters, not endless.
pub fn one_line(text: &str) -> String {
    let mut shown: String =
        text.trim().chars().take(MAX_CHARS).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.trim().chars().nth(MAX_CHARS).is_some() {
        shown.push('…');
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_stay_on_one_line_and_end() {
        let error = SceneError::new(Path::new("a\nb"), "line 1", format!("{}\u{1b}[2J", "x".repeat(9000)));
        let text = error.to_string();
        assert!(text.starts_with("a b: line 1: xxx"), "{text}");
        assert!(!text.chars().any(char::is_control) && text.chars().count() < 1000);
    }
}
