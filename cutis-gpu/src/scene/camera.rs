//! The camera as shaders read it.

use bytemuck::{Pod, Zeroable};
use cutis_scene::{Camera, Scene};
use glam::Vec3;

/// The camera; the twin of `Camera` in `lib/camera.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct GpuCamera {
    /// The pinhole, mm.
    pub position_mm: [f32; 3],
    /// Depth before which nothing is drawn, mm.
    pub near_mm: f32,
    /// Where it looks.
    pub forward: [f32; 3],
    /// Depth behind which nothing is drawn, mm.
    pub far_mm: f32,
    /// Half the width of the picture at distance 1.
    pub right: [f32; 3],
    /// Fills up the struct.
    pub pad0: f32,
    /// Half the height of the picture at distance 1.
    pub up: [f32; 3],
    /// Fills up the struct.
    pub pad1: f32,
}

/// Nearest depth that is drawn, as a share of the farthest: depth has 24 good bits.
const NEAR_SHARE: f32 = 1e-4;

impl GpuCamera {
    /// The camera of a picture of this shape, its depths fitted to the scene.
    pub fn new(camera: &Camera, bounds_mm: [Vec3; 2], aspect_width_over_height: f32) -> Self {
        let [right, up, forward] = camera.axes();
        let half_height = (0.5 * camera.vertical_fov_rad).tan();
        let [lo, hi] = bounds_mm;
        let corners = (0..8).map(|i| {
            Vec3::new(
                if i & 1 == 0 { lo.x } else { hi.x },
                if i & 2 == 0 { lo.y } else { hi.y },
                if i & 4 == 0 { lo.z } else { hi.z },
            )
        });
        let depths = corners.map(|corner| (corner - camera.position_mm).dot(forward));
        let (near, far) = depths.fold((f32::INFINITY, 0.0f32), |(n, f), d| (n.min(d), f.max(d)));
        // A scene behind the camera is not seen, but the numbers have to be.
        let far_mm = (1.01 * far).max(1.0);
        Self {
            position_mm: camera.position_mm.to_array(),
            near_mm: (0.99 * near).max(NEAR_SHARE * far_mm),
            forward: forward.to_array(),
            far_mm,
            right: (right * half_height * aspect_width_over_height).to_array(),
            up: (up * half_height).to_array(),
            ..Self::zeroed()
        }
    }

    /// The camera of a scene.
    pub fn of_scene(scene: &Scene, aspect_width_over_height: f32) -> Self {
        let bounds_mm = scene.bounds_mm().unwrap_or([Vec3::ZERO; 2]);
        Self::new(&scene.camera, bounds_mm, aspect_width_over_height)
    }
}
