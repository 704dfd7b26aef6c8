//! Brow ridge, eye sockets and closed lids with crease and lash line.

use super::sdf::{Curve2, Sweep, ellipsoid, groove, smoothstep, soft_cut, soft_union};
use glam::{Vec2, Vec3};

/// Centre of the eyeball on the side of +x, mm. Pupils 63 mm apart.
pub const EYE_MM: Vec3 = Vec3::new(31.5, -1.0, 65.5);
/// Radii of the closed lids over the eyeball (12 mm radius, 1.5 mm of lid, longer towards the corners), mm.
const LIDS_MM: Vec3 = Vec3::new(17.0, 13.0, 13.0);
/// The margin of the upper lid lies over that of the lower one, mm.
const LID_STEP_MM: f32 = 0.55;

/// What belongs to the eyes.
pub struct Eyes {
    brow: Sweep,
    crease: Curve2,
    lash_line: Curve2,
}

impl Eyes {
    /// Lays out the curves.
    pub fn new() -> Self {
        Self {
            brow: Sweep::new(&[
                [0.0, 14.0, 78.5, 8.0],
                [12.0, 16.5, 79.0, 8.0],
                [30.0, 19.5, 74.0, 7.5],
                [45.0, 15.0, 62.0, 7.0],
                [51.5, 4.0, 48.5, 7.0],
                [52.0, -11.0, 44.0, 6.5],
            ]),
            crease: Curve2::open(&[[-13.0, 5.5], [-8.0, 8.6], [0.0, 10.2], [9.0, 9.0], [18.5, 3.5]]),
            lash_line: Curve2::open(&LASH_LINE_MM),
        }
    }

    /// The head `d` with eyes; `side` has x >= 0, mm.
    pub fn add_to(&self, d: f32, side: Vec3) -> f32 {
        let d = soft_union(d, self.brow.distance(side, 20.0), 14.0);
        let q = side - EYE_MM;
        if q.length_squared() > 45.0 * 45.0 {
            return d;
        }
        let socket = ellipsoid(q - Vec3::new(-0.5, 0.0, 26.5), Vec3::new(23.0, 13.5, 15.0));
        let d = soft_cut(d, socket, 12.0);
        let d = soft_union(d, lids(q), 6.0);
        let on_front = smoothstep(-4.0, 2.0, q.z);
        let frontal = Vec2::new(q.x, q.y);
        d + on_front
            * (0.75 * groove(self.crease.distance(frontal), 1.5)
                + 0.6 * groove(self.lash_line.distance(frontal), 0.9))
    }
}

/// Where the closed lids meet, seen from the front, relative to the eyeball's centre, mm: hanging towards the cheek.
pub const LASH_LINE_MM: [[f32; 2]; 7] =
    [[-16.8, -3.0], [-14.0, -3.4], [-8.0, -6.0], [0.0, -7.4], [8.0, -6.4], [13.0, -3.6], [16.5, -0.8]];

fn lids(q: Vec3) -> f32 {
    let margin = -7.4 + 6.0 * (q.x / 16.0).powi(2);
    let upper = smoothstep(margin - 0.3, margin + 0.5, q.y);
    ellipsoid(q, LIDS_MM) - LID_STEP_MM * upper
}
