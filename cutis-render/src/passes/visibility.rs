//! What a light sees: shadows, and the light-facing surface behind a shadowed one.
//!
//! The papers read both from maps drawn from the light; on the CPU they are rays. The translucent shadow map's
//! content (d'Eon, Luebke & Enderton 2007, section 5.2) is the same: depth and texture coordinates of the surface that
//! faces the light. Where the papers can only know the surface nearest to the light, a ray finds the nearest one in
//! front of the shadowed point, whose own shadowing is in its irradiance.

use crate::sampling::{disc, r2_point};
use cutis_scene::{Bvh, Light, Scene, SurfacePoint};
use glam::{Vec2, Vec3};

/// Thinnest that a factor makes a body, mm: no distance at all says that a light is faced.
pub const THINNEST_MM: f32 = 1e-3;

/// A place on the surface where light enters that leaves at the shadowed point.
#[derive(Debug, Clone, Copy)]
pub struct LightFacing {
    /// Object of the place.
    pub object: usize,
    /// Its chart.
    pub chart: u32,
    /// Its place in the maps of light.
    pub atlas_uv: Vec2,
    /// Its unit normal.
    pub normal: Vec3,
    /// Distance m through the body, towards the light, mm.
    pub distance_mm: f32,
    /// Distance d of the paper, corrected by the angle: m where the normals at both ends agree, m cos theta where they
    /// are opposite, mm.
    pub corrected_mm: f32,
}

/// Places of a light's disc that are tried where `samples` are wanted: a light without extent has one.
pub fn places_tried(light: &Light, samples: u32) -> u32 {
    if light.has_extent() { samples } else { 1 }
}

/// Fraction of the light's disc that the point sees, by `samples` rays turned by `shift`.
pub fn visible_fraction(bvh: &Bvh, point: &SurfacePoint, light: &Light, samples: u32, shift: Vec2) -> f32 {
    let samples = places_tried(light, samples);
    let origin = bvh.step_off(point.lifted_position_mm, point.flat_normal);
    let seen = (0..samples).filter(|&i| {
        let place = if light.has_extent() { disc(r2_point(i, shift)) } else { Vec2::ZERO };
        let towards = light.sample_disc(origin, place);
        !bvh.occluded(origin, towards.dir_to_light, towards.distance_mm)
    });
    seen.count() as f32 / samples as f32
}

/// Distance through a body that counts, mm: what was measured times the material's factor.
pub fn scaled_mm(distance_mm: f32, thickness_scale: f32) -> f32 {
    (distance_mm * thickness_scale).max(distance_mm.min(THINNEST_MM))
}

/// Whether the smooth surface faces the light.
pub fn faces(point: &SurfacePoint, light: &Light) -> bool {
    point.normal.dot(light.sample(point.position_mm).dir_to_light) >= 0.0
}

/// The light-facing surface behind a point that faces away from the light: where a ray towards the light leaves the
/// body. `None` if the point faces the light, or the ray never leaves (open meshes).
pub fn light_facing_surface(
    scene: &Scene,
    bvh: &Bvh,
    point: &SurfacePoint,
    light: &Light,
) -> Option<LightFacing> {
    if faces(point, light) {
        return None;
    }
    let towards = light.sample(point.position_mm);
    let origin = bvh.step_off(point.position_mm, -point.flat_normal);
    let hit = bvh.closest(origin, towards.dir_to_light, towards.distance_mm)?;
    let object = &scene.objects[hit.object as usize];
    let there = object.surface_point(hit.triangle, hit.b1, hit.b2);
    let cos = point.normal.dot(towards.dir_to_light).abs();
    let opposite = (-there.normal.dot(point.normal)).max(0.0);
    Some(LightFacing {
        object: hit.object as usize,
        chart: object.charts.of_triangle[hit.triangle as usize],
        atlas_uv: there.atlas_uv,
        normal: there.normal,
        distance_mm: hit.distance_mm,
        corrected_mm: hit.distance_mm * (1.0 + (cos - 1.0) * opposite),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scale_of_one_changes_no_bit_and_none_makes_a_body_a_light() {
        for step in 0..4000 {
            let d_mm = 1e-6 * 1.01f32.powi(step % 2000) * if step < 2000 { 1.0 } else { 0.999 };
            assert_eq!(scaled_mm(d_mm, 1.0).to_bits(), d_mm.to_bits(), "{d_mm}");
            assert!((scaled_mm(d_mm, 3.0) / (3.0 * d_mm) - 1.0).abs() < 1e-6);
            assert!(scaled_mm(d_mm, 0.0) > 0.0 && scaled_mm(d_mm, 0.0) <= THINNEST_MM);
        }
        assert_eq!(scaled_mm(0.0, 1e6), 0.0);
    }
}
