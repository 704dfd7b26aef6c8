//! Open meshes made closed: every hole gets a cap.

use crate::topology::{edges, weld};
use crate::{Mesh, Object};
use glam::{Vec2, Vec3};
use std::collections::HashMap;

/// Why a mesh has no inside.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum OpenMesh {
    /// There are holes.
    #[error("it is open: {edges} edges belong to one triangle only, around {holes} holes")]
    Holes {
        /// Edges with a triangle on one side only.
        edges: usize,
        /// Loops they make.
        holes: usize,
    },
    /// Triangles turn their outside to different sides, or too many meet.
    #[error(
        "its outside is not clear: at {edges} edges triangles face opposite ways, or an odd number meets"
    )]
    Twisted {
        /// Such edges.
        edges: usize,
    },
}

/// Whether a mesh encloses a body: along every edge as many triangles run one way as the other.
///
/// # Errors
/// Says what is wrong.
pub fn check_closed(mesh: &Mesh) -> Result<(), OpenMesh> {
    let border = Border::of(mesh)?;
    match border.loops() {
        holes if holes.is_empty() => Ok(()),
        holes => Err(OpenMesh::Holes { edges: border.next.len(), holes: holes.len() }),
    }
}

/// The same object with a flat cap on every hole: a fan of triangles around the middle of its border. The caps are the last
/// triangles of the mesh; their texture coordinates are one point.
///
/// # Errors
/// If holes are not all that is wrong with it.
pub fn close_holes(object: &Object) -> Result<Object, OpenMesh> {
    let holes = Border::of(&object.mesh)?.loops();
    if holes.is_empty() {
        return Ok(object.clone());
    }
    let mut mesh = object.mesh.clone();
    for hole in &holes {
        cap(&mut mesh, hole);
    }
    Ok(Object::new(object.name.clone(), mesh, object.material.clone()))
}

/// Half edges that lack their opposite one.
struct Border {
    /// For the point where the edge of a cap would begin, a vertex there, and the points where such edges end.
    next: Vec<(u32, u32)>,
    vertex_of_point: HashMap<u32, u32>,
}

impl Border {
    fn of(mesh: &Mesh) -> Result<Self, OpenMesh> {
        let point_of_vertex = weld(&mesh.positions_mm);
        let (mut next, mut twisted) = (Vec::new(), 0);
        for ([a, b], uses) in edges(mesh, &point_of_vertex) {
            if a == b {
                continue; // an edge without length
            }
            let mut balance = 0i64;
            for &(triangle, corner) in &uses {
                let vertex = mesh.triangles[triangle as usize][usize::from(corner)];
                let from = point_of_vertex[vertex as usize];
                balance += if from == a { 1 } else { -1 };
            }
            match balance {
                0 => {}
                // The cap runs the other way.
                1 => next.push((b, a)),
                -1 => next.push((a, b)),
                _ => twisted += 1,
            }
        }
        if twisted > 0 {
            return Err(OpenMesh::Twisted { edges: twisted });
        }
        next.sort_unstable();
        // In the order of the triangles: which of several vertices at a point a cap takes its texture from is not left to chance.
        let mut vertex_of_point = HashMap::new();
        for (triangle, corner) in (0..mesh.triangles.len()).flat_map(|t| (0..3).map(move |c| (t, c))) {
            let vertex = mesh.triangles[triangle][corner];
            vertex_of_point.entry(point_of_vertex[vertex as usize]).or_insert(vertex);
        }
        Ok(Self { next, vertex_of_point })
    }

    /// The border as closed loops of vertices.
    fn loops(&self) -> Vec<Vec<u32>> {
        let mut ways: HashMap<u32, Vec<u32>> = HashMap::new();
        for &(from, to) in self.next.iter().rev() {
            ways.entry(from).or_default().push(to);
        }
        let mut loops = Vec::new();
        for &(start, _) in &self.next {
            let (mut points, mut at) = (Vec::new(), start);
            while let Some(to) = ways.get_mut(&at).and_then(Vec::pop) {
                points.push(self.vertex_of_point[&at]);
                at = to;
            }
            if points.len() > 2 {
                loops.push(points);
            }
        }
        loops
    }
}

/// Adds a fan around the middle of a loop of vertices, with vertices of its own.
fn cap(mesh: &mut Mesh, hole: &[u32]) {
    let positions: Vec<Vec3> = hole.iter().map(|&v| mesh.positions_mm[v as usize]).collect();
    let middle = positions.iter().sum::<Vec3>() / positions.len() as f32;
    let place_in = |uvs: &[Vec2]| uvs.get(hole[0] as usize).copied().unwrap_or(Vec2::ZERO);
    let (map_uv, atlas_uv) = (place_in(&mesh.uvs), mesh.atlas_uvs.as_deref().map(place_in));
    for (i, &from) in positions.iter().enumerate() {
        let to = positions[(i + 1) % positions.len()];
        let normal = (from - middle).cross(to - middle).normalize_or(Vec3::Y);
        let base = mesh.positions_mm.len() as u32;
        mesh.positions_mm.extend([middle, from, to]);
        mesh.normals.extend([normal; 3]);
        mesh.uvs.extend([map_uv; 3]);
        if let Some((uvs, uv)) = mesh.atlas_uvs.as_mut().zip(atlas_uv) {
            uvs.extend([uv; 3]);
        }
        mesh.triangles.push([base, base + 1, base + 2]);
    }
    // Computed again for the whole mesh, displacements left behind.
    mesh.tangents.clear();
    mesh.morph_targets.clear();
    mesh.skeleton = None;
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::Material;
    use crate::solids::signed_volume_mm3;

    /// A cube of 2 mm whose vertices are split per face.
    fn cube() -> Mesh {
        let mut mesh = Mesh::default();
        for normal in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|axis| [axis, -axis]) {
            let u = normal.any_orthonormal_vector();
            let v = normal.cross(u);
            let base = mesh.positions_mm.len() as u32;
            mesh.positions_mm.extend([-u - v, u - v, u + v, v - u].map(|p| p + normal));
            mesh.uvs.extend([Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y]);
            mesh.triangles.extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
        }
        mesh
    }

    #[test]
    fn a_cube_without_two_opposite_faces_is_filled_again() {
        let mut mesh = cube();
        mesh.triangles.drain(0..4);
        assert_eq!(check_closed(&mesh), Err(OpenMesh::Holes { edges: 8, holes: 2 }));
        mesh.atlas_uvs = Some(mesh.uvs.iter().map(|uv| 0.5 * *uv).collect());
        let closed = close_holes(&Object::new("cube", mesh, Material::default())).unwrap();
        let half = closed.mesh.uvs.iter().map(|uv| 0.5 * *uv);
        assert!(closed.mesh.in_atlas().iter().zip(half).all(|(atlas, half)| (*atlas - half).length() < 1e-6));
        assert_eq!(check_closed(&closed.mesh), Ok(()));
        assert!(closed.closed);
        // 2³, outwards.
        assert!((signed_volume_mm3(&closed) - 8.0).abs() < 1e-5, "{}", signed_volume_mm3(&closed));
    }

    #[test]
    fn a_face_turned_around_is_told_from_a_hole() {
        let mut mesh = cube();
        assert_eq!(check_closed(&mesh), Ok(()));
        mesh.triangles[0].swap(1, 2);
        assert_eq!(check_closed(&mesh), Err(OpenMesh::Twisted { edges: 3 }));
    }
}
