//! The JSON text: parsed into types, with line and column where it does not fit.

use crate::SceneError;
use gltf::json::Root;
use serde::Deserialize;
use std::path::Path;

/// Most names that are kept per mesh.
const MAX_NAMES: usize = 10_000;

/// Parses the document. Nesting deeper than 128 is an error of the parser, so no stack can overflow.
pub(super) fn parse(json: &[u8], file: &Path) -> Result<Root, SceneError> {
    serde_json::from_slice(json).map_err(|e| {
        let place = format!("JSON line {}, column {}", e.line(), e.column());
        // The library repeats the place at the end of its message.
        let text = e.to_string();
        let reason = text.split(" at line ").next().unwrap_or(&text);
        SceneError::new(file, place, reason)
    })
}

/// The part of the document in which exporters keep the names of morph targets.
#[derive(Deserialize, Default)]
struct Named {
    #[serde(default)]
    meshes: Vec<NamedMesh>,
}

#[derive(Deserialize, Default)]
struct NamedMesh {
    #[serde(default)]
    extras: Option<serde_json::Value>,
}

/// `extras.targetNames` of each mesh; empty where there are none or they are something else.
pub(super) fn target_names(root: &Root, json: &[u8]) -> Vec<Vec<String>> {
    let any = root.meshes.iter().flat_map(|mesh| &mesh.primitives).any(|p| p.targets.is_some());
    if !any {
        return Vec::new();
    }
    let named: Named = serde_json::from_slice(json).unwrap_or_default();
    named.meshes.iter().map(|mesh| names(mesh).unwrap_or_default()).collect()
}

fn names(mesh: &NamedMesh) -> Option<Vec<String>> {
    let list = mesh.extras.as_ref()?.get("targetNames")?.as_array()?;
    Some(list.iter().take(MAX_NAMES).map(|name| name.as_str().unwrap_or_default().to_owned()).collect())
}
