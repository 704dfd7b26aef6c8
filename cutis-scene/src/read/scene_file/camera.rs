//! `[camera]`: where it stands, or how far and from which side it looks at what.

use super::keys::Keys;
use crate::read::finish::DEFAULT_FOV_RAD;
use crate::{Camera, SceneError};
use glam::{EulerRot, Quat, Vec3};

/// What a scene file says about the camera; what is left out follows from the bounds of the scene.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::read) struct CameraKeys {
    look_at_mm: Option<Vec3>,
    position_mm: Option<Vec3>,
    distance_mm: Option<f32>,
    /// Turn about +Y: positive moves the camera to +X.
    yaw_rad: f32,
    /// Positive lifts the camera.
    pitch_rad: f32,
    up: Option<Vec3>,
    vertical_fov_rad: Option<f32>,
    exposure_ev: f32,
    /// Radiance behind the scene, W/(m² sr).
    background: Option<Vec3>,
}

/// Reads `[camera]`.
pub(super) fn read(keys: &Keys) -> Result<CameraKeys, SceneError> {
    keys.only(&[
        "look_at_mm",
        "position_mm",
        "distance_mm",
        "yaw_degrees",
        "pitch_degrees",
        "up",
        "vertical_fov_degrees",
        "exposure_ev",
        "background",
    ])?;
    let position_mm = keys.vector_in("position_mm", -1e7..=1e7)?;
    for key in ["distance_mm", "yaw_degrees", "pitch_degrees"] {
        if position_mm.is_some() && keys.has(key) {
            return Err(
                keys.error(key, "stands beside `position_mm`, which already says where the camera is")
            );
        }
    }
    let look_at_mm = keys.vector_in("look_at_mm", -1e7..=1e7)?;
    if position_mm.is_some() && position_mm == look_at_mm {
        return Err(keys.error("position_mm", "is the point the camera looks at"));
    }
    Ok(CameraKeys {
        look_at_mm,
        position_mm,
        distance_mm: keys.number_in("distance_mm", f32::MIN_POSITIVE..=1e7)?,
        yaw_rad: keys.radians("yaw_degrees", -360.0..=360.0)?.unwrap_or(0.0),
        // Straight above or below, up has no direction.
        pitch_rad: keys.radians("pitch_degrees", -89.0..=89.0)?.unwrap_or(0.0),
        up: keys.direction("up")?,
        vertical_fov_rad: keys.radians("vertical_fov_degrees", 0.1..=170.0)?,
        exposure_ev: keys.number_in("exposure_ev", -32.0..=32.0)?.unwrap_or(0.0),
        background: keys.vector_in("background", 0.0..=1e6)?,
    })
}

impl CameraKeys {
    /// What the camera sees behind everything.
    pub(super) fn background(&self) -> Option<Vec3> {
        self.background
    }

    /// The whole camera for a scene inside a box.
    pub(in crate::read) fn camera(&self, bounds_mm: [Vec3; 2]) -> Camera {
        let fov = self.vertical_fov_rad.unwrap_or(DEFAULT_FOV_RAD);
        let dir = Quat::from_euler(EulerRot::YXZ, self.yaw_rad, -self.pitch_rad, 0.0) * Vec3::Z;
        let framing = Camera::framing(bounds_mm, dir, fov);
        let look_at_mm = self.look_at_mm.unwrap_or(framing.look_at_mm);
        let framing_distance_mm = framing.position_mm.distance(framing.look_at_mm);
        let distance_mm = self.distance_mm.unwrap_or(framing_distance_mm);
        let position_mm = self.position_mm.unwrap_or(look_at_mm + dir * distance_mm);
        let up = self.up.unwrap_or(framing.up);
        Camera { position_mm, look_at_mm, up, exposure_ev: self.exposure_ev, ..framing }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn yaw_goes_to_plus_x_and_pitch_up() {
        let bounds = [Vec3::splat(-1.0), Vec3::splat(1.0)];
        let at = |yaw: f32, pitch: f32| {
            let keys = CameraKeys {
                distance_mm: Some(10.0),
                yaw_rad: yaw.to_radians(),
                pitch_rad: pitch.to_radians(),
                ..CameraKeys::default()
            };
            keys.camera(bounds).position_mm
        };
        assert!((at(0.0, 0.0) - Vec3::Z * 10.0).length() < 1e-5);
        assert!((at(90.0, 0.0) - Vec3::X * 10.0).length() < 1e-5);
        assert!((at(0.0, 30.0) - Vec3::new(0.0, 5.0, 75.0f32.sqrt())).length() < 1e-5);
    }
}
