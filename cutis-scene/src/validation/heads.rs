//! Heads: a scan from outside, and the one made by code.

use super::bodies::{camera, lamp, scene, skin};
use crate::head::{self, HeadDetail};
use crate::read::{ReadOptions, asset, read_scene};
use crate::{Light, Object, Scene, SceneError};
use glam::Vec3;
use std::path::Path;

/// The scanned head, on the shelf of assets.
pub const SCAN: &str = "lee_perry_smith/LeePerrySmith.obj";
/// Makes the scan as large as a head.
const SCAN_MM_PER_UNIT: f32 = 950.0;
/// Enough for ears and lids; its maps would only show in the diffuse part as colour.
const BUILT_IN: HeadDetail = HeadDetail { triangles: 40_000, map_size: 0 };

/// The scanned head in the colour of its medium, in one light.
fn scan(light: Light, eye: crate::Camera) -> Result<Scene, SceneError> {
    let path = asset(SCAN).map_err(|reason| SceneError::new(Path::new(SCAN), "assets", reason))?;
    let options = ReadOptions { millimetres_per_unit: Some(SCAN_MM_PER_UNIT), ..ReadOptions::default() };
    let read = read_scene(&path, &options)?;
    let bare = |object: Object| Object { material: skin(), ..object };
    Ok(scene(read.objects.into_iter().map(bare).collect(), light, eye))
}

/// From the front, lit from the front left and above.
pub fn front() -> Result<Scene, SceneError> {
    let face = Vec3::new(8.0, -30.0, 80.0);
    let light = lamp(Vec3::new(-300.0, 300.0, 600.0), 25.0, face, 3.0);
    scan(light, camera(Vec3::new(8.0, -20.0, 800.0), Vec3::new(8.0, -30.0, 0.0), 330.0))
}

/// The ear on the right of the picture, with the lamp behind it.
pub fn ear() -> Result<Scene, SceneError> {
    let ear = Vec3::new(95.0, -15.0, -20.0);
    let light = lamp(Vec3::new(140.0, 0.0, -260.0), 15.0, ear, 10.0);
    scan(light, camera(ear + Vec3::new(150.0, 0.0, 260.0), ear, 90.0))
}

/// The built-in head with its own colour, from the front, lit from the front left and above.
pub fn built_in() -> Scene {
    let object = head::built_in(BUILT_IN);
    let light = lamp(Vec3::new(-350.0, 300.0, 600.0), 25.0, Vec3::new(0.0, -20.0, 80.0), 3.0);
    scene(vec![object], light, camera(Vec3::new(420.0, 0.0, 700.0), Vec3::new(0.0, -38.0, 0.0), 345.0))
}
