//! Files beside a glTF file without which it cannot be read.

use super::{container, text, uri};
use crate::SceneError;
use crate::read::file::{Folder, read_bytes};
use gltf::json::Root;
use std::path::{Path, PathBuf};

/// The files that a glTF or GLB file names, by the path it names them with; none of any other file.
pub(crate) fn gltf_neighbours(file: &Path) -> Result<Vec<(PathBuf, PathBuf)>, SceneError> {
    if !matches!(crate::read::extension(file).as_str(), "gltf" | "glb") {
        return Ok(Vec::new());
    }
    let bytes = read_bytes(file, "whole file")?;
    let root: Root = text::parse(container::split(&bytes, file)?.json, file)?;
    let folder = Folder::of(file, None);
    let own = file.parent().and_then(|own| own.canonicalize().ok()).unwrap_or_default();
    let uris = root.buffers.iter().filter_map(|b| b.uri.as_ref());
    let mut found = Vec::new();
    for name in uris.chain(root.images.iter().filter_map(|i| i.uri.as_ref())) {
        if let uri::Target::File(path) = uri::target(name, &folder, file, "uri")? {
            // Resolved before, so it lies below the file's own folder.
            found.push((path.strip_prefix(&own).map_or(path.clone(), Path::to_owned), path));
        }
    }
    Ok(found)
}
