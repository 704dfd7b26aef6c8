//! Where on the head skin is different: lips, brows, lash lines, cheeks, nose, ears, the shiny parts.

use super::eyes::{EYE_MM, LASH_LINE_MM};
use super::mouth::MOUTH_LINE_MM;
use super::sculpture::{Sculpture, mirrored};
use super::sdf::{Curve2, bell, smoothstep};
use glam::{Vec2, Vec3};

/// How much of each kind of skin a place is, 0 to 1.
#[derive(Debug, Clone, Copy, Default)]
pub struct Areas {
    /// Red of the lips.
    pub lips: f32,
    /// The line between the lips.
    pub mouth_line: f32,
    /// Hair of the eyebrows.
    pub brow: f32,
    /// Lashes along the lids.
    pub lashes: f32,
    /// Thin skin of lids and under the eyes.
    pub eye: f32,
    /// Well-supplied skin: cheeks, tip of the nose, ears, chin.
    pub flushed: f32,
    /// Bone right below: forehead, temples.
    pub pale: f32,
    /// Large pores: nose and the cheeks beside it.
    pub porous: f32,
    /// Oily skin: forehead, nose, chin.
    pub oily: f32,
}

/// Finds the areas.
pub struct AreaFinder<'a> {
    sculpture: &'a Sculpture,
    lips: Curve2,
    mouth_line: Curve2,
    brow: Curve2,
    lash_line: Curve2,
}

impl<'a> AreaFinder<'a> {
    /// Lays out the outlines, seen from the front, mm.
    pub fn new(sculpture: &'a Sculpture) -> Self {
        Self {
            sculpture,
            lips: Curve2::closed(&[
                [-4.5, -61.6],
                [0.0, -62.9],
                [4.5, -61.6],
                [13.0, -64.4],
                [21.0, -68.2],
                [26.3, -71.0],
                [21.0, -74.8],
                [14.0, -78.6],
                [7.0, -80.8],
                [-7.0, -80.8],
            ]),
            mouth_line: Curve2::open(&MOUTH_LINE_MM),
            brow: Curve2::open(&[[11.0, 14.5], [20.0, 18.5], [32.0, 22.0], [43.0, 20.5], [52.0, 14.0]]),
            lash_line: Curve2::open(&LASH_LINE_MM),
        }
    }

    /// The areas at a point of the surface.
    pub fn at(&self, p: Vec3) -> Areas {
        let side = mirrored(p);
        let at = |x: f32, y: f32, z: f32, rx: f32, ry: f32, rz: f32| {
            bell(side - Vec3::new(x, y, z), Vec3::new(rx, ry, rz))
        };
        let nose = at(0.0, -34.0, 102.0, 15.0, 15.0, 18.0);
        let forehead = at(0.0, 50.0, 88.0, 42.0, 30.0, 30.0);
        let chin = at(0.0, -102.0, 90.0, 15.0, 12.0, 14.0);
        let cheek = at(42.0, -34.0, 66.0, 19.0, 17.0, 26.0);
        let beside_nose = at(21.0, -30.0, 82.0, 14.0, 16.0, 18.0);
        let mut areas = Areas {
            flushed: (0.9 * cheek
                + 0.9 * at(0.0, -38.0, 105.0, 15.0, 11.0, 14.0)
                + 0.4 * chin
                + self.ear(side))
            .min(1.0),
            pale: (forehead + at(58.0, 20.0, 45.0, 20.0, 24.0, 25.0)).min(1.0),
            porous: (nose + beside_nose + 0.5 * cheek + 0.3 * chin + 0.25 * forehead).min(1.0),
            oily: (forehead + nose + 0.6 * chin).min(1.0),
            eye: (at(31.0, -2.0, 78.0, 20.0, 11.0, 14.0) + 0.8 * at(29.0, -14.0, 76.0, 15.0, 6.0, 12.0))
                .min(1.0),
            ..Areas::default()
        };
        if p.z > 45.0 {
            self.draw_lines(&mut areas, Vec2::new(side.x, side.y));
        }
        areas
    }

    fn ear(&self, side: Vec3) -> f32 {
        if !self.sculpture.ear.near(side) {
            return 0.0;
        }
        let q = self.sculpture.ear.local(side);
        let within = smoothstep(36.0, 28.0, (q - Vec3::new(17.0, 0.0, 0.0)).length());
        0.8 * within * smoothstep(-3.0, 4.0, q.x) * smoothstep(-16.0, -8.0, q.z)
    }

    fn draw_lines(&self, areas: &mut Areas, q: Vec2) {
        if q.y < -50.0 && q.y > -92.0 {
            areas.lips = smoothstep(0.7, -0.9, self.lips.signed_distance(q));
            areas.mouth_line = (-(self.mouth_line.distance(q) / 0.8).powi(2)).exp();
        }
        if q.y > 0.0 && q.y < 36.0 {
            // Fuller at the inner end, thinning out towards the temple.
            let half_width = 4.6 * smoothstep(60.0, 22.0, q.x) + 0.8;
            let along = smoothstep(7.0, 15.0, q.x) * smoothstep(55.0, 46.0, q.x);
            areas.brow = along * smoothstep(half_width, 0.3 * half_width, self.brow.distance(q));
        }
        let eye = q - Vec2::new(EYE_MM.x, EYE_MM.y);
        if eye.length() < 24.0 {
            areas.lashes = (-(self.lash_line.distance(eye) / 0.85).powi(2)).exp();
        }
    }
}
