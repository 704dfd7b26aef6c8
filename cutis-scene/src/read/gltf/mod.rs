//! glTF 2.0 and GLB: every mesh that the scene's nodes show, with skins and their joints, morph targets, materials,
//! punctual lights and the first perspective camera.
//!
//! The JSON is read into the types of the `gltf` crate, but nothing else of that crate is used: its validation and
//! its readers index before they check. Here every index goes through a checked look-up whose error names the place.
//!
//! Lengths are metres unless the caller says otherwise. `KHR_lights_punctual` speaks of candela and lux; they are taken
//! one to one as W/sr and W/m², since the picture is only known up to its exposure. Not read: animations, vertex
//! colours, emission, metalness, occlusion, sampler wrapping (textures repeat), compressed meshes and textures.

mod accessor;
mod container;
mod light;
mod material;
pub(super) mod neighbours;
mod nodes;
mod primitive;
mod skeleton;
mod skin;
mod text;
mod uri;

use super::textures::Textures;
use super::{CameraChoice, Parts, ReadOptions, file::Folder};
use crate::SceneError;
use accessor::Accessors;
use gltf::json::{Index, Root};
use primitive::Gathering;
use std::path::Path;

/// Length of glTF's unit, mm.
const METRE_MM: f32 = 1000.0;

/// Extensions that a file may require and that are honoured.
const EXTENSIONS: [&str; 4] =
    ["KHR_lights_punctual", "KHR_texture_transform", "KHR_materials_ior", "KHR_materials_specular"];

/// A parsed document with its bytes.
struct Document<'a> {
    file: &'a Path,
    root: Root,
    accessors: Accessors<'a>,
    folder: Folder,
    mm_per_unit: f32,
    flip_v: bool,
    /// Names of the morph targets, which the typed JSON leaves out.
    target_names: Vec<Vec<String>>,
}

impl Document<'_> {
    fn fail<T>(&self, place: impl Into<String>, reason: impl Into<String>) -> Result<T, SceneError> {
        Err(SceneError::new(self.file, place, reason))
    }

    /// The thing an index names, or an error that says who named it.
    fn get<'r, T>(&self, list: &'r [T], index: Index<T>, place: &str) -> Result<&'r T, SceneError> {
        let reason = || format!("names number {}, but there are {}", index.value(), list.len());
        list.get(index.value()).ok_or_else(|| SceneError::new(self.file, place, reason()))
    }
}

/// Reads the bytes of a glTF or GLB file.
pub(super) fn read(bytes: &[u8], file: &Path, options: &ReadOptions) -> Result<Parts, SceneError> {
    let container::Container { json, binary } = container::split(bytes, file)?;
    let root: Root = text::parse(json, file)?;
    check_head(&root, file)?;
    let folder = Folder::of(file, None);
    let accessors = Accessors::load(&root, binary, &folder, file)?;
    let document = Document {
        file,
        accessors,
        folder,
        mm_per_unit: options.millimetres_per_unit.unwrap_or(METRE_MM),
        flip_v: options.flip_v,
        target_names: text::target_names(&root, json),
        root,
    };
    gather(&document)
}

/// Version and required extensions.
fn check_head(root: &Root, file: &Path) -> Result<(), SceneError> {
    if !root.asset.version.starts_with("2.") {
        let reason = format!("is `{}`; version 2 is read", root.asset.version);
        return Err(SceneError::new(file, "asset.version", reason));
    }
    match root.extensions_required.iter().find(|name| !EXTENSIONS.contains(&name.as_str())) {
        Some(name) => {
            let reason = format!("requires `{name}`, which is not supported; export the file without it");
            Err(SceneError::new(file, "extensionsRequired", reason))
        }
        None => Ok(()),
    }
}

/// Everything the scene's nodes show.
fn gather(document: &Document) -> Result<Parts, SceneError> {
    let world = nodes::world_transforms(document)?;
    let shown = nodes::shown(document)?;
    let mut gathering = Gathering::default();
    let mut parts = Parts::default();
    for &index in &shown {
        let node = &document.root.nodes[index];
        let place = format!("nodes[{index}]");
        if let Some(mesh) = node.mesh {
            gathering.add_node(document, &world, index, mesh, &mut parts.warnings)?;
        }
        if let Some(light) = light::of_node(document, node, world[index], &place)? {
            parts.lights.push(light);
        }
        if matches!(parts.camera, CameraChoice::Framing)
            && let Some(camera) = light::camera_of_node(document, node, world[index], &place)?
        {
            parts.camera = CameraChoice::Fixed(camera);
        }
    }
    let mut textures = Textures::default();
    parts.pieces = gathering.into_pieces(document, &mut textures, &mut parts.warnings)?;
    if parts.pieces.is_empty() {
        return document.fail("scene", "shows no mesh with triangles");
    }
    Ok(parts)
}
