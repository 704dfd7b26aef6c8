//! Files that are written completely or not at all.

use miette::{Result, miette};
use std::fs;
use std::io::Write;
use std::path::Path;

/// Writes beside the final place and renames; whatever was there stays until then.
pub fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    let refused = |reason: std::io::Error| miette!("{}: cannot be written: {reason}", path.display());
    // A link is followed: its target is replaced, not the link.
    let place = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let name = place.file_name().unwrap_or_default().to_string_lossy();
    let beside = place.with_file_name(format!(".{name}.{}.partial", std::process::id()));
    let written = fill(&beside, bytes).and_then(|()| fs::rename(&beside, &place));
    if written.is_err() {
        // Nobody is left to tell; what stays behind is a hidden file that says it is partial.
        let _ = fs::remove_file(&beside);
    }
    written.map_err(refused)
}

/// Refuses a place that nothing can be written to, before the work.
pub fn check(path: &Path) -> Result<()> {
    if path.is_dir() {
        return Err(miette!("{}: is a folder", path.display()));
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    match folder {
        Some(folder) if !folder.is_dir() => {
            Err(miette!("{}: there is no folder {}", path.display(), folder.display()))
        }
        _ => Ok(()),
    }
}

fn fill(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let mut file = fs::OpenOptions::new().write(true).create_new(true).open(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_old_file_goes_when_the_new_one_is_complete() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.json");
        write(&path, b"old").and_then(|()| write(&path, b"new")).expect("written");
        assert_eq!(fs::read(&path).expect("there"), b"new");
        assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 1);
    }

    #[test]
    fn impossible_places_are_refused_and_nothing_stays_behind() {
        let folder = tempfile::tempdir().expect("a folder");
        assert!(check(folder.path()).is_err() && check(&folder.path().join("no/a.json")).is_err());
        let within = folder.path().join("sub");
        fs::create_dir(&within).expect("made");
        let error = write(&within, b"x").expect_err("a folder is there").to_string();
        assert!(error.contains("sub"), "{error}");
        assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 1);
    }
}
