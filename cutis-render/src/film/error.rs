//! What can go wrong between a frame and a file.

use super::known_extensions;
use std::ops::RangeInclusive;
use std::path::PathBuf;

/// Why a picture could not be developed or written. Nothing was written, unless the variant says otherwise.
#[derive(Debug, thiserror::Error)]
pub enum FilmError {
    /// A number is out of its range.
    #[error("{name} must be {range}, got {value}")]
    BadSetting {
        /// The number's name.
        name: &'static str,
        /// What it may be.
        range: &'static str,
        /// What it is.
        value: f32,
    },
    /// The extension names no format this program writes.
    #[error("{}: {} is no picture format that can be written; there are {}", path.display(), named(extension), known_extensions())]
    UnknownExtension {
        /// The output.
        path: PathBuf,
        /// Its extension, empty if there is none.
        extension: String,
    },
    /// The format does not come in this depth.
    #[error("{}: {format} files come in {known} bits per channel, not {bits}", path.display())]
    BadBits {
        /// The output.
        path: PathBuf,
        /// Name of the format.
        format: &'static str,
        /// Depths the format has.
        known: &'static str,
        /// Depth that was asked for.
        bits: u32,
    },
    /// The folder of the output is not there.
    #[error("{}: there is no folder {}", path.display(), folder.display())]
    MissingFolder {
        /// The output.
        path: PathBuf,
        /// The missing folder.
        folder: PathBuf,
    },
    /// Something is in the place of the output that is no plain file.
    #[error("{}: this is a folder or a device, not a file that can be replaced", path.display())]
    NotAFile {
        /// The output.
        path: PathBuf,
    },
    /// The system refuses.
    #[error("{}: cannot be written: {reason}", path.display())]
    NotWritable {
        /// The output.
        path: PathBuf,
        /// The system's reason.
        reason: std::io::Error,
    },
    /// The encoder refuses.
    #[error("{}: cannot be encoded: {reason}", path.display())]
    Encode {
        /// The output.
        path: PathBuf,
        /// The encoder's reason.
        reason: String,
    },
}

/// Passes a number that is in its range; NaN is in none.
pub(super) fn in_range(
    name: &'static str,
    value: f32,
    allowed: RangeInclusive<f32>,
    range: &'static str,
) -> Result<(), FilmError> {
    if allowed.contains(&value) { Ok(()) } else { Err(FilmError::BadSetting { name, range, value }) }
}

fn named(extension: &str) -> String {
    if extension.is_empty() { "a name without extension".to_owned() } else { format!("'.{extension}'") }
}
