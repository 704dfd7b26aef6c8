//! Files on disk: read whole, after their kind and size are known, and only from folders a scene may see.

use crate::SceneError;
use std::fs::File;
use std::io::Read;
use std::path::{Component, Path, PathBuf};

/// Largest file that is read, bytes.
const MAX_FILE_BYTES: u64 = 2 << 30;

/// Environment variable that names the shelf of shared assets.
const ASSETS_VARIABLE: &str = "CUTIS_ASSETS";

/// Where the shelf is looked for if nobody says.
const ASSETS_DEFAULT: &str = "../shared/assets";

/// The whole content of a regular file. `place` says who asked for it.
pub(crate) fn read_bytes(path: &Path, place: &str) -> Result<Vec<u8>, SceneError> {
    let fail = |reason: String| SceneError::new(path, place, reason);
    // Asked before opening: a pipe would block, a device would never end.
    let metadata = std::fs::metadata(path).map_err(|e| fail(format!("cannot be opened: {e}")))?;
    if !metadata.is_file() {
        let kind = if metadata.is_dir() { "a folder" } else { "not a regular file" };
        return Err(fail(format!("is {kind}; a file is needed")));
    }
    if metadata.len() > MAX_FILE_BYTES {
        return Err(fail(format!("has {} bytes; at most {MAX_FILE_BYTES} are read", metadata.len())));
    }
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(|e| fail(format!("cannot be opened: {e}")))?;
    file.take(MAX_FILE_BYTES).read_to_end(&mut bytes).map_err(|e| fail(format!("cannot be read: {e}")))?;
    Ok(bytes)
}

/// The folders that the files named by one document may lie in.
#[derive(Debug, Clone)]
pub(crate) struct Folder {
    /// The document's own folder.
    own: PathBuf,
    /// The shelf, where the caller says so.
    assets: Option<PathBuf>,
}

impl Folder {
    /// The folder of `document`; `assets` overrides the environment.
    pub(crate) fn of(document: &Path, assets: Option<&Path>) -> Self {
        let parent = document.parent().filter(|p| !p.as_os_str().is_empty());
        Self { own: parent.unwrap_or(Path::new(".")).to_owned(), assets: assets.map(Path::to_owned) }
    }

    /// The file that `text` names, or why it may not be opened.
    pub(crate) fn resolve(&self, text: &str) -> Result<PathBuf, String> {
        match text.strip_prefix("assets:") {
            Some(rest) => inside(&assets_folder(self.assets.as_deref())?, rest, "the assets folder"),
            None => inside(&self.own, text, "the folder of the file that names it"),
        }
    }
}

/// The file a person named on the command line: any path, or one on the shelf.
pub(crate) fn resolve_for_user(path: &Path, assets: Option<&Path>) -> Result<PathBuf, SceneError> {
    match path.to_str().and_then(|text| text.strip_prefix("assets:")) {
        Some(rest) => assets_folder(assets)
            .and_then(|folder| inside(&folder, rest, "the assets folder"))
            .map_err(|reason| SceneError::new(path, "path", reason)),
        None => Ok(path.to_owned()),
    }
}

/// A file on the shelf, or why it is not there.
pub(crate) fn asset(name: &str) -> Result<PathBuf, String> {
    let words = |reason| format!("assets:{name}: {reason}");
    assets_folder(None).and_then(|folder| inside(&folder, name, "the assets folder")).map_err(words)
}

/// The shelf: as given, as the environment says, or at its usual place.
pub(crate) fn assets_folder(given: Option<&Path>) -> Result<PathBuf, String> {
    if let Some(folder) = given {
        return Ok(folder.to_owned());
    }
    if let Some(folder) = std::env::var_os(ASSETS_VARIABLE).filter(|value| !value.is_empty()) {
        return Ok(PathBuf::from(folder));
    }
    let usual = PathBuf::from(ASSETS_DEFAULT);
    if usual.is_dir() {
        return Ok(usual);
    }
    Err(format!("there is no assets folder; set {ASSETS_VARIABLE} to it"))
}

/// `text` below `root`, symbolic links followed, or a refusal.
fn inside(root: &Path, text: &str, root_words: &str) -> Result<PathBuf, String> {
    if text.is_empty() || text.contains('\0') {
        return Err("the path is empty or holds a zero byte".to_owned());
    }
    let relative = Path::new(text);
    // Refused before the file system is asked, so that a scene cannot probe what exists elsewhere.
    if !stays_below(relative) {
        return Err(format!("`{text}` leads out of {root_words}; that is not allowed"));
    }
    let root = root.canonicalize().map_err(|e| format!("{root_words} ({}): {e}", root.display()))?;
    let found = root.join(relative).canonicalize().map_err(|e| format!("`{text}` cannot be opened: {e}"))?;
    if !found.starts_with(&root) {
        return Err(format!("`{text}` is a link that leads out of {root_words}; that is not allowed"));
    }
    if !found.is_file() {
        return Err(format!("`{text}` is not a regular file"));
    }
    Ok(found)
}

/// Whether a path, read as text, is relative and never climbs above its start.
fn stays_below(path: &Path) -> bool {
    let mut depth = 0i32;
    for component in path.components() {
        match component {
            Component::Normal(_) => depth += 1,
            Component::CurDir => {}
            Component::ParentDir => depth -= 1,
            Component::RootDir | Component::Prefix(_) => return false,
        }
        if depth < 0 {
            return false;
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_that_climb_out_are_seen_without_touching_the_disk() {
        for (path, stays) in
            [("a/b", true), ("./a/../b", true), ("../a", false), ("a/../../b", false), ("/etc/passwd", false)]
        {
            assert_eq!(stays_below(Path::new(path)), stays, "{path}");
        }
    }
}
