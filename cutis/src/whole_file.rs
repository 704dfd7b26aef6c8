//! Files that are written completely or not at all.

use miette::{Report, Result, miette};
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Writes beside the final places and renames when all are complete; whatever was there stays until then.
pub fn write_all(files: &[(&Path, &[u8])]) -> Result<()> {
    let staged: Vec<(PathBuf, PathBuf)> = files.iter().map(|(path, _)| staged(path)).collect();
    let filled = staged
        .iter()
        .zip(files)
        .try_for_each(|((beside, _), (path, bytes))| fill(beside, bytes).map_err(refused(path)));
    let written = filled.and_then(|()| {
        let mut pairs = staged.iter().zip(files);
        pairs.try_for_each(|((beside, place), (path, _))| fs::rename(beside, place).map_err(refused(path)))
    });
    if written.is_err() {
        // Nobody is left to tell; what stays behind is a hidden file that says it is partial.
        staged.iter().for_each(|(beside, _)| drop(fs::remove_file(beside)));
    }
    written
}

fn refused(path: &Path) -> impl FnOnce(io::Error) -> Report {
    move |reason| miette!("{}: cannot be written: {reason}", path.display())
}

/// The hidden neighbour that is filled first, and the final place.
fn staged(path: &Path) -> (PathBuf, PathBuf) {
    // A link is followed: its target is replaced, not the link.
    let place = place(path);
    let name = place.file_name().unwrap_or_default().to_string_lossy().into_owned();
    (place.with_file_name(format!(".{name}.{}.partial", std::process::id())), place)
}

/// Where a path leads, links followed, whether or not there is a file yet.
fn place(path: &Path) -> PathBuf {
    let of_folder = || {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let folder = fs::canonicalize(folder.unwrap_or(Path::new("."))).ok()?;
        Some(folder.join(path.file_name()?))
    };
    fs::canonicalize(path).ok().or_else(of_folder).unwrap_or_else(|| path.to_owned())
}

/// Refuses two paths that lead to one file.
pub fn check_distinct(paths: &[&Path]) -> Result<()> {
    for (i, path) in paths.iter().enumerate() {
        if let Some(before) = paths[..i].iter().find(|before| place(before) == place(path)) {
            return Err(miette!(
                "{} and {} are one file: each output needs a place of its own",
                before.display(),
                path.display()
            ));
        }
    }
    Ok(())
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
        write_all(&[(&path, b"old")]).and_then(|()| write_all(&[(&path, b"new")])).expect("written");
        assert_eq!(fs::read(&path).expect("there"), b"new");
        assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 1);
    }

    #[test]
    fn of_several_files_all_are_written_or_none() {
        let folder = tempfile::tempdir().expect("a folder");
        let [good, bad] = ["a.json", "no/b.json"].map(|name| folder.path().join(name));
        assert!(write_all(&[(&good, b"x"), (&bad, b"y")]).is_err());
        assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 0);
    }

    #[test]
    fn one_file_by_two_names_is_seen() {
        let folder = tempfile::tempdir().expect("a folder");
        let [plain, around, other] = ["a", "./a", "b"].map(|name| folder.path().join(name));
        assert!(check_distinct(&[&plain, &other]).is_ok());
        let error = check_distinct(&[&plain, &other, &around]).expect_err("the same").to_string();
        assert!(error.contains("are one file"), "{error}");
    }

    #[test]
    fn impossible_places_are_refused_and_nothing_stays_behind() {
        let folder = tempfile::tempdir().expect("a folder");
        assert!(check(folder.path()).is_err() && check(&folder.path().join("no/a.json")).is_err());
        let within = folder.path().join("sub");
        fs::create_dir(&within).expect("made");
        let error = write_all(&[(&within, b"x")]).expect_err("a folder is there").to_string();
        assert!(error.contains("sub"), "{error}");
        assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 1);
    }
}
