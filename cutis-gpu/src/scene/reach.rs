//! Where a mesh can be in a pose, told from a few boxes: light maps and the camera's depths must hold all of it.
//!
//! What follows joints lies between the places to which each of them alone would take it, for its weights sum to 1. So the
//! corners of boxes around the vertices as they were bound, moved by every joint that one of them follows, hold the mesh.

use cutis_scene::{Mesh, MeshPose};
use glam::{Affine3A, Mat4, Vec3};
use std::collections::HashMap;

/// Boxes along the longest side of the mesh: the corners reach out beyond it by about a sixteenth of that.
const BOXES_ALONG: f32 = 16.0;

/// The boxes of one mesh.
#[derive(Debug)]
pub struct Reach {
    parts: Vec<Part>,
    /// For each morph target the boxes around its offsets.
    targets: Vec<Boxes>,
}

/// Vertices that lie close together and follow the same joint.
#[derive(Debug)]
struct Part {
    /// None: they follow nothing.
    joint: Option<usize>,
    boxes: Boxes,
}

/// Boxes around the same things, mm.
#[derive(Debug, Clone, Copy)]
struct Boxes {
    /// As the mesh rests.
    rest: [Vec3; 2],
    /// As it was bound to its joints.
    bound: [Vec3; 2],
}

impl Boxes {
    fn with(self, rest: Vec3, bound: Vec3) -> Self {
        let around = |[lo, hi]: [Vec3; 2], p: Vec3| [lo.min(p), hi.max(p)];
        Self { rest: around(self.rest, rest), bound: around(self.bound, bound) }
    }
}

impl Reach {
    /// Of a mesh at rest.
    pub fn new(rest: &Mesh) -> Self {
        let joints = rest.skeleton.as_ref().map(|s| s.rest_matrices()).unwrap_or_default();
        let still = vec![Mat4::IDENTITY; joints.len()];
        let unbound: Vec<Affine3A> = match &rest.skeleton {
            Some(s) => s.influences.iter().map(|i| i.posed_from_rest(&joints, &still)).collect(),
            None => vec![Affine3A::IDENTITY; rest.positions_mm.len()],
        };
        let [lo, hi] = rest.bounds_mm().unwrap_or_default();
        let cell_mm = ((hi - lo).max_element() / BOXES_ALONG).max(f32::MIN_POSITIVE);
        let mut parts: HashMap<(Option<usize>, [i32; 3]), Boxes> = HashMap::new();
        for (v, &p) in rest.positions_mm.iter().enumerate() {
            let cell = ((p - lo) / cell_mm).floor().as_ivec3().to_array();
            let bound = unbound[v].transform_point3(p);
            for joint in followed(rest, v) {
                let boxes =
                    parts.entry((joint, cell)).or_insert(Boxes { rest: [p, p], bound: [bound, bound] });
                *boxes = boxes.with(p, bound);
            }
        }
        let none = Boxes { rest: [Vec3::ZERO; 2], bound: [Vec3::ZERO; 2] };
        let target = |offsets: &[Vec3]| {
            let pairs = offsets.iter().zip(&unbound);
            pairs.fold(none, |boxes, (&offset, map)| boxes.with(offset, map.transform_vector3(offset)))
        };
        Self {
            parts: parts.into_iter().map(|((joint, _), boxes)| Part { joint, boxes }).collect(),
            targets: rest.morph_targets.iter().map(|t| target(&t.position_offsets_mm)).collect(),
        }
    }

    /// Points whose convex hull holds the mesh in a pose.
    pub fn corners_mm(&self, pose: &MeshPose) -> Vec<Vec3> {
        let wave = pose.wave.map_or(Vec3::ZERO, |wave| wave.direction * wave.amplitude_mm);
        let mut corners = Vec::with_capacity(16 * self.parts.len());
        for part in &self.parts {
            let joint = part.joint.and_then(|joint| pose.joints.get(joint));
            let posed = joint.map_or(Mat4::IDENTITY, |[_, posed]| *posed);
            let chosen = |boxes: &Boxes| if joint.is_some() { boxes.bound } else { boxes.rest };
            let weighted = self.targets.iter().zip(&pose.morph_weights);
            let [lo, hi] = weighted.fold(chosen(&part.boxes), |[lo, hi], (target, &weight)| {
                let [a, b] = chosen(target).map(|offset| offset * weight);
                [lo + a.min(b), hi + a.max(b)]
            });
            for i in 0..8 {
                let side = |axis: usize| if i >> axis & 1 == 0 { lo[axis] } else { hi[axis] };
                let corner = posed.transform_point3(Vec3::new(side(0), side(1), side(2)));
                corners.extend([corner + wave, corner - wave]);
            }
        }
        corners
    }
}

/// Every joint that a vertex follows, or that it follows none.
fn followed(mesh: &Mesh, v: usize) -> Vec<Option<usize>> {
    let influence = mesh.skeleton.as_ref().map(|skeleton| skeleton.influences[v]).unwrap_or_default();
    let pairs = influence.joints.into_iter().zip(influence.weights);
    let joints: Vec<_> =
        pairs.filter(|(_, weight)| *weight > 0.0).map(|(joint, _)| Some(usize::from(joint))).collect();
    if joints.is_empty() { vec![None] } else { joints }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cutis_scene::{Influence, Joint, Material, MorphTarget, Object, Pose, Skeleton, Wave};
    use glam::Vec2;

    /// A strip along x over two joints, the second of which does not rest as it was bound, with one shape.
    fn strip() -> Object {
        let along = |i: u32| Vec3::new(i as f32, (i % 2) as f32, 0.0);
        let joint = |parent, x: f32, turn: f32| Joint {
            name: "joint".to_owned(),
            parent,
            parent_from_joint: Mat4::from_translation(Vec3::X * 10.0) * Mat4::from_rotation_z(turn),
            joint_from_bind: Mat4::from_translation(Vec3::X * -x),
        };
        let influence = |i: u32| {
            let second = i as f32 / 29.0;
            Influence { joints: [0, 1, 0, 0], weights: [1.0 - second, second, 0.0, 0.0] }
        };
        let mesh = Mesh {
            positions_mm: (0..30).map(along).collect(),
            uvs: (0..30).map(|i| Vec2::new(i as f32 / 30.0, (i % 2) as f32)).collect(),
            triangles: (0..28)
                .map(|i| if i % 2 == 0 { [i, i + 2, i + 1] } else { [i, i + 1, i + 2] })
                .collect(),
            morph_targets: vec![MorphTarget {
                name: "shape".to_owned(),
                position_offsets_mm: (0..30).map(|i| Vec3::Z * (i as f32 - 5.0)).collect(),
                ..MorphTarget::default()
            }],
            skeleton: Some(Skeleton {
                joints: vec![joint(None, 10.0, 0.0), joint(Some(0), 20.0, 0.4)],
                influences: (0..30).map(influence).collect(),
            }),
            ..Mesh::default()
        };
        Object::new("strip", mesh, Material::default())
    }

    #[test]
    fn the_corners_hold_the_mesh_in_every_direction() {
        let object = strip();
        let reach = Reach::new(object.rest());
        let pose = Pose {
            morph_weights: [("shape".to_owned(), -0.7)].into(),
            joint_degrees: [("joint".to_owned(), Vec3::new(10.0, -35.0, 50.0))].into(),
            wave: Some(Wave::sideways(3.0, 20.0, 0.3)),
        };
        for pose in [Pose::default(), pose] {
            let mesh = object.deformed(&pose);
            let corners = reach.corners_mm(&pose.on_mesh(object.rest()));
            for i in 0..200u32 {
                let angle = i as f32 * 0.7;
                let dir = Vec3::new(angle.cos(), angle.sin(), (i as f32 * 0.37).sin() * 2.0);
                let farthest = |points: &[Vec3]| points.iter().map(|p| p.dot(dir)).fold(f32::MIN, f32::max);
                let (held, by) = (farthest(&mesh.positions_mm), farthest(&corners));
                assert!(held <= by + 1e-3, "{dir}: {held} is beyond {by}");
            }
        }
    }
}
