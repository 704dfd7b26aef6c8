//! From the parts a file gave to a whole scene: checks, overrides, camera and, where there is none, light.

use super::atlas::{LACKS_SOME_UVS, LACKS_UVS, give_atlas};
use super::checks::{MAX_COUNT, check_mesh};
use super::file::resolve_for_user;
use super::image::ColourSpace;
use super::scene_file::PoseKeys;
use super::textures::Textures;
use super::{AtlasChoice, CameraChoice, Parts, Piece, ReadOptions, Textured};
use crate::error::one_line;
use crate::scene::bounds_mm;
use crate::studio::{STUDIO_BACKGROUND, studio_environment, studio_lights};
use crate::{Camera, ColourMap, NormalMap, NormalSpace, Object, ObjectSource, ScalarMap, Scene, SceneError};
use glam::Vec3;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Field of view of a camera that nobody described, rad: 25°, a portrait lens.
pub(super) const DEFAULT_FOV_RAD: f32 = 0.436_332_3;

/// Extents outside this range in mm are more likely a wrong unit than a strange model.
const PLAUSIBLE_EXTENT_MM: std::ops::Range<f32> = 20.0..3000.0;

/// Checks the parts and completes them.
pub(super) fn finish(mut parts: Parts, file: &Path, options: &ReadOptions) -> Result<Scene, SceneError> {
    override_materials(&mut parts, options)?;
    let vertices: usize = parts.pieces.iter().map(|piece| piece.mesh.positions_mm.len()).sum();
    let triangles: usize = parts.pieces.iter().map(|piece| piece.mesh.triangles.len()).sum();
    if vertices > MAX_COUNT || triangles > MAX_COUNT {
        let reason = format!("{vertices} vertices and {triangles} triangles; at most {MAX_COUNT} of each");
        return Err(SceneError::new(file, "whole scene", reason));
    }
    let mut warnings = parts.warnings;
    let count = parts.pieces.len();
    let origin = parts.origin.map(Arc::new);
    let mut objects = Vec::with_capacity(count);
    for (number, piece) in parts.pieces.into_iter().enumerate() {
        let own_material = piece.own_material.clone();
        let mut object = to_object(piece, file, (options, parts.atlas), &mut warnings)?;
        object.source = origin.clone().map(|origin| ObjectSource { origin, number, count, own_material });
        objects.push(object);
    }
    let Some(bounds_mm) = bounds_mm(&objects) else {
        return Err(SceneError::new(file, "whole scene", "there is no mesh to look at"));
    };
    let camera = camera(parts.camera, bounds_mm);
    let (lights, environment) = (parts.lights, parts.environment);
    let mut scene = Scene { objects, lights, environment, camera, background: parts.background, warnings };
    warn_about_size(bounds_mm, &mut scene.warnings);
    if !parts.dark {
        light_if_dark(&mut scene, bounds_mm);
    }
    // Last, so that a camera and lights that nobody placed stand still while the scene moves.
    if let Some(PoseKeys { pose, place }) = parts.pose {
        scene.set_pose(&pose).map_err(|error| SceneError::new(file, place, error.to_string()))?;
    }
    scene.warnings = scene.warnings.iter().map(|text| one_line(text)).collect();
    Ok(scene)
}

fn to_object(
    piece: Piece,
    file: &Path,
    (options, atlas): (&ReadOptions, AtlasChoice),
    warnings: &mut Vec<String>,
) -> Result<Object, SceneError> {
    let Piece { name, place, mut mesh, textured, material, .. } = piece;
    let fail = |reason: String| SceneError::new(file, place.as_str(), reason);
    check_mesh(&mut mesh, file, &place, warnings)?;
    match textured {
        Textured::Not if material.has_maps() => {
            let what_to_do = "unwrap it in a modelling program, or leave the maps out and an atlas is made";
            return Err(fail(format!("{LACKS_UVS}, which its maps need: {what_to_do}")));
        }
        Textured::Partly if material.has_maps() => {
            warnings.push(format!("{place}: {LACKS_SOME_UVS}: its maps show one colour there"));
        }
        _ => {}
    }
    match give_atlas(&mut mesh, textured, atlas, options) {
        Ok(Some(words)) => warnings.push(format!("{place}: {words}")),
        Ok(None) => {}
        Err(why) => return Err(fail(why)),
    }
    Ok(Object::new(name, mesh, material))
}

/// Puts the caller's textures in the place of the file's.
fn override_materials(parts: &mut Parts, options: &ReadOptions) -> Result<(), SceneError> {
    let mut textures = Textures::default();
    let Parts { pieces, warnings, .. } = parts;
    let mut read = |path: &PathBuf, space| {
        let path = resolve_for_user(path, options.assets_folder.as_deref())?;
        textures.file(&path, space, warnings)
    };
    if let Some(path) = &options.albedo {
        let map = ColourMap { factor: Vec3::ONE, texture: Some(read(path, ColourSpace::Colour)?) };
        pieces.iter_mut().for_each(|piece| piece.material.albedo = map.clone());
    }
    if let Some(path) = &options.normal {
        let texture = read(path, ColourSpace::Data)?;
        let map = NormalMap { texture, space: NormalSpace::Tangent, strength: 1.0 };
        pieces.iter_mut().for_each(|piece| piece.material.normal = Some(map.clone()));
    }
    if let Some(path) = &options.specular {
        let map = ScalarMap::measured_rho_s(read(path, ColourSpace::Data)?);
        pieces.iter_mut().for_each(|piece| piece.material.rho_s = map.clone());
    }
    Ok(())
}

fn camera(choice: CameraChoice, bounds_mm: [Vec3; 2]) -> Camera {
    match choice {
        CameraChoice::Framing => Camera::framing(bounds_mm, Vec3::Z, DEFAULT_FOV_RAD),
        CameraChoice::Fixed(camera) => aimed(camera, bounds_mm),
        CameraChoice::Partial(keys) => keys.camera(bounds_mm),
    }
}

/// Moves the point a camera looks at along its axis to the depth of the scene, where orbiting should turn around.
fn aimed(camera: Camera, bounds_mm: [Vec3; 2]) -> Camera {
    let [_, _, forward] = camera.axes();
    let depth_mm = (0.5 * (bounds_mm[0] + bounds_mm[1]) - camera.position_mm).dot(forward);
    Camera { look_at_mm: camera.position_mm + forward * depth_mm.max(1.0), ..camera }
}

fn warn_about_size(bounds_mm: [Vec3; 2], warnings: &mut Vec<String>) {
    let extent_mm = (bounds_mm[1] - bounds_mm[0]).max_element();
    if !PLAUSIBLE_EXTENT_MM.contains(&extent_mm) {
        warnings.push(format!(
            "the scene is {extent_mm:.1} mm across; if that is not meant, state millimetres_per_unit, for light \
             spreads by millimetres"
        ));
    }
}

/// A scene without light gets the studio, and says so.
fn light_if_dark(scene: &mut Scene, bounds_mm: [Vec3; 2]) {
    if scene.lights.is_empty() && scene.environment.is_none() {
        scene.lights = studio_lights(bounds_mm);
        scene.environment = Some(studio_environment());
        scene.background = scene.background.or(Some(STUDIO_BACKGROUND));
        scene
            .warnings
            .push("no lights were given: a studio with key, rim and room light was added".to_owned());
    }
}
