//! The ear: a curved plate of cartilage with a rolled rim, a hollow and a lobe.
//!
//! Drawn in its own frame: `u` from the root backwards (and outwards), `v` up along the ear, `w` off the plate.
//! Ears of adults are about 63 mm high and 35 mm broad (Farkas 1994, "Anthropometry of the Head and Face"; from memory).

use super::ear_plate::{EarPlate, PlatePoint};
use super::sdf::{Sweep, ellipsoid, smoothstep, soft_cut, soft_union};
use glam::{Vec2, Vec3};

/// Root of the ear, in front of the hollow, mm.
const ROOT_MM: Vec3 = Vec3::new(66.5, -17.0, -4.0);
/// Angle by which the long axis leans back.
const LEAN_DEG: f32 = 12.0;
/// Angle between the plate and the side of the head.
const STAND_OFF_DEG: f32 = 27.0;
/// Thickness of skin, cartilage and skin, mm.
const PLATE_MM: f32 = 2.6;
/// Beyond this distance from the middle the ear is not evaluated, mm.
const REACH_MM: f32 = 44.0;

/// The ear on the side of +x.
pub struct Ear {
    axes: [Vec3; 3],
    plate: EarPlate,
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
            plate: EarPlate::new(),
            helix: Sweep::new(&[
                [8.5, 2.5, -6.0, 1.2],
                [6.0, 5.0, -2.5, 1.7],
                [4.4, 8.5, 0.4, 1.9],
                [3.6, 14.0, 1.8, 1.9],
                [7.2, 23.5, 2.2, 1.8],
                [15.0, 29.4, 2.0, 1.7],
                [24.0, 27.6, 1.8, 1.7],
                [30.2, 20.0, 1.6, 1.7],
                [32.6, 9.0, 1.5, 1.6],
                [31.2, -3.5, 1.2, 1.5],
                [27.0, -14.0, 0.8, 1.5],
                [22.0, -21.5, 0.2, 1.6],
            ]),
        }
    }

    /// Coordinates (u, v, w) of a point with x >= 0, mm.
    pub fn local(&self, side: Vec3) -> Vec3 {
        let q = side - ROOT_MM;
        Vec3::from_array(self.axes.map(|axis| axis.dot(q)))
    }

    /// A place given in the ear's frame, on the side of +x, mm.
    #[cfg(test)]
    pub fn world(&self, local: Vec3) -> Vec3 {
        ROOT_MM + self.axes[0] * local.x + self.axes[1] * local.y + self.axes[2] * local.z
    }

    /// Whether the ear has any say about this point.
    pub fn near(&self, side: Vec3) -> bool {
        (self.local(side) - Vec3::new(16.0, 0.0, -2.0)).length_squared() < REACH_MM * REACH_MM
    }

    /// The head `d` with an ear; `side` has x >= 0, mm.
    pub fn add_to(&self, d: f32, side: Vec3) -> f32 {
        if !self.near(side) {
            return d;
        }
        let q = self.local(side);
        let plate = self.plate.at(Vec2::new(q.x, q.y));
        let off = plate.off_mm(q.z);
        // The hollow goes on into the head, down to the middle of the plate.
        let hollow = (plate.outside_concha_mm + 1.0).max(-off);
        let d = soft_cut(d, hollow, 2.0);
        let d = soft_union(d, self.auricle(q, &plate), 3.0);
        let tragus = ellipsoid(q - Vec3::new(2.4, -8.5, 0.2), Vec3::new(3.4, 5.6, 4.2));
        let d = soft_union(d, tragus, 4.0);
        let canal = ellipsoid(q - Vec3::new(5.5, -7.0, -13.0), Vec3::new(3.0, 3.4, 6.0));
        soft_cut(d, canal, 3.0)
    }

    /// Plate and rim; negative inside.
    fn auricle(&self, q: Vec3, plate: &PlatePoint) -> f32 {
        let half = 0.5 * PLATE_MM + 0.9 * smoothstep(-14.0, -26.0, q.y);
        // A slab with a rounded rim.
        let past_rim = (plate.outside_mm + half).max(0.0);
        let slab = Vec2::new(past_rim, plate.off_mm(q.z)).length() - half;
        soft_union(slab, self.helix.distance(q, 8.0), 1.6)
    }

    /// Whether a point lies in the hollow, on the outer side of the plate.
    pub fn in_hollow(&self, side: Vec3) -> bool {
        let q = self.local(side);
        let plate = self.plate.at(Vec2::new(q.x, q.y));
        plate.outside_concha_mm < 0.5 && plate.off_mm(q.z) > -1.0 && q.z < 2.0
    }

    /// Signed distance from the middle of the plate: positive on the side that faces out, mm.
    pub fn front_mm(&self, side: Vec3) -> f32 {
        let q = self.local(side);
        self.plate.at(Vec2::new(q.x, q.y)).off_mm(q.z)
    }
}
