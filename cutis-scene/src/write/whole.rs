//! Files that are written completely or not at all.

use crate::SceneError;
use std::fs;
use std::io::Write;
use std::path::Path;

/// Writes beside the final place and renames when all is there; whatever was there stays until then.
pub(super) fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), SceneError> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let beside = path.with_file_name(format!(".{name}.{}.partial", std::process::id()));
    let written = fill(&beside, bytes).and_then(|()| fs::rename(&beside, path));
    written.map_err(|reason| {
        // Nobody is left to tell; what stays behind is a hidden file that says it is partial.
        drop(fs::remove_file(&beside));
        SceneError::new(path, "whole file", format!("cannot be written: {reason}"))
    })
}

fn fill(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let mut file = fs::OpenOptions::new().write(true).create_new(true).open(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}
