//! The large forms: cranium, temples, cheekbones, jaw and chin.

use super::sdf::{Sweep, bell, ellipsoid, soft_abs, soft_union};
use glam::Vec3;

/// Cranium and facial skeleton with their flesh, without features.
pub struct Skull {
    jaw: Sweep,
    cheekbone: Sweep,
}

impl Skull {
    /// Lays out the curves.
    pub fn new() -> Self {
        Self {
            jaw: Sweep::new(&[
                [50.0, -38.0, -4.0, 12.0],
                [41.5, -70.0, 1.0, 12.0],
                [33.0, -90.0, 33.0, 12.0],
                [18.0, -100.5, 64.0, 12.0],
                [3.0, -101.5, 75.0, 12.5],
            ]),
            cheekbone: Sweep::new(&[
                [34.0, -31.0, 60.0, 11.0],
                [46.0, -25.0, 52.0, 12.0],
                [55.0, -18.0, 34.0, 11.5],
                [58.5, -15.0, 8.0, 9.5],
            ]),
        }
    }

    /// Distance, mm.
    pub fn distance(&self, p: Vec3) -> f32 {
        let side = Vec3::new(soft_abs(p.x, 3.0), p.y, p.z);
        let mut d = cranium(p);
        d = soft_union(d, face_block(p), 22.0);
        d = soft_union(d, self.jaw.distance(side, 26.0), 20.0);
        let chewing_muscle = ellipsoid(side - Vec3::new(44.0, -36.0, 2.0), Vec3::new(20.0, 42.0, 26.0));
        d = soft_union(d, chewing_muscle, 16.0);
        d = soft_union(d, self.cheekbone.distance(side, 32.0), 24.0);
        d = soft_union(d, ellipsoid(p - Vec3::new(0.0, -101.0, 78.0), Vec3::new(15.0, 13.0, 13.0)), 12.0);
        d + clay(side)
    }
}

/// Broadest above and behind the ears, narrower at the forehead.
fn cranium(p: Vec3) -> f32 {
    let front = ellipsoid(p - Vec3::new(0.0, 33.0, 0.0), Vec3::new(67.0, 79.5, 90.0));
    let rear = ellipsoid(p - Vec3::new(0.0, 40.0, -27.0), Vec3::new(75.0, 72.0, 73.0));
    soft_union(front, rear, 20.0)
}

/// The wedge from brow to chin that carries the features, and the arch of the teeth.
fn face_block(p: Vec3) -> f32 {
    let middle = ellipsoid(p - Vec3::new(0.0, -34.0, 26.0), Vec3::new(59.0, 76.0, 57.0));
    let teeth = ellipsoid(p - Vec3::new(0.0, -63.0, 57.0), Vec3::new(33.0, 31.0, 33.5));
    soft_union(middle, teeth, 14.0)
}

/// Hollows (positive) and fillings (negative) that no single shape gives; `side` has x >= 0.
fn clay(side: Vec3) -> f32 {
    let at = |x: f32, y: f32, z: f32, rx: f32, ry: f32, rz: f32| {
        bell(side - Vec3::new(x, y, z), Vec3::new(rx, ry, rz))
    };
    // temple, hollow under the cheekbone, upper forehead, fullness beside the mouth, dip between lower lip and chin
    3.0 * at(66.0, 16.0, 46.0, 22.0, 24.0, 22.0) + 2.5 * at(56.0, -54.0, 38.0, 20.0, 22.0, 26.0)
        - 4.0 * at(0.0, 76.0, 66.0, 60.0, 36.0, 40.0)
        - 1.5 * at(30.0, -56.0, 72.0, 14.0, 18.0, 20.0)
        + 3.0 * at(0.0, -88.0, 90.0, 26.0, 6.0, 12.0)
}
