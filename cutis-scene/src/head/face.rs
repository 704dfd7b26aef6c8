//! The features of the face and the order in which they go onto the large forms.

use super::eyes::Eyes;
use super::mouth::Mouth;
use super::nose::Nose;
use super::sdf::soft_abs;
use glam::Vec3;

/// Eyes, nose and mouth.
pub struct Face {
    eyes: Eyes,
    nose: Nose,
    mouth: Mouth,
}

impl Face {
    /// Lays out the curves.
    pub fn new() -> Self {
        Self { eyes: Eyes::new(), nose: Nose::new(), mouth: Mouth::new() }
    }

    /// The head `d` at `p` with its features, mm.
    pub fn add_to(&self, d: f32, p: Vec3) -> f32 {
        // Behind the temples there is nothing to add, and no feature stands out further.
        if p.z < 20.0 || d > 32.0 {
            return d;
        }
        let side = Vec3::new(soft_abs(p.x, 2.0), p.y, p.z);
        let d = self.eyes.add_to(d, side);
        let d = self.nose.add_to(d, p, side);
        self.mouth.add_to(d, p, side)
    }
}
