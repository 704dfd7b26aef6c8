//! A pinhole camera.

use glam::{Vec2, Vec3};

/// Where the picture is taken from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// The pinhole, mm.
    pub position_mm: Vec3,
    /// The point in the middle of the picture, mm.
    pub look_at_mm: Vec3,
    /// Which way is up in the picture.
    pub up: Vec3,
    /// Angle between the upper and the lower edge of the picture, rad.
    pub vertical_fov_rad: f32,
    /// Exposure in stops: each one doubles the picture's values.
    pub exposure_ev: f32,
}

impl Camera {
    /// Unit vectors right, up and forward.
    pub fn axes(&self) -> [Vec3; 3] {
        let forward = (self.look_at_mm - self.position_mm).normalize_or(-Vec3::Z);
        let right = forward.cross(self.up).normalize_or(forward.any_orthonormal_vector());
        [right, right.cross(forward), forward]
    }

    /// The rays through a picture of this shape.
    pub fn rays(&self, aspect_width_over_height: f32) -> CameraRays {
        let [right, up, forward] = self.axes();
        let half_height = (0.5 * self.vertical_fov_rad).tan();
        CameraRays { forward, right: right * (half_height * aspect_width_over_height), up: up * half_height }
    }

    /// Camera that sees the whole box from a direction, with a little air around it.
    pub fn framing(bounds_mm: [Vec3; 2], dir_to_camera: Vec3, vertical_fov_rad: f32) -> Self {
        let centre = 0.5 * (bounds_mm[0] + bounds_mm[1]);
        let radius_mm = 0.5 * (bounds_mm[1] - bounds_mm[0]).length();
        // 0.8: heads are much narrower than the sphere around their box.
        let distance_mm = 0.8 * radius_mm / (0.5 * vertical_fov_rad).sin();
        Self {
            position_mm: centre + dir_to_camera.normalize_or(Vec3::Z) * distance_mm,
            look_at_mm: centre,
            up: Vec3::Y,
            vertical_fov_rad,
            exposure_ev: 0.0,
        }
    }
}

/// The rays of a camera through its picture.
#[derive(Debug, Clone, Copy)]
pub struct CameraRays {
    forward: Vec3,
    right: Vec3,
    up: Vec3,
}

impl CameraRays {
    /// Unit direction through `ndc`: (-1, -1) is the lower left corner of the picture, (1, 1) the upper right.
    pub fn dir_through(&self, ndc: Vec2) -> Vec3 {
        (self.forward + self.right * ndc.x + self.up * ndc.y).normalize()
    }
}
