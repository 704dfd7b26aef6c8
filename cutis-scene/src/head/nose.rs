//! The nose: bridge, tip, wings, nostrils and the groove around the wings.

use super::sdf::{Curve2, Sweep, ellipsoid, groove, pitch, smoothstep, soft_cut, soft_union};
use glam::{Vec2, Vec3};

/// What belongs to the nose.
pub struct Nose {
    /// What fills the space between the ridge and the face.
    body: Sweep,
    bridge: Sweep,
    wing: Sweep,
    wing_groove: Curve2,
}

impl Nose {
    /// Lays out the curves.
    pub fn new() -> Self {
        Self {
            body: Sweep::new(&[[0.0, 4.0, 74.0, 8.0], [0.0, -18.0, 83.0, 9.5], [0.0, -36.0, 90.0, 11.0]]),
            bridge: Sweep::new(&[
                [0.0, 8.0, 78.5, 7.5],
                [0.0, -6.0, 84.5, 6.2],
                [0.0, -20.0, 93.5, 6.6],
                [0.0, -34.0, 102.5, 7.8],
                [0.0, -37.5, 103.2, 7.6],
            ]),
            wing: Sweep::new(&[
                [6.0, -37.5, 101.0, 6.2],
                [11.0, -39.5, 95.5, 6.0],
                [12.3, -42.0, 89.5, 5.2],
                [12.0, -43.0, 82.0, 5.2],
            ]),
            wing_groove: Curve2::open(&[[11.5, -31.0], [15.8, -34.0], [18.3, -39.0], [17.6, -45.0]]),
        }
    }

    /// The head `d` with a nose; `side` has x >= 0, mm.
    pub fn add_to(&self, d: f32, p: Vec3, side: Vec3) -> f32 {
        if side.x > 40.0 || p.y < -75.0 || p.y > 35.0 {
            return d;
        }
        let d = soft_union(d, self.body.distance(p, 25.0), 10.0);
        let d = soft_union(d, self.bridge.distance(p, 25.0), 11.0);
        let d = soft_union(d, self.wing.distance(side, 15.0), 4.5);
        let columella = ellipsoid(p - Vec3::new(0.0, -44.5, 97.5), Vec3::new(3.6, 4.3, 8.0));
        let d = soft_union(d, columella, 4.5);
        // Closes the space between wings, bridge and lip, so that the nostrils are the only openings.
        let base = ellipsoid(side - Vec3::new(4.0, -39.5, 91.0), Vec3::new(10.0, 6.0, 12.0));
        let d = soft_union(d, base, 3.0);
        let nostril = pitch(25.0) * (side - Vec3::new(7.2, -45.8, 96.5));
        let d = soft_cut(d, ellipsoid(nostril, Vec3::new(2.9, 4.4, 5.0)), 2.0);
        let around = groove(self.wing_groove.distance(Vec2::new(side.x, p.y)), 1.6);
        d + 0.7 * around * smoothstep(76.0, 82.0, p.z)
    }
}
