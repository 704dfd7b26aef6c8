//! How fine the mesh should be where: fine at ears, eyes, nose and mouth, coarse on the cranium.

use super::eyes::EYE_MM;
use super::sculpture::{Sculpture, mirrored};
use super::sdf::{bell, smoothstep};
use glam::Vec3;

/// Wanted length of an edge, relative to other places (mm for a mesh of about 30 thousand triangles).
pub fn edge_length_mm(sculpture: &Sculpture, p: Vec3) -> f32 {
    let side = mirrored(p);
    let on_face = smoothstep(10.0, 45.0, p.z) * smoothstep(-130.0, -105.0, p.y) * smoothstep(60.0, 25.0, p.y);
    let coarse = 6.0 - 2.7 * on_face;
    let towards =
        |middle: Vec3, radii: Vec3, fine: f32| coarse + (fine - coarse) * bell(side - middle, radii).sqrt();
    let eye = towards(EYE_MM + Vec3::Z * 12.0, Vec3::new(17.0, 12.0, 14.0), 0.85);
    let nose = towards(Vec3::new(5.0, -40.0, 98.0), Vec3::new(16.0, 14.0, 16.0), 1.5);
    let mouth = towards(Vec3::new(10.0, -70.0, 90.0), Vec3::new(22.0, 9.0, 20.0), 1.15);
    let ear = if sculpture.ear.near(side) {
        let off_middle = (sculpture.ear.local(side) - Vec3::new(16.0, 0.0, 0.0)).length();
        1.7 + (coarse - 1.7) * smoothstep(31.0, 46.0, off_middle)
    } else {
        coarse
    };
    eye.min(nose).min(mouth).min(ear)
}
