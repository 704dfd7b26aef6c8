//! Kinds of picture file, and how a name and a depth choose one.

use super::FilmError;
use std::fmt;
use std::path::Path;

/// A picture format and its depth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// PNG, 8 bits per channel, sRGB, dithered.
    Png8,
    /// PNG, 16 bits per channel, sRGB.
    Png16,
    /// OpenEXR, half floats, linear.
    ExrHalf,
    /// OpenEXR, 32-bit floats, linear.
    ExrFloat,
}

/// The extensions that can be written, for messages.
pub fn known_extensions() -> &'static str {
    ".png (8 or 16 bits) and .exr (16 or 32 bits)"
}

impl Format {
    /// The format that a file name asks for by its extension, in the given depth or the format's smaller one.
    ///
    /// # Errors
    /// If the extension is not known, or the format does not come in that depth.
    pub fn of(path: &Path, bits: Option<u32>) -> Result<Self, FilmError> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let wrong_depth = |format, known| {
            let bits = bits.unwrap_or_default();
            Err(FilmError::BadBits { path: path.to_owned(), format, known, bits })
        };
        match (extension.as_str(), bits) {
            ("png", None | Some(8)) => Ok(Self::Png8),
            ("png", Some(16)) => Ok(Self::Png16),
            ("png", _) => wrong_depth("PNG", "8 or 16"),
            ("exr", None | Some(16)) => Ok(Self::ExrHalf),
            ("exr", Some(32)) => Ok(Self::ExrFloat),
            ("exr", _) => wrong_depth("EXR", "16 or 32"),
            _ => Err(FilmError::UnknownExtension { path: path.to_owned(), extension }),
        }
    }

    /// Whether the file holds the frame as it was rendered, so that exposure, bloom and tone mapper do not apply.
    pub fn is_scene_referred(self) -> bool {
        matches!(self, Self::ExrHalf | Self::ExrFloat)
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Png8 => "8-bit PNG",
            Self::Png16 => "16-bit PNG",
            Self::ExrHalf => "16-bit EXR",
            Self::ExrFloat => "32-bit EXR",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extension_and_depth_choose_the_format() {
        let of = |name: &str, bits| Format::of(Path::new(name), bits);
        assert_eq!(of("a.png", None).expect("known"), Format::Png8);
        assert_eq!(of("a.b.PNG", Some(16)).expect("known"), Format::Png16);
        assert_eq!(of("a.exr", None).expect("known"), Format::ExrHalf);
        assert_eq!(of("a.exr", Some(32)).expect("known"), Format::ExrFloat);
    }

    #[test]
    fn what_cannot_be_written_is_said_with_what_can() {
        let message = |name: &str, bits| Format::of(Path::new(name), bits).expect_err("unknown").to_string();
        assert!(message("a.jpg", None).contains("'.jpg'"));
        assert!(message("a.jpg", None).contains(".png (8 or 16 bits) and .exr"));
        assert!(message("a", None).contains("without extension"));
        assert!(message("a.png", Some(32)).contains("8 or 16 bits per channel, not 32"));
        assert!(message("a.exr", Some(8)).contains("16 or 32 bits per channel, not 8"));
    }
}
