//! Scene files in TOML: one mesh, its material, lights, a camera and a pose. Every key is known, every number checked, and
//! every error names the line.

mod camera;
mod keys;
mod light;
mod material;
mod pose;

use super::file::{Folder, read_bytes};
use super::textures::Textures;
use super::{AtlasChoice, CameraChoice, Parts, Piece, ReadOptions, Textured, read_mesh_file};
use crate::head::{HeadDetail, built_in};
use crate::{MeshOrigin, SceneError};
use keys::{Keys, Source};
use std::path::{Path, PathBuf};
use toml::de::DeTable;

pub(super) use camera::CameraKeys;
pub(super) use pose::PoseKeys;

/// Largest scene file, bytes: honest ones have one thousand.
const MAX_BYTES: usize = 1 << 20;

/// What the files of a scene are read with.
struct Context<'a> {
    folder: Folder,
    textures: Textures,
    options: &'a ReadOptions,
    warnings: Vec<String>,
}

/// Where the mesh comes from.
enum MeshSource {
    /// A file, and the options it is read with.
    File(PathBuf, ReadOptions),
    /// The head made by code.
    BuiltInHead(HeadDetail),
}

/// Reads a scene file and the mesh it names.
pub(super) fn read(path: &Path, options: &ReadOptions) -> Result<Parts, SceneError> {
    let bytes = read_bytes(path, "whole file")?;
    if bytes.len() > MAX_BYTES {
        let reason = format!("has {} bytes; a scene file has at most {MAX_BYTES}", bytes.len());
        return Err(SceneError::new(path, "whole file", reason));
    }
    let text = std::str::from_utf8(&bytes).map_err(|e| {
        let line = 1 + bytes[..e.valid_up_to()].iter().filter(|&&b| b == b'\n').count();
        SceneError::new(path, format!("line {line}"), "is not text in UTF-8")
    })?;
    let source = Source { file: path, text };
    let table = DeTable::parse(text).map_err(|e| {
        let line = e.span().map_or(1, |span| source.line(span.start));
        SceneError::new(path, format!("line {line}"), e.message())
    })?;
    let folder = Folder::of(path, options.assets_folder.as_deref());
    let context = Context { folder, textures: Textures::default(), options, warnings: Vec::new() };
    to_parts(&Keys::root(source, &table), context)
}

fn to_parts(root: &Keys, mut context: Context) -> Result<Parts, SceneError> {
    root.only(&["mesh", "material", "light", "camera", "pose"])?;
    let Some(mesh) = root.table("mesh")? else {
        return Err(root.error("mesh", "is missing: a scene needs [mesh] with `path` or `builtin`"));
    };
    // What is small and cheap is checked before a large mesh is read.
    let camera = root.table("camera")?.map(|keys| camera::read(&keys)).transpose()?;
    let pose = root.table("pose")?.map(|keys| pose::read(&keys)).transpose()?;
    let mesh_source = mesh_source(&mesh, &context)?;
    let lights = light::read_all(root, &mut context)?;
    let mut parts = load(mesh_source)?;
    for (keys, piece) in materials(root, parts.pieces.len())?.iter().zip(&mut parts.pieces) {
        let change = material::read(keys, &piece.own_material, &mut context)?;
        change.apply(&mut piece.material);
    }
    parts.dark = lights.any && lights.lights.is_empty() && lights.environment.is_none();
    if lights.any {
        parts.lights = lights.lights;
        parts.environment = lights.environment;
    }
    if let Some(camera) = camera {
        parts.background = camera.background();
        parts.camera = CameraChoice::Partial(camera);
    }
    parts.pose = pose;
    parts.warnings.append(&mut context.warnings);
    Ok(parts)
}

/// The table of every object's material: `[material]` for all of them, or one `[[material]]` for each, in the order of the
/// mesh file.
fn materials<'a>(root: &Keys<'a>, objects: usize) -> Result<Vec<Keys<'a>>, SceneError> {
    match root.kind("material") {
        None => Ok(Vec::new()),
        Some("array") => {
            let tables = root.tables("material")?;
            if tables.len() != objects {
                let reason =
                    format!("{} materials for {objects} objects; one for each, or [material]", tables.len());
                return Err(root.error("material", reason));
            }
            Ok(tables)
        }
        Some(_) => (0..objects).filter_map(|_| root.table("material").transpose()).collect(),
    }
}

/// Reads `[mesh]`.
fn mesh_source(keys: &Keys, context: &Context) -> Result<MeshSource, SceneError> {
    keys.only(&["path", "builtin", "triangles", "map_size", "millimetres_per_unit", "flip_v", "atlas"])?;
    let mm = keys.number_in("millimetres_per_unit", f32::MIN_POSITIVE..=1e6)?;
    let flip_v = keys.boolean("flip_v")?.unwrap_or(false);
    let atlas = keys.string("atlas")?.map(|name| atlas_choice(keys, name)).transpose()?;
    if keys.has("builtin") && context.options.atlas.or(atlas) == Some(AtlasChoice::New) {
        return Err(
            keys.error("builtin", "the built-in head has an atlas of its own; `new` is for mesh files")
        );
    }
    for key in ["triangles", "map_size"] {
        if keys.has("path") && keys.has(key) {
            return Err(keys.error(key, "is for the built-in head; a mesh file has what it has"));
        }
    }
    match (keys.string("path")?, keys.string("builtin")?) {
        (Some(_), Some(_)) => Err(keys.error("builtin", "stands beside `path`; only one can be the mesh")),
        (None, None) => Err(keys.error("path", "is missing: [mesh] needs `path` or `builtin`")),
        (None, Some("head")) => head_detail(keys).map(MeshSource::BuiltInHead),
        (None, Some(other)) => Err(keys.error("builtin", format!("`{other}` is not known; `head` is"))),
        (Some(text), None) => {
            let path = context.folder.resolve(text).map_err(|reason| keys.error("path", reason))?;
            let options = ReadOptions {
                millimetres_per_unit: context.options.millimetres_per_unit.or(mm),
                flip_v: flip_v != context.options.flip_v,
                atlas: context.options.atlas.or(atlas),
                ..ReadOptions::default()
            };
            Ok(MeshSource::File(path, options))
        }
    }
}

fn atlas_choice(keys: &Keys, name: &str) -> Result<AtlasChoice, SceneError> {
    let known = AtlasChoice::ALL.into_iter().find(|choice| choice.name() == name);
    known.ok_or_else(|| keys.error("atlas", format!("`{name}` is not known; `own` and `new` are")))
}

/// How fine the built-in head is.
fn head_detail(keys: &Keys) -> Result<HeadDetail, SceneError> {
    let HeadDetail { triangles, map_size } = HeadDetail::default();
    // Single precision counts these exactly.
    let count = |key, limits| Ok::<_, SceneError>(keys.number_in(key, limits)?.map(|count| count as u32));
    Ok(HeadDetail {
        triangles: count("triangles", 1000.0..=4_000_000.0)?.map_or(triangles, |count| count as usize),
        map_size: count("map_size", 0.0..=8192.0)?.unwrap_or(map_size),
    })
}

/// The objects of the mesh, with whatever else its file has.
fn load(source: MeshSource) -> Result<Parts, SceneError> {
    match source {
        MeshSource::File(path, options) => read_mesh_file(&path, &options),
        MeshSource::BuiltInHead(detail) => Ok(built_in_head(detail)),
    }
}

/// The built-in head as the mesh of a scene.
fn built_in_head(detail: HeadDetail) -> Parts {
    let head = built_in(detail);
    let piece = Piece {
        name: head.name,
        place: "built-in head".to_owned(),
        mesh: head.mesh,
        textured: Textured::Whole,
        own_material: head.material.clone(),
        material: head.material,
    };
    let origin = Some(MeshOrigin::BuiltInHead(detail));
    Parts { pieces: vec![piece], origin, ..Parts::default() }
}
