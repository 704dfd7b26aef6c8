//! The neck down to a rounded cut: throat, nape and a hint of the sternocleidomastoid.

use super::sdf::{Sweep, ellipsoid, soft_intersection, soft_union};
use glam::Vec3;

/// Height of the flat end of the neck, mm.
pub const CUT_Y_MM: f32 = -196.0;

/// The neck.
pub struct Neck {
    column: Sweep,
    muscle: Sweep,
}

impl Neck {
    /// Lays out the curves.
    pub fn new() -> Self {
        Self {
            column: Sweep::new(&[
                [0.0, -20.0, -22.0, 52.0],
                [0.0, -70.0, -26.0, 52.0],
                [0.0, -130.0, -34.0, 54.0],
                [0.0, -165.0, -38.0, 58.0],
                [0.0, -215.0, -42.0, 68.0],
            ]),
            muscle: Sweep::new(&[
                [60.0, -38.0, -34.0, 9.0],
                [54.0, -80.0, -26.0, 11.0],
                [42.0, -125.0, -8.0, 11.0],
                [24.0, -170.0, 14.0, 10.0],
                [10.0, -210.0, 28.0, 8.0],
            ]),
        }
    }

    /// Distance, mm.
    pub fn distance(&self, p: Vec3) -> f32 {
        let side = Vec3::new(p.x.abs(), p.y, p.z);
        // The throat is a little broader than deep.
        let squeezed = Vec3::new(p.x * 0.97, p.y, p.z);
        let mut d = self.column.distance(squeezed, 80.0);
        d = soft_union(d, self.muscle.distance(side, 40.0), 14.0);
        let larynx = ellipsoid(p - Vec3::new(0.0, -146.0, 13.0), Vec3::new(10.0, 17.0, 9.0));
        soft_union(d, larynx, 14.0)
    }

    /// Cuts whatever hangs below the end of the neck.
    pub fn cut_off(&self, d: f32, p: Vec3) -> f32 {
        soft_intersection(d, CUT_Y_MM - p.y, 10.0)
    }
}
