//! Readers: from files that nobody vouches for to a [`crate::Scene`] that can be believed.
//!
//! Every size a file claims is checked before memory is asked for, every index before it is used, and every error is
//! one line that names the file, the place in it and the reason. Guesses end up in [`Scene::warnings`].

mod atlas;
mod checks;
mod file;
mod finish;
mod gltf;
mod image;
mod obj;
mod scene_file;
mod textures;

use crate::{Camera, Environment, Light, Material, Mesh, MeshOrigin, Scene, SceneError};
use std::path::{Path, PathBuf};

pub(crate) use file::{asset, assets_folder, read_bytes};
pub(crate) use gltf::neighbours::gltf_neighbours;
pub use image::{ColourSpace, PictureFile, read_image, read_picture};

/// What the caller knows better than the file, mostly from the command line.
#[derive(Debug, Clone, Default)]
pub struct ReadOptions {
    /// Length of the mesh file's unit in mm; goes before what a scene file says. Left out: 1000 for glTF, a guess with
    /// a warning for OBJ.
    pub millimetres_per_unit: Option<f32>,
    /// Turns v around against the convention of the format: for files whose textures stand on their heads.
    pub flip_v: bool,
    /// Diffuse colour texture for all objects.
    pub albedo: Option<PathBuf>,
    /// Tangent-space normal map for all objects.
    pub normal: Option<PathBuf>,
    /// Map of specular intensity for all objects: `rho_s = pi (0.18 + 0.16 red)`.
    pub specular: Option<PathBuf>,
    /// Folder that `assets:` stands for; goes before the environment variable `CUTIS_ASSETS`.
    pub assets_folder: Option<PathBuf>,
    /// Where light lies; goes before what a scene file says.
    pub atlas: Option<AtlasChoice>,
    /// Folder where atlases that were made are kept; left out: they are made anew every time.
    pub cache_folder: Option<PathBuf>,
    /// Who is told how far work that takes long is, in words.
    pub tell: Option<fn(&str)>,
}

/// Where light lies, which needs every place of a surface once.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AtlasChoice {
    /// Where the mesh's texture coordinates say, if they can carry it; else in an atlas that is made.
    #[default]
    Own,
    /// In an atlas that is made, with even texels: where the mesh's own are slivers, light spreads too slowly.
    New,
}

impl AtlasChoice {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Own, Self::New];

    /// The name in scene files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Own => "own",
            Self::New => "new",
        }
    }
}

/// Before the place of an image in the material that the mesh itself brings.
pub(crate) const MESH_PREFIX: &str = "mesh:";

/// Reads a scene by the extension of its file: `.toml`, `.obj`, `.gltf` or `.glb`. The path may begin with `assets:`.
///
/// Files that a scene or glTF file names must lie in its own folder (or under `assets:` in a scene file); the paths
/// in `options` are the caller's own and may lie anywhere.
pub fn read_scene(path: &Path, options: &ReadOptions) -> Result<Scene, SceneError> {
    let path = &file::resolve_for_user(path, options.assets_folder.as_deref())?;
    let parts = match extension(path).as_str() {
        "toml" => scene_file::read(path, options)?,
        _ => read_mesh_file(path, options)?,
    };
    finish::finish(parts, path, options)
}

/// What a file gives before it is checked and completed.
#[derive(Default)]
struct Parts {
    pieces: Vec<Piece>,
    /// Where all pieces came from.
    origin: Option<MeshOrigin>,
    /// Where their light lies.
    atlas: AtlasChoice,
    lights: Vec<Light>,
    environment: Option<Environment>,
    /// Whether a scene without light is meant to have none.
    dark: bool,
    camera: CameraChoice,
    background: Option<glam::Vec3>,
    pose: Option<scene_file::PoseKeys>,
    warnings: Vec<String>,
}

/// What a file says about the camera.
#[derive(Default)]
enum CameraChoice {
    /// Nothing: show everything from the front.
    #[default]
    Framing,
    /// All of it.
    Fixed(Camera),
    /// Some of it; the rest follows from the bounds of the scene.
    Partial(scene_file::CameraKeys),
}

/// How much of a mesh has texture coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Textured {
    Whole,
    Partly,
    Not,
}

impl Textured {
    fn new(some_have: bool, some_lack: bool) -> Self {
        match (some_have, some_lack) {
            (_, false) => Self::Whole,
            (true, true) => Self::Partly,
            (false, true) => Self::Not,
        }
    }
}

/// One mesh with its material, on its way to become an object.
struct Piece {
    name: String,
    /// Where in the file it stands, for messages.
    place: String,
    mesh: Mesh,
    /// What of it has texture coordinates in the file; the rest lies at the corner of the texture.
    textured: Textured,
    /// What it is made of in the end.
    material: Material,
    /// What it is made of by its own file.
    own_material: Material,
}

/// Reads the objects, and what else the format has, of a mesh file.
fn read_mesh_file(path: &Path, options: &ReadOptions) -> Result<Parts, SceneError> {
    if let Some(mm) = options.millimetres_per_unit
        && !(mm > 0.0 && mm.is_finite())
    {
        return Err(SceneError::new(path, "millimetres_per_unit", format!("must be above 0, got {mm}")));
    }
    let extension = extension(path);
    let mut parts = match extension.as_str() {
        "obj" => obj::read(&file::read_bytes(path, "whole file")?, path, options)?,
        "gltf" | "glb" => gltf::read(&file::read_bytes(path, "whole file")?, path, options)?,
        other => {
            let reason = format!("`.{other}` is not known; .toml, .obj, .gltf and .glb are");
            return Err(SceneError::new(path, "file name", reason));
        }
    };
    let ReadOptions { millimetres_per_unit, flip_v, atlas, .. } = *options;
    parts.atlas = atlas.unwrap_or_default();
    let atlas = parts.atlas;
    parts.origin = Some(MeshOrigin::File { path: path.to_owned(), millimetres_per_unit, flip_v, atlas });
    Ok(parts)
}

fn extension(path: &Path) -> String {
    path.extension().map_or(String::new(), |e| e.to_string_lossy().to_ascii_lowercase())
}
