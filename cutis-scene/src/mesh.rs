//! A triangle mesh as it came from its file: split vertices, millimetres, texture coordinates of its maps and, where those
//! cannot carry light, of an atlas.

use crate::Skeleton;
use glam::{Vec2, Vec3, Vec4};

/// Triangles over vertices. A vertex is one combination of position, normal and UV; points that share a position
/// are found again by [`crate::topology::weld`].
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    /// World positions in mm.
    pub positions_mm: Vec<Vec3>,
    /// Unit normals, pointing out of the body; one per vertex.
    pub normals: Vec<Vec3>,
    /// Unit tangents along +u; `w` is the handedness of the bitangent (MikkTSpace). Empty until computed.
    pub tangents: Vec<Vec4>,
    /// Texture coordinates of the material's maps: (0, 0) is the corner of the image's first pixel, v grows with its rows;
    /// outside the unit square textures repeat.
    pub uvs: Vec<Vec2>,
    /// Where each vertex lies in the maps of light, which need every place once and inside the unit square. `None` where
    /// `uvs` are like that.
    pub atlas_uvs: Option<Vec<Vec2>>,
    /// Vertex indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Displacements that a file offers for this mesh.
    pub morph_targets: Vec<MorphTarget>,
    /// Joints that move it.
    pub skeleton: Option<Skeleton>,
}

/// One named displacement of every vertex.
#[derive(Debug, Clone, Default)]
pub struct MorphTarget {
    /// Name in the file, or its number.
    pub name: String,
    /// Offset of each vertex in mm at weight 1.
    pub position_offsets_mm: Vec<Vec3>,
    /// Offset of each normal at weight 1; where the file has none, [`crate::Object::new`] computes them.
    pub normal_offsets: Vec<Vec3>,
    /// Offset of each tangent at weight 1; computed by [`crate::Object::new`].
    pub tangent_offsets: Vec<Vec3>,
    /// Weight the file starts with.
    pub weight: f32,
}

impl Mesh {
    /// Positions of a triangle's corners, mm.
    pub fn corners_mm(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|v| self.positions_mm[v as usize])
    }

    /// Where each vertex lies in the maps of light.
    pub fn in_atlas(&self) -> &[Vec2] {
        self.atlas_uvs.as_deref().unwrap_or(&self.uvs)
    }

    /// A triangle's corners in the material's maps.
    pub fn corner_map_uvs(&self, triangle: usize) -> [Vec2; 3] {
        self.triangles[triangle].map(|v| self.uvs[v as usize])
    }

    /// A triangle's corners in the maps of light.
    pub fn corner_atlas_uvs(&self, triangle: usize) -> [Vec2; 3] {
        let uvs = self.in_atlas();
        self.triangles[triangle].map(|v| uvs[v as usize])
    }

    /// Area of a triangle in mm².
    pub fn area_mm2(&self, triangle: usize) -> f32 {
        let [a, b, c] = self.corners_mm(triangle);
        0.5 * (b - a).cross(c - a).length()
    }

    /// Smallest box around all positions, mm. `None` for an empty mesh.
    pub fn bounds_mm(&self) -> Option<[Vec3; 2]> {
        let first = *self.positions_mm.first()?;
        Some(self.positions_mm.iter().fold([first, first], |[lo, hi], &p| [lo.min(p), hi.max(p)]))
    }
}
