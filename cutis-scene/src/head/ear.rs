//! The ear: a curved plate of cartilage with a rolled rim, a hollow and a lobe.
//!
//! Drawn in its own frame: `u` from the root backwards (and outwards), `v` up along the ear, `w` off the plate.
//! Ears of adults are about 63 mm high and 35 mm broad (Farkas 1994, "Anthropometry of the Head and Face"; from memory).

use super::sdf::{Curve2, Sweep, ellipsoid, smoothstep, soft_cut, soft_union};
use glam::{Vec2, Vec3};

/// Root of the ear, in front of the hollow, mm.
const ROOT_MM: Vec3 = Vec3::new(69.5, -17.0, -4.0);
/// Angle by which the long axis leans back.
const LEAN_DEG: f32 = 12.0;
/// Angle between the plate and the side of the head.
const STAND_OFF_DEG: f32 = 27.0;
/// Thickness of skin, cartilage and skin, mm.
const PLATE_MM: f32 = 2.6;
/// Depth of the hollow below the plate, mm.
const CONCHA_DEPTH_MM: f32 = 12.0;
/// Beyond this distance from the middle the ear is not evaluated, mm.
const REACH_MM: f32 = 48.0;

/// The ear on the side of +x.
pub struct Ear {
    axes: [Vec3; 3],
    outline: Curve2,
    concha: Curve2,
    antihelix: Curve2,
    lower_crus: Curve2,
    helix: Sweep,
}

impl Ear {
    /// Lays out the curves.
    pub fn new() -> Self {
        let (sin_lean, cos_lean) = LEAN_DEG.to_radians().sin_cos();
        let (sin_off, cos_off) = STAND_OFF_DEG.to_radians().sin_cos();
        let up = Vec3::new(0.0, cos_lean, -sin_lean);
        let back = Vec3::new(0.0, -sin_lean, -cos_lean);
        Self {
            axes: [back * cos_off + Vec3::X * sin_off, up, Vec3::X * cos_off - back * sin_off],
            outline: Curve2::closed(&[
                [0.0, -22.0], [1.0, 0.0], [2.0, 14.0], [6.0, 25.0], [15.0, 31.5], [25.0, 29.5], [32.0, 21.0],
                [34.5, 9.0], [33.0, -4.0], [28.5, -15.0], [23.0, -23.0], [17.0, -30.0], [9.0, -32.0], [3.0, -28.5],
            ]),
            concha: Curve2::closed(&[
                [1.0, -8.0], [2.0, 4.0], [8.0, 9.0], [16.0, 8.5], [20.5, 3.0], [20.5, -6.0], [16.5, -13.0],
                [10.0, -15.5], [6.5, -18.0], [3.5, -14.0],
            ]),
            antihelix: Curve2::open(&[
                [11.0, -18.5], [17.0, -16.0], [22.0, -9.0], [24.0, 0.0], [23.0, 8.0], [19.5, 16.0], [15.5, 23.0],
            ]),
            lower_crus: Curve2::open(&[[23.0, 7.0], [17.0, 11.0], [10.0, 13.0], [4.0, 13.0]]),
            helix: Sweep::new(&[
                [13.0, -1.0, -8.0, 1.6], [8.0, 2.5, -3.5, 1.9], [4.5, 7.0, 0.5, 2.0], [3.6, 14.0, 2.0, 1.9],
                [7.2, 23.5, 2.2, 1.8], [15.0, 29.4, 2.0, 1.7], [24.0, 27.6, 1.8, 1.7], [30.2, 20.0, 1.6, 1.7],
                [32.6, 9.0, 1.5, 1.6], [31.2, -3.5, 1.2, 1.5], [27.0, -14.0, 0.8, 1.5], [22.0, -21.5, 0.2, 1.6],
            ]),
        }
    }

    /// Coordinates (u, v, w) of a point with x >= 0, mm.
    pub fn local(&self, side: Vec3) -> Vec3 {
        let q = side - ROOT_MM;
        Vec3::from_array(self.axes.map(|axis| axis.dot(q)))
    }

    /// Height of the plate's middle over the plane w = 0, mm.
    pub fn plate_mm(&self, q: Vec2) -> f32 {
        let concha = smoothstep(1.0, -7.0, self.concha.signed_distance(q));
        let ridge = |d: f32, width: f32| (-(d / width).powi(2)).exp();
        let antihelix = ridge(self.antihelix.distance(q), 3.4);
        let crus = ridge(self.lower_crus.distance(q), 2.4);
        let fossa = ridge((q - Vec2::new(12.0, 19.0)).length(), 4.5);
        let lobe = smoothstep(-18.0, -26.0, q.y);
        let dish = ((q - Vec2::new(16.0, 0.0)).length() / 30.0).powi(2);
        dish * 1.5 - concha * CONCHA_DEPTH_MM + 3.6 * antihelix.max(0.75 * crus) - 1.0 * fossa - 2.0 * lobe
    }

    /// Distance from the plate's middle along its normal, and how far outside the concha's edge, mm.
    fn off_plate(&self, q: Vec3) -> f32 {
        let (uv, step) = (Vec2::new(q.x, q.y), 0.4);
        let h = self.plate_mm(uv);
        let slope = Vec2::new(
            self.plate_mm(uv + Vec2::X * step) - h,
            self.plate_mm(uv + Vec2::Y * step) - h,
        ) / step;
        (q.z - h) / (1.0 + slope.length_squared()).sqrt()
    }

    /// Whether the ear has any say about this point.
    pub fn near(&self, side: Vec3) -> bool {
        (self.local(side) - Vec3::new(16.0, 0.0, 0.0)).length() < REACH_MM
    }

    /// The head `d` with an ear; `side` has x >= 0, mm.
    pub fn add_to(&self, d: f32, side: Vec3) -> f32 {
        if !self.near(side) {
            return d;
        }
        let q = self.local(side);
        let off = self.off_plate(q);
        let uv = Vec2::new(q.x, q.y);
        let hollow = (self.concha.signed_distance(uv) + 1.0).max(-off);
        let d = soft_cut(d, hollow, 2.0);
        let d = soft_union(d, self.auricle(q, off), 3.0);
        let tragus = ellipsoid(q - Vec3::new(2.6, -8.5, 0.5), Vec3::new(3.4, 5.6, 4.2));
        let d = soft_union(d, tragus, 3.0);
        let canal = ellipsoid(q - Vec3::new(5.0, -7.0, -14.0), Vec3::new(3.2, 3.6, 8.0));
        soft_cut(d, canal, 2.5)
    }

    /// Plate and rim; negative inside.
    pub fn auricle(&self, q: Vec3, off: f32) -> f32 {
        let uv = Vec2::new(q.x, q.y);
        let lobe = smoothstep(-14.0, -26.0, q.y);
        let half = 0.5 * PLATE_MM + 0.9 * lobe;
        // A slab with a rounded rim.
        let past_rim = (self.outline.signed_distance(uv) + half).max(0.0);
        let past_face = off.abs();
        let plate = Vec2::new(past_rim, past_face).length() - half;
        soft_union(plate, self.helix.distance(q, 8.0), 1.6)
    }

    /// Signed distance from the middle of the plate: positive on the side that faces out.
    pub fn front_mm(&self, side: Vec3) -> f32 {
        self.off_plate(self.local(side))
    }
}
