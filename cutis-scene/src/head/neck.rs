//! The neck down to a rounded cut: throat, nape and a hint of the sternocleidomastoid.

use super::sdf::{Sweep, ellipsoid, smoothstep, soft_intersection, soft_union};
use glam::{Vec2, Vec3};

/// Height of the flat end of the neck, mm.
pub const CUT_Y_MM: f32 = -178.0;

/// The neck.
pub struct Neck {
    muscle: Sweep,
}

impl Neck {
    /// Lays out the curves.
    pub fn new() -> Self {
        Self {
            muscle: Sweep::new(&[
                [58.0, -34.0, -32.0, 8.0],
                [48.0, -72.0, -25.0, 9.5],
                [39.0, -115.0, -8.0, 10.0],
                [26.0, -155.0, 11.0, 9.0],
                [12.0, -195.0, 20.0, 7.0],
            ]),
        }
    }

    /// Distance, mm.
    pub fn distance(&self, p: Vec3) -> f32 {
        let side = Vec3::new(p.x.abs(), p.y, p.z);
        let mut d = column(p);
        d = soft_union(d, self.muscle.distance(side, 24.0), 14.0);
        let larynx = ellipsoid(p - Vec3::new(0.0, -140.0, 13.0), Vec3::new(9.0, 16.0, 9.0));
        soft_union(d, larynx, 14.0)
    }

    /// Cuts whatever hangs below the end of the neck.
    pub fn cut_off(&self, d: f32, p: Vec3) -> f32 {
        soft_intersection(d, CUT_Y_MM - p.y, 10.0)
    }
}

/// The trunk: leaning forward as it rises, broadening towards the shoulders.
fn column(p: Vec3) -> f32 {
    let middle_z_mm = -30.0 + 0.11 * (p.y + 100.0);
    let foot = smoothstep(-120.0, -215.0, p.y);
    let nape = smoothstep(-100.0, -40.0, p.y);
    let radius_mm = 51.0 + 13.0 * foot + 2.0 * nape;
    let round = Vec2::new(p.x * (1.05 - 0.1 * foot), p.z - middle_z_mm).length() - radius_mm;
    // The upper end lies within the cranium.
    soft_intersection(round, p.y - 8.0, 30.0)
}
