//! Welded topology: which vertices are one point of the surface, and which triangles meet at its edges.

use crate::Mesh;
use glam::Vec3;
use std::collections::HashMap;

/// For every vertex the number of its point; vertices at the same position share one. Points are numbered in the
/// order of their first vertex.
pub fn weld(positions_mm: &[Vec3]) -> Vec<u32> {
    let mut seen: HashMap<[u32; 3], u32> = HashMap::with_capacity(positions_mm.len());
    let key = |p: Vec3| (p + Vec3::ZERO).to_array().map(f32::to_bits); // + 0 turns -0 into 0
    positions_mm
        .iter()
        .map(|&p| {
            let next = seen.len() as u32;
            *seen.entry(key(p)).or_insert(next)
        })
        .collect()
}

/// An edge between two points, the smaller number first, with the corners (triangle, corner where the edge begins)
/// that use it.
pub type EdgeUses = HashMap<[u32; 2], Vec<(u32, u8)>>;

/// All edges of a welded mesh.
pub fn edges(mesh: &Mesh, point_of_vertex: &[u32]) -> EdgeUses {
    let mut uses: EdgeUses = HashMap::with_capacity(mesh.triangles.len() * 3 / 2);
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let points = triangle.map(|v| point_of_vertex[v as usize]);
        for corner in 0..3u8 {
            let (a, b) = (points[usize::from(corner)], points[(usize::from(corner) + 1) % 3]);
            uses.entry([a.min(b), a.max(b)]).or_default().push((t as u32, corner));
        }
    }
    uses
}

/// Whether every edge is shared by exactly two triangles: the surface encloses a body.
pub fn is_closed(mesh: &Mesh, point_of_vertex: &[u32]) -> bool {
    edges(mesh, point_of_vertex).values().all(|uses| uses.len() == 2)
}

/// Unit normals per vertex, the angle-weighted mean of the triangles around its point (Thürmer & Wüthrich 1998), so
/// that vertices split by a UV seam keep one normal.
pub fn smooth_normals(mesh: &Mesh, point_of_vertex: &[u32]) -> Vec<Vec3> {
    let points = point_of_vertex.iter().max().map_or(0, |&m| m as usize + 1);
    let mut sums = vec![Vec3::ZERO; points];
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let corners = mesh.corners_mm(t);
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
        for i in 0..3 {
            let to_next = (corners[(i + 1) % 3] - corners[i]).normalize_or_zero();
            let to_last = (corners[(i + 2) % 3] - corners[i]).normalize_or_zero();
            let angle_rad = to_next.dot(to_last).clamp(-1.0, 1.0).acos();
            sums[point_of_vertex[triangle[i] as usize] as usize] += normal * angle_rad;
        }
    }
    point_of_vertex.iter().map(|&p| sums[p as usize].normalize_or(Vec3::Y)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tetrahedron whose vertices are split per face.
    fn tetrahedron() -> Mesh {
        let p = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let positions_mm = faces.iter().flatten().map(|&i: &usize| p[i]).collect();
        let triangles = (0..4).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
        Mesh { positions_mm, triangles, ..Mesh::default() }
    }

    #[test]
    fn split_vertices_become_one_point() {
        let points = weld(&tetrahedron().positions_mm);
        assert_eq!(points.iter().max(), Some(&3));
        assert_eq!(weld(&[Vec3::new(0.0, 1.0, 2.0), Vec3::new(-0.0, 1.0, 2.0)]), [0, 0]);
    }

    #[test]
    fn a_tetrahedron_is_closed_until_a_face_is_taken_away() {
        let mut mesh = tetrahedron();
        let points = weld(&mesh.positions_mm);
        assert!(is_closed(&mesh, &points));
        mesh.triangles.pop();
        assert!(!is_closed(&mesh, &points));
    }

    #[test]
    fn smooth_normals_point_out_of_the_body() {
        let mesh = tetrahedron();
        let normals = smooth_normals(&mesh, &weld(&mesh.positions_mm));
        let centre = Vec3::splat(0.25);
        assert!(
            mesh.positions_mm
                .iter()
                .zip(&normals)
                .all(|(&p, n)| n.dot(p - centre) > 0.5 * (p - centre).length())
        );
    }
}
