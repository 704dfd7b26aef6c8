//! A long rendering's state on disk, to go on from.

use super::FilmError;
use super::partial_file::PartialFile;
use std::io::Write;
use std::path::{Path, PathBuf};

/// First bytes of the file: name and version.
const MAGIC: [u8; 8] = *b"CUTISCK1";
/// Magic, key, samples.
const HEADER: usize = 24;

/// Where the state is kept.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Checkpoint {
    /// The file.
    pub path: PathBuf,
}

/// Why a rendering could not go on from a file.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// The system refuses.
    #[error("{}: cannot be read: {reason}", path.display())]
    NotReadable {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        reason: std::io::Error,
    },
    /// Not a checkpoint, or cut short.
    #[error("{}: this is no checkpoint of this program, or a part of one; remove it to begin anew", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// Another scene, size or seed.
    #[error("{}: it belongs to another scene, size or seed; remove it, or choose another output", path.display())]
    OfAnother {
        /// The file.
        path: PathBuf,
    },
    /// It could not be written.
    #[error(transparent)]
    NotWritten(#[from] FilmError),
}

impl Checkpoint {
    /// The file of another state of the same rendering.
    pub fn beside(&self, name: &str) -> Self {
        let mut path = self.path.clone().into_os_string();
        path.push(".");
        path.push(name);
        Self { path: path.into() }
    }

    /// The number of samples and the state of a rendering known by `key` with a state of `length` bytes; none if there is no
    /// file.
    ///
    /// # Errors
    /// If there is a file and it is not that.
    pub fn load(&self, key: u64, length: usize) -> Result<Option<(u64, Vec<u8>)>, CheckpointError> {
        let path = || self.path.clone();
        let size = match std::fs::metadata(&self.path) {
            Err(reason) if reason.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(reason) => return Err(CheckpointError::NotReadable { path: path(), reason }),
            Ok(about) => about.len(),
        };
        let head = self.head()?;
        let number = |at: usize| u64::from_le_bytes(std::array::from_fn(|i| head[at + i]));
        if head[..8] != MAGIC {
            return Err(CheckpointError::Foreign { path: path() });
        }
        if number(8) != key {
            return Err(CheckpointError::OfAnother { path: path() });
        }
        if size != (HEADER + length) as u64 {
            return Err(CheckpointError::Foreign { path: path() });
        }
        let mut bytes = std::fs::read(&self.path)
            .map_err(|reason| CheckpointError::NotReadable { path: path(), reason })?;
        if bytes.len() != HEADER + length {
            return Err(CheckpointError::Foreign { path: path() });
        }
        Ok(Some((number(16), bytes.split_off(HEADER))))
    }

    fn head(&self) -> Result<[u8; HEADER], CheckpointError> {
        use std::io::Read;
        let mut head = [0; HEADER];
        let read = std::fs::File::open(&self.path).and_then(|mut file| file.read_exact(&mut head));
        match read {
            Ok(()) => Ok(head),
            Err(reason) if reason.kind() == std::io::ErrorKind::UnexpectedEof => {
                Err(CheckpointError::Foreign { path: self.path.clone() })
            }
            Err(reason) => Err(CheckpointError::NotReadable { path: self.path.clone(), reason }),
        }
    }

    /// Writes the state, beside the old one and then in its place.
    ///
    /// # Errors
    /// If the system refuses.
    pub fn save(&self, key: u64, samples: u64, state: &[u8]) -> Result<(), CheckpointError> {
        let written = PartialFile::fill(Path::new(&self.path), |writer| {
            writer.write_all(&MAGIC)?;
            writer.write_all(&key.to_le_bytes())?;
            writer.write_all(&samples.to_le_bytes())?;
            writer.write_all(state)
        })?;
        Ok(written.commit()?)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;

    #[test]
    fn what_was_kept_comes_back_and_nothing_else_does() {
        let folder = tempfile::tempdir().unwrap();
        let checkpoint = Checkpoint { path: folder.path().join("a.paths") };
        assert_eq!(checkpoint.load(7, 3).unwrap(), None);
        checkpoint.save(7, 64, &[1, 2, 3]).unwrap();
        assert_eq!(checkpoint.load(7, 3).unwrap(), Some((64, vec![1, 2, 3])));
        assert!(matches!(checkpoint.load(8, 3), Err(CheckpointError::OfAnother { .. })));
        assert!(matches!(checkpoint.load(7, 4), Err(CheckpointError::Foreign { .. })));
        for bytes in [&b""[..], b"CUTISCK1", b"something else that is long enough"] {
            std::fs::write(&checkpoint.path, bytes).unwrap();
            assert!(matches!(checkpoint.load(7, 3), Err(CheckpointError::Foreign { .. })), "{bytes:?}");
        }
    }
}
