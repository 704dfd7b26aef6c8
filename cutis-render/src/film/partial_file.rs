//! Files that are there completely or not at all.

use super::FilmError;
use std::fs::{self, File, OpenOptions};
use std::io::{BufWriter, Error as IoError, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// A file written beside its final place; it takes that place in [`PartialFile::commit`] and vanishes when dropped
/// before. Whatever was there before stays until then.
pub(super) struct PartialFile {
    place: PathBuf,
    beside: PathBuf,
    committed: bool,
}

impl PartialFile {
    /// Creates the file, empty, together with a writer for it.
    pub(super) fn create(path: &Path) -> Result<(Self, BufWriter<File>), FilmError> {
        let refused = |reason| FilmError::NotWritable { path: path.to_owned(), reason };
        // A link is followed: its target is replaced, not the link.
        let place = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let beside = name_beside(&place);
        let file = OpenOptions::new().write(true).create_new(true).open(&beside).map_err(refused)?;
        Ok((Self { place, beside, committed: false }, BufWriter::new(file)))
    }

    /// Fills a file beside `path`; an encoder's complaint is an [`FilmError::Encode`].
    pub(super) fn fill<E: std::fmt::Display>(
        path: &Path,
        encode: impl FnOnce(&mut BufWriter<File>) -> Result<(), E>,
    ) -> Result<Self, FilmError> {
        let (partial, mut writer) = Self::create(path)?;
        let failed = |reason: String| FilmError::Encode { path: path.to_owned(), reason };
        encode(&mut writer).map_err(|reason| failed(reason.to_string()))?;
        let refused = |reason: IoError| FilmError::NotWritable { path: path.to_owned(), reason };
        writer.flush().map_err(refused)?;
        // On the disk before it takes the old file's place: a power cut must not leave neither.
        writer.get_ref().sync_all().map_err(refused)?;
        Ok(partial)
    }

    /// Puts the complete file in its place.
    pub(super) fn commit(mut self) -> Result<(), FilmError> {
        let refused = |reason| FilmError::NotWritable { path: self.place.clone(), reason };
        fs::rename(&self.beside, &self.place).map_err(refused)?;
        self.committed = true;
        Ok(())
    }
}

impl Drop for PartialFile {
    fn drop(&mut self) {
        if !self.committed {
            // Nobody is left to tell; what stays behind is a hidden file that says it is partial.
            let _ = fs::remove_file(&self.beside);
        }
    }
}

/// A name in the same folder, so that renaming is one step, that no other run and no other file of this run uses.
fn name_beside(place: &Path) -> PathBuf {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let number = COUNT.fetch_add(1, Ordering::Relaxed);
    let name = place.file_name().unwrap_or_default().to_string_lossy();
    place.with_file_name(format!(".{name}.{}-{number}.partial", std::process::id()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("a folder");
        entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect()
    }

    #[test]
    fn a_failure_halfway_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("out.png");
        fs::write(&path, "old").expect("written");
        let result = PartialFile::fill(&path, |writer| {
            writer.write_all(&[0; 100_000]).expect("written");
            Err("the encoder broke")
        });
        let message = result.err().expect("failed").to_string();
        assert!(message.contains("out.png") && message.contains("the encoder broke"), "{message}");
        assert_eq!(fs::read_to_string(&path).expect("still there"), "old");
        assert_eq!(names(folder.path()), ["out.png"]);
    }

    #[test]
    fn the_old_file_stays_until_the_new_one_is_committed() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("out.png");
        fs::write(&path, "old").expect("written");
        let partial = PartialFile::fill(&path, |writer| writer.write_all(b"new")).expect("filled");
        assert_eq!(fs::read_to_string(&path).expect("there"), "old");
        partial.commit().expect("renamed");
        assert_eq!(fs::read_to_string(&path).expect("there"), "new");
        assert_eq!(names(folder.path()), ["out.png"]);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_a_link() {
        let folder = tempfile::tempdir().expect("a folder");
        let (target, link) = (folder.path().join("target.png"), folder.path().join("link.png"));
        fs::write(&target, "old").expect("written");
        std::os::unix::fs::symlink(&target, &link).expect("linked");
        PartialFile::fill(&link, |writer| writer.write_all(b"new"))
            .expect("filled")
            .commit()
            .expect("renamed");
        assert_eq!(fs::read_to_string(&target).expect("there"), "new");
        assert!(fs::symlink_metadata(&link).expect("there").is_symlink());
    }
}
