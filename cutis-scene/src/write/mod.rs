//! Writers: a scene becomes a scene file that is read back as the same scene.
//!
//! A scene file may only name files below its own folder, or on the shelf of assets. What lies elsewhere is copied into a
//! folder beside it, called as the scene with `_files` behind; nothing that is there already is overwritten but the scene
//! file itself. The mesh is named, not written: shapes, joints and charts come back with it.

mod files;
mod light;
mod material;
mod text;
mod whole;

use crate::source::{MeshOrigin, ObjectSource};
use crate::{AtlasChoice, Camera, Pose, Scene, SceneError, Wave};
use files::Files;
use glam::Vec3;
use std::path::{Path, PathBuf};
use text::{degrees, number, quoted, vector};
use whole::write_whole;

/// Where a scene goes.
struct Destination {
    /// The scene file.
    scene: PathBuf,
    /// Its folder, links followed.
    folder: PathBuf,
    /// The folder for copies.
    files: PathBuf,
}

/// Writes a scene file, and copies of the files it needs where they lie out of its reach.
///
/// # Errors
/// If a mesh was not read from a file, if objects are missing or in another order than in their file, or if something
/// cannot be written. The scene file that was there stays then.
pub fn write_scene(scene: &Scene, path: &Path) -> Result<(), SceneError> {
    let destination = Destination::of(path)?;
    let mut files = Files::new(&destination);
    let text = document(scene, &destination, &mut files)?;
    write_whole(&destination.scene, text.as_bytes())
}

impl Destination {
    fn of(path: &Path) -> Result<Self, SceneError> {
        let fail = |reason: String| SceneError::new(path, "saving", reason);
        let (Some(name), Some("toml")) = (path.file_stem(), path.extension().and_then(|e| e.to_str())) else {
            return Err(fail("the name of a scene file ends in .toml".to_owned()));
        };
        let parent = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let folder = parent.canonicalize().map_err(|e| fail(format!("its folder cannot be used: {e}")))?;
        let scene = folder.join(path.file_name().unwrap_or_default());
        if scene.is_dir() {
            return Err(fail("is a folder".to_owned()));
        }
        let files = folder.join(format!("{}_files", name.to_string_lossy()));
        Ok(Self { scene, folder, files })
    }
}

fn document(scene: &Scene, destination: &Destination, files: &mut Files) -> Result<String, SceneError> {
    let sources = sources(scene, destination)?;
    let mut text = String::new();
    if scene.lights.is_empty() && scene.environment.is_none() {
        text += "light = []   # dark on purpose\n\n";
    }
    text += &mesh(&sources[0].origin, files)?;
    let mut materials = Vec::new();
    for (object, source) in scene.objects.iter().zip(&sources) {
        materials.push(material::keys(&object.material, source, files)?);
    }
    match &materials[..] {
        [first, rest @ ..] if rest.iter().all(|other| other == first) => {
            text += &format!("\n[material]\n{first}");
        }
        all => all.iter().for_each(|keys| text += &format!("\n[[material]]\n{keys}")),
    }
    text += &light::all(&scene.lights, scene.environment.as_ref(), files)?;
    text += &camera(&scene.camera, scene.background);
    text += &pose(&scene.pose());
    Ok(text)
}

/// Where each object came from: all of one origin, in its order.
fn sources<'a>(scene: &'a Scene, destination: &Destination) -> Result<Vec<&'a ObjectSource>, SceneError> {
    let fail = |reason: String| SceneError::new(&destination.scene, "mesh", reason);
    let mut sources: Vec<&ObjectSource> = Vec::new();
    for object in &scene.objects {
        let Some(source) = &object.source else {
            let reason = format!(
                "object `{}` was not read from a file, and a scene file only names meshes",
                object.name
            );
            return Err(fail(reason));
        };
        let fits = sources.first().is_none_or(|first| first.origin == source.origin);
        if !fits || source.number != sources.len() {
            let reason = format!("object `{}` stands at another place than in its mesh file", object.name);
            return Err(fail(reason));
        }
        sources.push(source);
    }
    match sources.first() {
        None => Err(fail("the scene has no objects".to_owned())),
        Some(first) if first.count != sources.len() => {
            let reason = format!("{} of the {} objects of its file are there", sources.len(), first.count);
            Err(fail(reason))
        }
        Some(_) => Ok(sources),
    }
}

fn mesh(origin: &MeshOrigin, files: &mut Files) -> Result<String, SceneError> {
    let mut text = "[mesh]\n".to_owned();
    let mut put = |key: &str, value: String| text += &format!("{key} = {value}\n");
    match origin {
        MeshOrigin::BuiltInHead(detail) => {
            put("builtin", quoted("head"));
            put("triangles", detail.triangles.to_string());
            put("map_size", detail.map_size.to_string());
        }
        MeshOrigin::File { path, millimetres_per_unit, flip_v, atlas } => {
            put("path", quoted(&files.name(path)?));
            if let Some(mm) = millimetres_per_unit {
                put("millimetres_per_unit", number(*mm));
            }
            if *flip_v {
                put("flip_v", "true".to_owned());
            }
            if *atlas != AtlasChoice::default() {
                put("atlas", quoted(atlas.name()));
            }
        }
    }
    Ok(text)
}

fn camera(camera: &Camera, background: Option<Vec3>) -> String {
    let mut text = "\n[camera]\n".to_owned();
    let mut put = |key: &str, value: String| text += &format!("{key} = {value}\n");
    put("position_mm", vector(camera.position_mm));
    put("look_at_mm", vector(camera.look_at_mm));
    if camera.up != Vec3::Y {
        put("up", vector(camera.up));
    }
    put("vertical_fov_degrees", degrees(camera.vertical_fov_rad));
    put("exposure_ev", number(camera.exposure_ev));
    if let Some(background) = background {
        put("background", vector(background));
    }
    text
}

fn pose(pose: &Pose) -> String {
    if pose.is_rest() {
        return String::new();
    }
    let mut text = "\n[pose]\n".to_owned();
    let mut put = |key: &str, value: String| text += &format!("{key} = {value}\n");
    if let Some(Wave { amplitude_mm, wavelength_mm, phase_rad, direction, travel }) = pose.wave {
        let pairs = [
            ("amplitude_mm", number(amplitude_mm)),
            ("wavelength_mm", number(wavelength_mm)),
            ("phase_degrees", degrees(phase_rad)),
            ("direction", vector(direction)),
            ("travel", vector(travel)),
        ];
        put("wave", table(pairs.map(|(key, value)| (key.to_owned(), value))));
    }
    if !pose.morph_weights.is_empty() {
        put("morph", table(pose.morph_weights.iter().map(|(name, &weight)| (quoted(name), number(weight)))));
    }
    if !pose.joint_degrees.is_empty() {
        put("joints", table(pose.joint_degrees.iter().map(|(name, &turn)| (quoted(name), vector(turn)))));
    }
    text
}

/// A table on one line.
fn table(pairs: impl IntoIterator<Item = (String, String)>) -> String {
    let pairs: Vec<String> = pairs.into_iter().map(|(key, value)| format!("{key} = {value}")).collect();
    format!("{{ {} }}", pairs.join(", "))
}
