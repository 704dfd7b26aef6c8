//! The whole head as one implicit function.
//!
//! Axes: +x to the head's left (the picture's right), +y up, +z where the face looks; millimetres; chin at y = -115,
//! vertex at +115, eyes near 0. Proportions follow the usual canon (thirds hairline–brow–nose base–chin, eyes at
//! half height) and mean adult measures as remembered from Farkas 1994, not looked up.

use super::ear::Ear;
use super::face::Face;
use super::neck::Neck;
use super::sdf::soft_union;
use super::skull::Skull;
use glam::Vec3;

/// Corners of a box that holds the head, mm.
pub const BOUNDS_MM: [Vec3; 2] = [Vec3::new(-104.0, -204.0, -116.0), Vec3::new(104.0, 124.0, 124.0)];

/// The sculpted head.
pub struct Sculpture {
    skull: Skull,
    neck: Neck,
    face: Face,
    /// The ear of the +x side; the other is its mirror image.
    pub ear: Ear,
}

impl Sculpture {
    /// Prepares the curves.
    pub fn new() -> Self {
        Self { skull: Skull::new(), neck: Neck::new(), face: Face::new(), ear: Ear::new() }
    }

    /// Everything but the ears, mm; negative inside.
    pub fn without_ears(&self, p: Vec3) -> f32 {
        let d = soft_union(self.skull.distance(p), self.neck.distance(p), 18.0);
        let d = self.face.add_to(d, p);
        self.neck.cut_off(d, p)
    }

    /// The head, mm; negative inside.
    pub fn distance(&self, p: Vec3) -> f32 {
        self.ear.add_to(self.without_ears(p), mirrored(p))
    }

    /// Gradient by central differences over `STEP_MM`.
    pub fn gradient(&self, p: Vec3) -> Vec3 {
        /// Fine enough for a lid crease, coarse enough for single precision at 200 mm (1e-5 relative to the step).
        const STEP_MM: f32 = 0.05;
        let slope = |axis: Vec3| self.distance(p + axis * STEP_MM) - self.distance(p - axis * STEP_MM);
        Vec3::new(slope(Vec3::X), slope(Vec3::Y), slope(Vec3::Z)) / (2.0 * STEP_MM)
    }

    /// Moves a point near the surface onto it by `steps` Newton steps along the gradient.
    pub fn project(&self, mut p: Vec3, steps: usize) -> Vec3 {
        for _ in 0..steps {
            let g = self.gradient(p);
            // Never further than 1 mm at once: at a crease the gradient may be nearly zero.
            let step = g * (self.distance(p) / g.length_squared().max(0.05));
            p -= step.clamp_length_max(1.0);
        }
        p
    }

    /// Unit normal out of the head.
    pub fn normal(&self, p: Vec3) -> Vec3 {
        self.gradient(p).normalize_or(Vec3::Z)
    }
}

/// The mirror image with x >= 0.
pub fn mirrored(p: Vec3) -> Vec3 {
    Vec3::new(p.x.abs(), p.y, p.z)
}
