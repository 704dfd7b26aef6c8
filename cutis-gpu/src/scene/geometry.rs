//! A mesh as shaders fetch it.

use super::charts::chart_code;
use crate::{Gpu, GpuError};
use bytemuck::{Pod, Zeroable};
use cutis_scene::{Mesh, Object};
use glam::Vec2;

/// One vertex; the twin of `Vertex` in `lib/mesh.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Vertex {
    /// Position, mm.
    pub position_mm: [f32; 3],
    /// First coordinate in the material's maps.
    pub map_u: f32,
    /// Unit normal.
    pub normal: [f32; 3],
    /// Second coordinate in the material's maps.
    pub map_v: f32,
    /// Unit tangent, handedness in w.
    pub tangent: [f32; 4],
    /// Place in the maps of light.
    pub atlas_uv: [f32; 2],
    /// Fills up the struct.
    pub pad0: u32,
    /// Fills up the struct.
    pub pad1: u32,
}

/// The mesh of one object.
#[derive(Debug)]
pub struct Geometry {
    /// [`Vertex`] of every vertex.
    pub vertices: wgpu::Buffer,
    /// Three vertices and the chart of every triangle.
    pub triangles: wgpu::Buffer,
    /// The same vertices alone, for draws that need nothing else: each is then looked at once or twice instead of six times.
    pub indices: wgpu::Buffer,
    /// The triangles around every vertex.
    pub fans: wgpu::Buffer,
    /// Squared stretch at every vertex, mm² per unit of the texture.
    pub squared_stretch_mm2: wgpu::Buffer,
    /// Number of vertices.
    pub vertex_count: u32,
    /// Number of triangles.
    pub triangle_count: u32,
}

impl Geometry {
    /// Uploads the mesh of an object.
    ///
    /// # Errors
    /// If it is larger than the device takes.
    pub fn new(gpu: &Gpu, object: &Object) -> Result<Self, GpuError> {
        let mesh = &object.mesh;
        let vertices: Vec<Vertex> = (0..mesh.positions_mm.len()).map(|v| vertex(mesh, v)).collect();
        check_size(gpu, size_of_val(vertices.as_slice()))?;
        let charted = mesh.triangles.iter().zip(&object.charts.of_triangle);
        let triangles: Vec<[u32; 4]> =
            charted.map(|(&[a, b, c], &chart)| [a, b, c, u32::from(chart_code(chart))]).collect();
        check_size(gpu, size_of_val(triangles.as_slice()))?;
        Ok(Self {
            vertices: gpu.storage("vertices", &vertices),
            triangles: gpu.storage("triangles", &triangles),
            indices: gpu.indices("indices", mesh.triangles.as_flattened()),
            fans: gpu.storage("fans", &fans(mesh)),
            squared_stretch_mm2: gpu.storage("squared stretch", &vec![Vec2::ZERO; vertices.len()]),
            vertex_count: vertices.len() as u32,
            triangle_count: triangles.len() as u32,
        })
    }
}

pub(super) fn vertex(mesh: &Mesh, v: usize) -> Vertex {
    let map_uv = mesh.uvs[v];
    Vertex {
        position_mm: mesh.positions_mm[v].to_array(),
        map_u: map_uv.x,
        normal: mesh.normals[v].to_array(),
        map_v: map_uv.y,
        tangent: mesh.tangents[v].to_array(),
        atlas_uv: mesh.in_atlas()[v].to_array(),
        ..Vertex::zeroed()
    }
}

pub(super) fn check_size(gpu: &Gpu, bytes: usize) -> Result<(), GpuError> {
    let limit = gpu.device.limits().max_storage_buffer_binding_size;
    if bytes as u64 > limit {
        return Err(GpuError::TooLarge { what: "the mesh", size: format!("{bytes} bytes"), limit });
    }
    Ok(())
}

/// Where the triangles around each vertex begin in the list itself, and one end more; then the triangles.
fn fans(mesh: &Mesh) -> Vec<u32> {
    let vertices = mesh.positions_mm.len();
    let mut counts = vec![0u32; vertices];
    mesh.triangles.iter().flatten().for_each(|&v| counts[v as usize] += 1);
    let mut list = Vec::with_capacity(vertices + 1 + 3 * mesh.triangles.len());
    let mut next = vertices as u32 + 1;
    for count in &counts {
        list.push(next);
        next += count;
    }
    list.push(next);
    let mut free: Vec<u32> = list[..vertices].to_vec();
    list.resize(next as usize, 0);
    for (triangle, corners) in (0..).zip(&mesh.triangles) {
        for &v in corners {
            list[free[v as usize] as usize] = triangle;
            free[v as usize] += 1;
        }
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fan_lists_the_triangles_around_its_vertex() {
        let mesh = Mesh {
            positions_mm: vec![glam::Vec3::ZERO; 4],
            triangles: vec![[0, 1, 2], [2, 1, 3]],
            ..Mesh::default()
        };
        let list = fans(&mesh);
        let around = |v: usize| list[list[v] as usize..list[v + 1] as usize].to_vec();
        assert_eq!(around(0), [0]);
        assert_eq!(around(1), [0, 1]);
        assert_eq!(around(2), [0, 1]);
        assert_eq!(around(3), [1]);
    }
}
