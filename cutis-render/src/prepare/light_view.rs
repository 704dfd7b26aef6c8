//! What a light sees: the square view that maps drawn from it have, laid over some points.

use cutis_scene::Light;
use glam::{Vec2, Vec3};

/// Largest tangent of half the angle that a view can show: 80°. Lights so close or inside of the points have none.
const MAX_TANGENT: f32 = 5.7;
/// Times that a view is aimed anew: each leaves a small part of what it is off.
const AIMING_STEPS: usize = 8;
/// Share of the width that is left free around the points.
const MARGIN: f32 = 1.02;

/// A square view along an axis, from a point or, for a light with one direction, by parallel lines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightView {
    /// Whether the view lines are parallel.
    pub parallel: bool,
    /// Where depth begins, mm: the light, or the middle of the points.
    pub origin_mm: Vec3,
    /// Unit axis to the right.
    pub right: Vec3,
    /// Unit axis upwards.
    pub up: Vec3,
    /// Unit axis away from the light.
    pub forward: Vec3,
    /// Half the width: in mm for parallel lines, else at distance 1.
    pub half_width: f32,
    /// Depth of what is nearest to the light, mm, with some room.
    pub near_mm: f32,
    /// Depth behind everything, mm.
    pub far_mm: f32,
}

impl LightView {
    /// The view of a light that shows all of some points. `None` if there are none, or the light stands among them.
    pub fn over_points(light: &Light, shown: impl Iterator<Item = Vec3> + Clone) -> Option<Self> {
        let points = || shown.clone();
        let [lo, hi] = bounds_mm(points())?;
        let centre = 0.5 * (lo + hi);
        let (parallel, origin_mm, forward) = match *light {
            Light::Directional { dir_to_light, .. } => (true, centre, -dir_to_light),
            Light::Point { position_mm, .. } | Light::Spot { position_mm, .. } => {
                let guess = (centre - position_mm).normalize_or(-Vec3::Y);
                (false, position_mm, aimed(guess, points().map(|p| p - position_mm)))
            }
            Light::Projector(ref projector) => {
                let guess = (centre - projector.position_mm).normalize_or(-Vec3::Y);
                (false, projector.position_mm, aimed(guess, points().map(|p| p - projector.position_mm)))
            }
        };
        let (right, up) = forward.any_orthonormal_pair();
        let (mut near, mut far, mut half_width) = (f32::INFINITY, f32::NEG_INFINITY, 0.0f32);
        for p in points().map(|p| p - origin_mm) {
            let depth = p.dot(forward);
            let aside = p.dot(right).abs().max(p.dot(up).abs());
            (near, far) = (near.min(depth), far.max(depth));
            half_width = half_width.max(if parallel { aside } else { aside / depth.max(1e-6) });
        }
        if !parallel && (near <= 0.0 || half_width > MAX_TANGENT) {
            return None;
        }
        // Room for rounding at both ends.
        let slack = 1e-3 * (far - near).max(1.0);
        Some(Self {
            parallel,
            origin_mm,
            right,
            up,
            forward,
            half_width: half_width.max(1e-6) * MARGIN,
            near_mm: if parallel { near - slack } else { (near - slack).max(0.5 * near) },
            far_mm: far + slack,
        })
    }
}

/// The direction in which a view shows points around the light with the same room to all sides: one close to the scene sees
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
pub fn bounds_mm(points: impl Iterator<Item = Vec3>) -> Option<[Vec3; 2]> {
    points.map(|p| [p, p]).reduce(|[lo, hi], [l, h]| [lo.min(l), hi.max(h)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_view_of_what_lies_to_one_side_is_aimed_there() {
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
