//! Lights as shaders read them, and how each light's map is laid over the scene.

use bytemuck::{Pod, Zeroable};
use cutis_scene::{Light, Object};
use glam::{Vec2, Vec3};

/// In place of a layer: the light has no shadow map.
pub const NO_MAP: u32 = u32::MAX;
/// Largest tangent of half the angle that a map can show: 80°. Lights so close or inside of the scene have none.
const MAX_TANGENT: f32 = 5.7;
/// Times that a map is aimed anew: each leaves a small part of what it is off.
const AIMING_STEPS: usize = 8;
/// Share of the map's width that is left free around the scene.
const MARGIN: f32 = 1.02;

/// One light; the twin of `Light` in `lib/lights.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct GpuLight {
    /// Position, mm.
    pub position_mm: [f32; 3],
    /// 0 directional, 1 point, 2 spot.
    pub kind: u32,
    /// Towards the light if it is directional, along its axis if it is a spot.
    pub dir: [f32; 3],
    /// Radius in mm, or the tangent of the angular radius.
    pub extent: f32,
    /// W/m² if it is directional, else W/sr.
    pub strength: [f32; 3],
    /// Cosine of a spot's inner cone.
    pub cos_inner: f32,
    /// The map's axis to the right.
    pub map_right: [f32; 3],
    /// Cosine of a spot's outer cone.
    pub cos_outer: f32,
    /// The map's axis upwards.
    pub map_up: [f32; 3],
    /// Half the width of the map: in mm, or at distance 1.
    pub map_half_width: f32,
    /// The map's axis away from the light.
    pub map_forward: [f32; 3],
    /// Depth of what is nearest to the light, mm.
    pub map_near_mm: f32,
    /// Where depth begins, mm.
    pub map_origin_mm: [f32; 3],
    /// Depth behind everything, mm.
    pub map_far_mm: f32,
    /// Layer of the maps, or [`NO_MAP`].
    pub map_layer: u32,
    /// Fills up the struct.
    pub pad0: u32,
    /// Fills up the struct.
    pub pad1: u32,
    /// Fills up the struct.
    pub pad2: u32,
}

impl GpuLight {
    /// In place of a light where there is none.
    pub const DARK: Self = Self {
        position_mm: [0.0; 3],
        kind: 1,
        dir: [0.0, 0.0, 1.0],
        extent: 0.0,
        strength: [0.0; 3],
        cos_inner: 0.0,
        map_right: [0.0; 3],
        cos_outer: 0.0,
        map_up: [0.0; 3],
        map_half_width: 0.0,
        map_forward: [0.0; 3],
        map_near_mm: 0.0,
        map_origin_mm: [0.0; 3],
        map_far_mm: 0.0,
        map_layer: NO_MAP,
        pad0: 0,
        pad1: 0,
        pad2: 0,
    };

    /// A light over some objects, whose map is layer `layer`. The map is left out if the light stands among them.
    pub fn new(light: &Light, objects: &[Object], layer: Option<u32>) -> Self {
        let positions = objects.iter().flat_map(|object| object.mesh.positions_mm.iter().copied());
        Self::over_points(light, positions, layer)
    }

    /// A light whose map shows some points.
    pub fn over_points(light: &Light, shown: impl Iterator<Item = Vec3> + Clone, layer: Option<u32>) -> Self {
        let mut gpu = without_map(light);
        let Some(layer) = layer else { return gpu };
        let points = || shown.clone();
        let Some([lo, hi]) = bounds_mm(points()) else { return gpu };
        let centre = 0.5 * (lo + hi);
        let directional = matches!(light, Light::Directional { .. });
        let origin = if directional { centre } else { Vec3::from_array(gpu.position_mm) };
        let forward = match light {
            Light::Directional { dir_to_light, .. } => -*dir_to_light,
            _ => aimed((centre - origin).normalize_or(-Vec3::Y), points().map(|p| p - origin)),
        };
        let (right, up) = forward.any_orthonormal_pair();
        let (mut near, mut far, mut half_width) = (f32::INFINITY, f32::NEG_INFINITY, 0.0f32);
        for p in points().map(|p| p - origin) {
            let depth = p.dot(forward);
            let aside = p.dot(right).abs().max(p.dot(up).abs());
            (near, far) = (near.min(depth), far.max(depth));
            half_width = half_width.max(if directional { aside } else { aside / depth.max(1e-6) });
        }
        if !directional && (near <= 0.0 || half_width > MAX_TANGENT) {
            return gpu;
        }
        // Room for rounding at both ends.
        let slack = 1e-3 * (far - near).max(1.0);
        gpu.map_right = right.to_array();
        gpu.map_up = up.to_array();
        gpu.map_forward = forward.to_array();
        gpu.map_origin_mm = origin.to_array();
        gpu.map_half_width = half_width.max(1e-6) * MARGIN;
        gpu.map_near_mm = if directional { near - slack } else { (near - slack).max(0.5 * near) };
        gpu.map_far_mm = far + slack;
        gpu.map_layer = layer;
        gpu
    }
}

fn without_map(light: &Light) -> GpuLight {
    let mut gpu = GpuLight { map_layer: NO_MAP, ..GpuLight::zeroed() };
    match *light {
        // Refused before anything is uploaded: see GpuRenderer::check.
        Light::Projector(_) => {}
        Light::Directional { dir_to_light, irradiance_w_per_m2, angular_radius_rad } => {
            gpu.dir = dir_to_light.to_array();
            gpu.strength = irradiance_w_per_m2.to_array();
            gpu.extent = angular_radius_rad.tan();
        }
        Light::Point { position_mm, intensity_w_per_sr, radius_mm } => {
            gpu.kind = 1;
            gpu.position_mm = position_mm.to_array();
            gpu.strength = intensity_w_per_sr.to_array();
            gpu.extent = radius_mm;
        }
        Light::Spot {
            position_mm,
            dir_travel,
            intensity_w_per_sr,
            inner_cone_rad,
            outer_cone_rad,
            radius_mm,
        } => {
            gpu.kind = 2;
            gpu.position_mm = position_mm.to_array();
            gpu.dir = dir_travel.to_array();
            gpu.strength = intensity_w_per_sr.to_array();
            gpu.extent = radius_mm;
            gpu.cos_inner = inner_cone_rad.cos();
            gpu.cos_outer = outer_cone_rad.cos();
        }
    }
    gpu
}

/// The direction in which a map shows points around the light with the same room to all sides: one close to the scene sees
/// much more of it to one side of the middle. The first guess, where that does not see all of them.
fn aimed(guess: Vec3, points: impl Iterator<Item = Vec3> + Clone) -> Vec3 {
    let mut forward = guess;
    for _ in 0..AIMING_STEPS {
        let (right, up) = forward.any_orthonormal_pair();
        let (mut lo, mut hi) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        for p in points.clone() {
            let depth = p.dot(forward);
            if depth <= 0.0 {
                return forward;
            }
            let place = Vec2::new(p.dot(right), p.dot(up)) / depth;
            (lo, hi) = (lo.min(place), hi.max(place));
        }
        let middle = (lo.map(f32::atan) + hi.map(f32::atan)) * 0.5;
        forward = (forward + right * middle.x.tan() + up * middle.y.tan()).normalize_or(guess);
    }
    forward
}

/// Smallest box around some points, mm.
pub(super) fn bounds_mm(points: impl Iterator<Item = Vec3>) -> Option<[Vec3; 2]> {
    points.map(|p| [p, p]).reduce(|[lo, hi], [l, h]| [lo.min(l), hi.max(h)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_of_what_lies_to_one_side_is_aimed_there() {
        // A row of points from straight ahead to 80 degrees aside.
        let points = (0..=80).map(|i| {
            let angle = (i as f32).to_radians();
            Vec3::new(angle.sin(), 0.0, angle.cos()) * (1.0 + i as f32)
        });
        let expected = Vec3::new(40f32.to_radians().sin(), 0.0, 40f32.to_radians().cos());
        let forward = aimed(Vec3::new(0.2, 0.1, 1.0).normalize(), points.clone());
        assert!(forward.angle_between(expected) < 0.01, "{forward}");
        // Where some points lie behind, the guess is kept.
        let behind = points.chain([-Vec3::Z]);
        assert_eq!(aimed(Vec3::Z, behind), Vec3::Z);
    }
}
