//! Tangent frames as every normal-map baker means them: MikkTSpace (Mikkelsen 2008), by `bevy_mikktspace`.

use crate::Mesh;
use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::Vec4;

/// Fills in the tangents. A vertex whose triangles disagree about the handedness (mirrored texture) is split, so the
/// mesh may gain vertices at its end; existing numbers stay valid.
///
/// # Panics
/// If normals or texture coordinates are missing.
pub fn add_tangents(mesh: &mut Mesh) {
    assert_eq!(mesh.normals.len(), mesh.positions_mm.len(), "tangents need normals");
    let mut corners = Corners { mesh, tangents: vec![Vec4::X; 3 * mesh.triangles.len()] };
    // The error type has no values; a failure would leave the frames along +x, which are still frames.
    let _: Result<(), _> = generate_tangents(&mut corners);
    let tangents = corners.tangents;
    mesh.tangents = vec![Vec4::ZERO; mesh.positions_mm.len()];
    let mut mirrored = std::collections::HashMap::new();
    for (i, &tangent) in tangents.iter().enumerate() {
        let mut vertex = mesh.triangles[i / 3][i % 3];
        let sum = mesh.tangents[vertex as usize];
        if sum.w * tangent.w < 0.0 {
            vertex = *mirrored.entry(vertex).or_insert_with(|| split(mesh, vertex));
            mesh.triangles[i / 3][i % 3] = vertex;
        }
        let sum = &mut mesh.tangents[vertex as usize];
        *sum = (sum.truncate() + tangent.truncate()).extend(tangent.w);
    }
    for (tangent, normal) in mesh.tangents.iter_mut().zip(&mesh.normals) {
        let direction = tangent.truncate().normalize_or(normal.any_orthonormal_vector());
        *tangent = direction.extend(if tangent.w < 0.0 { -1.0 } else { 1.0 });
    }
}

/// Copies a vertex to the end of the mesh, without its tangent, and returns its number.
fn split(mesh: &mut Mesh, vertex: u32) -> u32 {
    let v = vertex as usize;
    mesh.positions_mm.push(mesh.positions_mm[v]);
    mesh.normals.push(mesh.normals[v]);
    mesh.uvs.push(mesh.uvs[v]);
    if let Some(uvs) = &mut mesh.atlas_uvs {
        uvs.push(uvs[v]);
    }
    mesh.tangents.push(Vec4::ZERO);
    for target in &mut mesh.morph_targets {
        target.position_offsets_mm.push(target.position_offsets_mm[v]);
        if let Some(&offset) = target.normal_offsets.get(v) {
            target.normal_offsets.push(offset);
        }
    }
    if let Some(skeleton) = &mut mesh.skeleton {
        skeleton.influences.push(skeleton.influences[v]);
    }
    mesh.positions_mm.len() as u32 - 1
}

/// The mesh as the generator reads it, and a tangent for each corner of each triangle.
struct Corners<'a> {
    mesh: &'a Mesh,
    tangents: Vec<Vec4>,
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.triangles[face][corner] as usize
    }
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.positions_mm[self.vertex(face, corner)].to_array()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.normals[self.vertex(face, corner)].to_array()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        // MikkTSpace and glTF count v upwards for the bitangent; the mesh counts it downwards with the image rows.
        let uv = self.mesh.uvs[self.vertex(face, corner)];
        [uv.x, 1.0 - uv.y]
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        if let Some(space) = space {
            self.tangents[3 * face + corner] = Vec4::from_array(space.tangent_encoded());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Vec2, Vec3};

    /// A square in the xy plane facing +z, its image upright: u along +x, v along -y.
    fn square() -> Mesh {
        Mesh {
            positions_mm: vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y],
            normals: vec![Vec3::Z; 4],
            uvs: vec![Vec2::new(0.0, 1.0), Vec2::ONE, Vec2::new(1.0, 0.0), Vec2::ZERO],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        }
    }

    #[test]
    fn an_upright_image_has_a_right_handed_frame() {
        let mut mesh = square();
        add_tangents(&mut mesh);
        assert!(mesh.tangents.iter().all(|t| (*t - Vec4::new(1.0, 0.0, 0.0, 1.0)).length() < 1e-6));
    }

    #[test]
    fn a_mirrored_half_gets_its_own_vertices() {
        let mut mesh = square();
        // A second square below, mirrored in the texture about the shared edge 0–1.
        mesh.positions_mm.extend([Vec3::new(0.0, -1.0, 0.0), Vec3::new(1.0, -1.0, 0.0)]);
        mesh.normals.extend([Vec3::Z; 2]);
        mesh.uvs.extend([Vec2::ZERO, Vec2::new(1.0, 0.0)]);
        mesh.triangles.extend([[0, 4, 5], [0, 5, 1]]);
        mesh.atlas_uvs = Some((0..6).map(|v| Vec2::splat(v as f32)).collect());
        add_tangents(&mut mesh);
        assert_eq!(mesh.positions_mm.len(), 8, "the two shared vertices are split");
        assert_eq!(mesh.in_atlas()[6..], [Vec2::ZERO, Vec2::ONE], "where they were in the atlas");
        for t in &mesh.triangles {
            let signs = t.map(|v| mesh.tangents[v as usize].w);
            assert!(signs.iter().all(|&w| w == signs[0]), "{signs:?}");
        }
    }
}
