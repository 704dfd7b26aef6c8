//! `[pose]`: shapes, joints and a wave. Which names there are is known when the mesh has been read.

use super::keys::Keys;
use crate::{Pose, SceneError, Wave};
use glam::Vec3;

/// A pose, and where it stands in the file.
#[derive(Debug, Clone)]
pub(in crate::read) struct PoseKeys {
    pub(in crate::read) pose: Pose,
    pub(in crate::read) place: String,
}

/// Reads `[pose]`.
pub(super) fn read(keys: &Keys) -> Result<PoseKeys, SceneError> {
    keys.only(&["morph", "joints", "wave"])?;
    let mut pose = Pose::default();
    if let Some(weights) = keys.table("morph")? {
        for name in weights.names() {
            let weight = weights.required(name, weights.number(name)?)?;
            pose.morph_weights.insert(name.to_owned(), weight);
        }
    }
    if let Some(turns) = keys.table("joints")? {
        for name in turns.names() {
            let degrees = turns.required(name, turns.vector(name)?)?;
            pose.joint_degrees.insert(name.to_owned(), degrees);
        }
    }
    pose.wave = keys.table("wave")?.map(|keys| wave(&keys)).transpose()?;
    Ok(PoseKeys { pose, place: keys.place() })
}

fn wave(keys: &Keys) -> Result<Wave, SceneError> {
    keys.only(&["amplitude_mm", "wavelength_mm", "phase_degrees", "direction", "travel"])?;
    Ok(Wave {
        amplitude_mm: keys.required("amplitude_mm", keys.number("amplitude_mm")?)?,
        wavelength_mm: keys.required("wavelength_mm", keys.number("wavelength_mm")?)?,
        phase_rad: keys.radians("phase_degrees", -1e7..=1e7)?.unwrap_or(0.0),
        direction: keys.direction("direction")?.unwrap_or(Vec3::X),
        travel: keys.direction("travel")?.unwrap_or(Vec3::Y),
    })
}
