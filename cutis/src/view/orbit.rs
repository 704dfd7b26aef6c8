//! How the camera moves: around the point it looks at, towards it, and with it.

use cutis_scene::Camera;
use glam::{Quat, Vec2, Vec3};

/// How close to straight up or down the camera may look, as a cosine.
const POLE: f32 = 0.995;
/// Nearest distance to the point that is looked at, mm, and the farthest.
const DISTANCES_MM: [f32; 2] = [1.0, 1e6];

/// Turns around the point that is looked at: right and up, rad.
pub fn orbit(camera: &mut Camera, by_rad: Vec2) {
    let up = camera.up.normalize_or(Vec3::Y);
    let from = camera.position_mm - camera.look_at_mm;
    let around = Quat::from_axis_angle(up, -by_rad.x) * from;
    let aside = up.cross(around).normalize_or(up.any_orthonormal_vector());
    let lifted = Quat::from_axis_angle(aside, -by_rad.y) * around;
    let is_upright = lifted.normalize_or(Vec3::Z).dot(up).abs() < POLE;
    camera.position_mm = camera.look_at_mm + if is_upright { lifted } else { around };
}

/// Divides the distance to the point that is looked at.
pub fn zoom(camera: &mut Camera, factor: f32) {
    let from = camera.position_mm - camera.look_at_mm;
    let distance_mm = (from.length() / factor).clamp(DISTANCES_MM[0], DISTANCES_MM[1]);
    camera.position_mm = camera.look_at_mm + from.normalize_or(Vec3::Z) * distance_mm;
}

/// Moves the camera and what it looks at, so that the latter follows the pointer: `by` in heights of the picture, down.
pub fn pan(camera: &mut Camera, by: Vec2) {
    let [right, up, _] = camera.axes();
    let distance_mm = (camera.position_mm - camera.look_at_mm).length();
    let height_mm = 2.0 * distance_mm * (0.5 * camera.vertical_fov_rad).tan();
    let shift_mm = (up * by.y - right * by.x) * height_mm;
    camera.position_mm += shift_mm;
    camera.look_at_mm += shift_mm;
}

/// Sees the whole box from where the camera is.
pub fn frame(camera: &mut Camera, bounds_mm: [Vec3; 2]) {
    let from = camera.position_mm - camera.look_at_mm;
    let framed = Camera::framing(bounds_mm, from, camera.vertical_fov_rad);
    *camera = Camera { up: camera.up, exposure_ev: camera.exposure_ev, ..framed };
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera {
            position_mm: Vec3::new(0.0, 10.0, 500.0),
            look_at_mm: Vec3::new(0.0, 10.0, 0.0),
            up: Vec3::Y,
            vertical_fov_rad: 0.5,
            exposure_ev: 0.0,
        }
    }

    #[test]
    fn orbiting_keeps_the_distance_and_never_crosses_the_pole() {
        let mut moved = camera();
        for _ in 0..100 {
            orbit(&mut moved, Vec2::new(0.3, 0.2));
            let from = moved.position_mm - moved.look_at_mm;
            assert!((from.length() - 500.0).abs() < 0.1, "{from}");
            assert!(from.normalize().y < POLE + 1e-4);
        }
        assert_eq!(moved.look_at_mm, camera().look_at_mm);
    }

    #[test]
    fn what_is_dragged_follows_the_pointer() {
        // A drag by a quarter turn to the right shows the left side: the camera goes to -X.
        let mut moved = camera();
        orbit(&mut moved, Vec2::new(std::f32::consts::FRAC_PI_2, 0.0));
        assert!(moved.position_mm.x < -499.0, "{}", moved.position_mm);
        // A drag down shows the top.
        let mut moved = camera();
        orbit(&mut moved, Vec2::new(0.0, 0.3));
        assert!(moved.position_mm.y > 100.0, "{}", moved.position_mm);
        // A pan by half a height to the right puts the point at the right half way up.
        let mut moved = camera();
        pan(&mut moved, Vec2::new(0.5, 0.0));
        let height_mm = 2.0 * 500.0 * 0.25f32.tan();
        assert!((moved.look_at_mm.x + 0.5 * height_mm).abs() < 1e-3, "{}", moved.look_at_mm);
    }

    #[test]
    fn zooming_stays_before_the_point() {
        let mut moved = camera();
        zoom(&mut moved, 2.0);
        assert!((moved.position_mm.z - 250.0).abs() < 1e-3);
        zoom(&mut moved, 1e9);
        assert!((moved.position_mm - moved.look_at_mm).length() >= DISTANCES_MM[0] * 0.999);
        zoom(&mut moved, 0.0);
        assert!(moved.position_mm.is_finite());
    }
}
