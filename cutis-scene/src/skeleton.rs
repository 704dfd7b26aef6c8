//! Joints under a mesh: how they hang together, and how much of each a vertex follows (linear blend skinning).
//!
//! A vertex at `p` in the world of the resting joints comes to `B' B⁻¹ p`: `B` is the sum of the joints' matrices at rest,
//! weighted by what the vertex follows of each, `B'` the same sum in the pose. So the resting mesh may be drawn as it is,
//! also where a file's joints do not rest as they were bound.

use glam::{Affine3A, Mat3, Mat3A, Mat4, Quat, Vec3};

/// Most joints a vertex follows.
pub const JOINTS_PER_VERTEX: usize = 4;

/// Joints, and what the vertices follow of them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Skeleton {
    /// Every parent comes before its children.
    pub joints: Vec<Joint>,
    /// One per vertex.
    pub influences: Vec<Influence>,
}

/// One joint at rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Name in the file, or its number.
    pub name: String,
    /// The joint it hangs on; a smaller number than its own.
    pub parent: Option<u16>,
    /// Where it rests: in the axes of its parent, or in the world; mm.
    pub parent_from_joint: Mat4,
    /// From the mesh as it was bound, mm, to the joint's own axes.
    pub joint_from_bind: Mat4,
}

/// What one vertex follows.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Influence {
    /// Numbers of joints.
    pub joints: [u16; JOINTS_PER_VERTEX],
    /// How much of each; they sum to 1, or to 0 for a vertex that no joint moves.
    pub weights: [f32; JOINTS_PER_VERTEX],
}

impl Skeleton {
    /// The matrix of every joint with some of them turned in their own axes: from the mesh as it was bound to the world, mm.
    pub fn matrices(&self, turn: impl Fn(usize) -> Quat) -> Vec<Mat4> {
        let mut world: Vec<Mat4> = Vec::with_capacity(self.joints.len());
        for (j, joint) in self.joints.iter().enumerate() {
            let own = joint.parent_from_joint * Mat4::from_quat(turn(j));
            world.push(joint.parent.map_or(own, |parent| world[usize::from(parent)] * own));
        }
        world.iter().zip(&self.joints).map(|(world, joint)| *world * joint.joint_from_bind).collect()
    }

    /// The matrix of every joint at rest.
    pub fn rest_matrices(&self) -> Vec<Mat4> {
        self.matrices(|_| Quat::IDENTITY)
    }
}

impl Influence {
    /// From a vertex at rest to its place under moved joints. A vertex that follows nothing, or whose matrices at rest
    /// cannot be undone, stays where it is.
    pub fn posed_from_rest(&self, rest: &[Mat4], posed: &[Mat4]) -> Affine3A {
        let blend = |matrices: &[Mat4]| {
            let pairs = self.joints.iter().zip(self.weights);
            pairs.fold(Mat4::ZERO, |sum, (&joint, weight)| sum + matrices[usize::from(joint)] * weight)
        };
        let bound = blend(rest);
        if bound.determinant() == 0.0 {
            return Affine3A::IDENTITY;
        }
        Affine3A::from_mat4(blend(posed)) * Affine3A::from_mat4(bound).inverse()
    }
}

/// Matrix for normals: the inverse transpose up to a positive factor, as cofactors, which need no division.
pub(crate) fn normal_matrix(matrix: impl Into<Mat3>) -> Mat3 {
    let m: Mat3 = matrix.into();
    // Scaled to size one, so that products of three lengths in mm cannot overflow.
    let m = m * m.to_cols_array().iter().fold(f32::MIN_POSITIVE, |a, b| a.max(b.abs())).recip();
    let sign = if m.determinant() < 0.0 { -1.0 } else { 1.0 };
    Mat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis)) * sign
}

/// The matrix for directions of an affine map.
pub(crate) fn linear(map: &Affine3A) -> Mat3 {
    let Mat3A { x_axis, y_axis, z_axis } = map.matrix3;
    Mat3::from_cols(Vec3::from(x_axis), Vec3::from(y_axis), Vec3::from(z_axis))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::FRAC_PI_2;

    /// Two joints along x, the second 10 mm out, bound where they rest.
    fn finger() -> Skeleton {
        let joint = |name: &str, parent, x: f32| Joint {
            name: name.to_owned(),
            parent,
            parent_from_joint: Mat4::from_translation(Vec3::X * 10.0),
            joint_from_bind: Mat4::from_translation(Vec3::X * -x),
        };
        Skeleton { joints: vec![joint("a", None, 10.0), joint("b", Some(0), 20.0)], influences: Vec::new() }
    }

    #[test]
    fn children_follow_their_parents() {
        let finger = finger();
        let rest = finger.rest_matrices();
        let posed = finger.matrices(|_| Quat::from_rotation_z(FRAC_PI_2));
        let tip = Influence { joints: [1, 0, 0, 0], weights: [1.0, 0.0, 0.0, 0.0] };
        // Up by the first joint at (10, 0), from there back by the second at (10, 10).
        let place = tip.posed_from_rest(&rest, &posed).transform_point3(Vec3::X * 25.0);
        assert!((place - Vec3::new(5.0, 10.0, 0.0)).length() < 1e-5, "{place}");
    }

    #[test]
    fn joints_that_rest_turned_from_where_they_were_bound_leave_the_mesh_at_rest() {
        let mut turned = finger();
        turned.joints[1].parent_from_joint *= Mat4::from_rotation_y(0.7);
        let rest = turned.rest_matrices();
        let half = Influence { joints: [0, 1, 0, 0], weights: [0.5, 0.5, 0.0, 0.0] };
        let place = half.posed_from_rest(&rest, &rest).transform_point3(Vec3::new(21.0, 2.0, 3.0));
        assert!((place - Vec3::new(21.0, 2.0, 3.0)).length() < 1e-4, "{place}");
    }

    #[test]
    fn a_vertex_that_follows_nothing_stays() {
        let finger = finger();
        let posed = finger.matrices(|_| Quat::from_rotation_z(1.0));
        let map = Influence::default().posed_from_rest(&finger.rest_matrices(), &posed);
        assert_eq!(map, Affine3A::IDENTITY);
    }
}
