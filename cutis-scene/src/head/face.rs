//! The features: brow, closed eyes, nose, mouth.

use super::sdf::{Sweep, bell, ellipsoid, pitch, soft_abs, soft_cut, soft_union};
use glam::Vec3;

/// Centre of the (right-hand side of the picture) eyeball, mm. Pupils 63 mm apart.
pub const EYE_MM: Vec3 = Vec3::new(31.5, -1.0, 64.0);

/// The features of the face as additions to, and cuts into, the large forms.
pub struct Face {
    brow: Sweep,
    nose: Sweep,
    wing: Sweep,
    upper_lip: Sweep,
    lower_lip: Sweep,
    mouth_line: Sweep,
    lash_line: Sweep,
    lid_crease: Sweep,
}

impl Face {
    /// Lays out the curves.
    pub fn new() -> Self {
        Self {
            brow: Sweep::new(&[
                [0.0, 15.0, 80.0, 8.0],
                [12.0, 17.0, 80.5, 8.5],
                [30.0, 19.0, 76.0, 8.0],
                [45.0, 15.0, 64.0, 7.5],
                [53.0, 4.0, 50.0, 7.0],
            ]),
            nose: Sweep::new(&[
                [0.0, 8.0, 80.0, 7.5],
                [0.0, -6.0, 86.0, 6.0],
                [0.0, -20.0, 95.0, 6.8],
                [0.0, -34.0, 103.5, 8.0],
                [0.0, -37.0, 104.0, 8.0],
            ]),
            wing: Sweep::new(&[
                [6.0, -37.0, 102.0, 6.0],
                [11.5, -39.0, 96.0, 6.0],
                [12.5, -42.0, 90.0, 5.0],
            ]),
            upper_lip: Sweep::new(&[
                [0.0, -66.0, 91.5, 4.2],
                [5.0, -65.0, 91.2, 4.4],
                [14.0, -67.3, 86.8, 3.6],
                [23.5, -70.3, 78.8, 2.2],
            ]),
            lower_lip: Sweep::new(&[
                [0.0, -75.5, 89.0, 5.4],
                [8.0, -75.2, 87.8, 5.2],
                [16.0, -73.5, 84.2, 4.0],
                [23.5, -71.2, 78.8, 2.2],
            ]),
            mouth_line: Sweep::new(&[
                [0.0, -70.8, 97.2, 1.2],
                [5.0, -70.0, 96.6, 1.2],
                [14.0, -70.8, 91.4, 1.1],
                [22.0, -71.0, 84.2, 1.2],
                [27.0, -71.3, 79.0, 1.2],
            ]),
            lash_line: eye_curve(&[[-17.0, -2.0], [-9.0, -5.6], [0.0, -7.4], [9.0, -6.0], [17.0, -1.0]], 0.55),
            lid_crease: eye_curve(&[[-14.0, 4.0], [-7.0, 8.4], [1.0, 9.6], [9.0, 8.0], [18.0, 1.5]], 0.5),
        }
    }

    /// The head `d` at `p` with its features, mm.
    pub fn add_to(&self, d: f32, p: Vec3) -> f32 {
        // Behind the temples there is nothing to add.
        if p.z < 20.0 || d > 32.0 {
            return d;
        }
        let side = Vec3::new(soft_abs(p.x, 2.0), p.y, p.z);
        let mut d = soft_union(d, self.brow.distance(side, 20.0), 14.0);
        d = self.eyes(d, side);
        d = self.nose(d, p, side);
        self.mouth(d, p, side)
    }

    fn eyes(&self, d: f32, side: Vec3) -> f32 {
        let socket = ellipsoid(side - Vec3::new(31.0, -1.5, 91.0), Vec3::new(22.0, 13.0, 15.0));
        let d = soft_cut(d, socket, 12.0);
        let lids = lids(side - EYE_MM);
        let d = soft_union(d, lids, 5.0);
        let d = soft_cut(d, self.lid_crease.distance(side, 6.0), 1.6);
        soft_cut(d, self.lash_line.distance(side, 6.0), 1.0)
    }

    fn nose(&self, d: f32, p: Vec3, side: Vec3) -> f32 {
        let mut d = soft_union(d, self.nose.distance(p, 25.0), 12.0);
        d = soft_union(d, self.wing.distance(side, 15.0), 4.0);
        let columella = ellipsoid(p - Vec3::new(0.0, -44.5, 98.0), Vec3::new(3.6, 4.5, 8.0));
        d = soft_union(d, columella, 4.0);
        let nostril = pitch(25.0) * (side - Vec3::new(7.4, -45.5, 97.5));
        soft_cut(d, ellipsoid(nostril, Vec3::new(3.0, 5.0, 5.2)), 2.0)
    }

    fn mouth(&self, d: f32, p: Vec3, side: Vec3) -> f32 {
        let lips = soft_union(self.upper_lip.distance(side, 15.0), self.lower_lip.distance(side, 15.0), 1.5);
        let mut d = soft_union(d, lips, 4.0);
        d = soft_cut(d, self.mouth_line.distance(side, 6.0), 1.6);
        d += 1.3 * bell(p - Vec3::new(0.0, -56.5, 93.0), Vec3::new(3.2, 6.5, 8.0));
        d += 1.0 * bell(side - Vec3::new(28.5, -72.0, 78.0), Vec3::new(4.0, 5.0, 6.0));
        d
    }
}

/// The closed lids over the eyeball: a sphere with a slightly fuller upper half; `q` is relative to its centre.
fn lids(q: Vec3) -> f32 {
    ellipsoid(q, Vec3::new(15.5, 13.2, 13.6))
}

/// A groove on the lids, drawn in the frontal plane relative to the eyeball's centre.
fn eye_curve(knots: &[[f32; 2]], radius_mm: f32) -> Sweep {
    let lifted: Vec<_> = knots
        .iter()
        .map(|&[x, y]| {
            let (a, b) = (x / 15.5, y / 13.2);
            let z = 13.6 * (1.0 - a * a - b * b).max(0.02).sqrt();
            [EYE_MM.x + x, EYE_MM.y + y, EYE_MM.z + z, radius_mm]
        })
        .collect();
    Sweep::new(&lifted)
}
