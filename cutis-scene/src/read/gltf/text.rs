//! The JSON text: parsed into types, with line and column where it does not fit.

use crate::SceneError;
use gltf::json::Root;
use serde::Deserialize;
use serde_json::Value;
use std::path::Path;

/// Most names that are kept per mesh.
const MAX_NAMES: usize = 10_000;

/// Parses the document. Nesting deeper than 128 is an error of the parser, so no stack can overflow.
pub(super) fn parse(json: &[u8], file: &Path) -> Result<Root, SceneError> {
    let first = match serde_json::from_slice(json) {
        Ok(root) => return Ok(root),
        Err(error) => error,
    };
    // `extras` may hold anything, but the typed JSON only passes over objects.
    if first.is_data()
        && let Ok(mut value) = serde_json::from_slice(json)
    {
        remove_extras(&mut value);
        if let Ok(root) = serde_json::from_value(value) {
            return Ok(root);
        }
    }
    let place = format!("JSON line {}, column {}", first.line(), first.column());
    // The library repeats the place at the end of its message.
    let text = first.to_string();
    let reason = text.split(" at line ").next().unwrap_or(&text);
    Err(SceneError::new(file, place, reason))
}

/// Takes the application's own data out of a document. The depth is that of the parser, at most 128.
fn remove_extras(value: &mut Value) {
    match value {
        Value::Array(list) => list.iter_mut().for_each(remove_extras),
        Value::Object(map) => {
            map.remove("extras");
            map.values_mut().for_each(remove_extras);
        }
        _ => {}
    }
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
    extras: Option<Value>,
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
