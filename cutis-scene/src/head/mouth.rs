//! Lips, the line between them, philtrum, corners and the folds from nose to mouth.

use super::sdf::{Curve2, Sweep, bell, groove, smoothstep, soft_union};
use glam::{Vec2, Vec3};

/// What belongs to the mouth.
pub struct Mouth {
    upper_lip: Sweep,
    lower_lip: Sweep,
    line: Curve2,
    fold: Curve2,
}

/// The closed mouth seen from the front, mm. About as broad as the pupils are apart, less a finger.
pub const MOUTH_LINE_MM: [[f32; 2]; 6] =
    [[-1.0, -71.0], [0.0, -71.0], [5.0, -70.2], [14.0, -70.9], [20.0, -71.2], [25.0, -70.7]];

impl Mouth {
    /// Lays out the curves.
    pub fn new() -> Self {
        Self {
            upper_lip: Sweep::new(&[
                [0.0, -66.3, 90.0, 4.0],
                [5.0, -65.3, 89.8, 4.2],
                [14.0, -67.4, 86.0, 3.5],
                [23.5, -70.3, 78.8, 2.2],
            ]),
            lower_lip: Sweep::new(&[
                [0.0, -75.1, 87.4, 5.3],
                [8.0, -74.8, 86.4, 5.1],
                [16.0, -73.5, 83.4, 3.9],
                [23.5, -71.2, 78.8, 2.2],
            ]),
            line: Curve2::open(&MOUTH_LINE_MM),
            fold: Curve2::open(&[[18.5, -42.0], [24.0, -50.0], [29.5, -60.0], [32.0, -69.0]]),
        }
    }

    /// The head `d` with a mouth; `side` has x >= 0, mm.
    pub fn add_to(&self, d: f32, p: Vec3, side: Vec3) -> f32 {
        if p.y > -30.0 || p.y < -110.0 || side.x > 55.0 {
            return d;
        }
        let lips = soft_union(self.upper_lip.distance(side, 15.0), self.lower_lip.distance(side, 15.0), 2.6);
        let d = soft_union(d, lips, 3.6);
        let frontal = Vec2::new(side.x, p.y);
        let on_front = smoothstep(60.0, 72.0, p.z);
        let line = 1.2 * groove(self.line.distance(frontal), 1.25);
        let fold = 0.9 * groove(self.fold.distance(frontal), 4.5);
        let philtrum = 1.3 * bell(p - Vec3::new(0.0, -56.5, 93.0), Vec3::new(3.0, 6.5, 8.0))
            - 0.5 * bell(side - Vec3::new(5.3, -58.0, 93.0), Vec3::new(2.2, 6.5, 8.0));
        let corner = 1.2 * bell(side - Vec3::new(28.0, -71.5, 78.0), Vec3::new(3.5, 4.5, 6.0));
        d + on_front * (line + fold) + philtrum + corner
    }
}
