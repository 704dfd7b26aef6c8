//! A mesh made ready to be drawn: welded, charted, with normals and tangents, and its material.

use crate::charts::Charts;
use crate::deform::{complete_targets, deformed};
use crate::tangents::add_tangents;
use crate::topology::{is_closed, smooth_normals, weld};
use crate::{Material, Mesh, ObjectSource, Pose};
use glam::{Vec2, Vec3, Vec4};
use std::sync::Arc;

/// One surface of the scene with one texture atlas.
#[derive(Debug, Clone)]
pub struct Object {
    /// Name for messages.
    pub name: String,
    /// The mesh in its pose; normals and tangents are filled in.
    pub mesh: Mesh,
    /// Point of the welded surface each vertex belongs to.
    pub point_of_vertex: Vec<u32>,
    /// UV charts and seams.
    pub charts: Charts,
    /// Whether the surface encloses a body.
    pub closed: bool,
    /// What it is made of.
    pub material: Material,
    /// Where it came from; none if it was made by code.
    pub source: Option<ObjectSource>,
    /// The pose of the mesh.
    pub(crate) pose: Pose,
    /// The mesh at rest, where it is another.
    pub(crate) rest: Option<Arc<Mesh>>,
}

/// The surface at one place of a triangle.
#[derive(Debug, Clone, Copy)]
pub struct SurfacePoint {
    /// On the flat triangle, mm.
    pub position_mm: Vec3,
    /// The same place lifted towards the smooth surface the normals describe, mm (see [`Object::surface_point`]).
    pub lifted_position_mm: Vec3,
    /// Unit normal of the flat triangle.
    pub flat_normal: Vec3,
    /// Interpolated unit normal.
    pub normal: Vec3,
    /// Interpolated tangent, `w` the handedness.
    pub tangent: Vec4,
    /// Place in the material's maps.
    pub map_uv: Vec2,
    /// Place in the maps of light.
    pub atlas_uv: Vec2,
}

impl Object {
    /// Welds the mesh, finds its charts and computes the normals and tangents it lacks. Morph targets are in by the
    /// weights their file gives them.
    ///
    /// # Panics
    /// If the mesh breaks its invariants: one UV per vertex, indices in range, finite positions. Readers check these.
    pub fn new(name: impl Into<String>, mut mesh: Mesh, material: Material) -> Self {
        let vertices = mesh.positions_mm.len();
        assert!(
            [mesh.uvs.len(), mesh.in_atlas().len()] == [vertices; 2],
            "every vertex has texture coordinates"
        );
        if mesh.normals.len() != mesh.positions_mm.len() {
            mesh.normals = smooth_normals(&mesh, &weld(&mesh.positions_mm));
            // They were offsets from other normals.
            mesh.morph_targets.iter_mut().for_each(|target| target.normal_offsets.clear());
        }
        if mesh.tangents.len() != mesh.positions_mm.len() {
            add_tangents(&mut mesh);
        }
        let point_of_vertex = weld(&mesh.positions_mm);
        complete_targets(&mut mesh, &point_of_vertex);
        let mut object = Self {
            name: name.into(),
            charts: Charts::find(&mesh, &point_of_vertex),
            closed: is_closed(&mesh, &point_of_vertex),
            point_of_vertex,
            mesh,
            material,
            source: None,
            pose: Pose::default(),
            rest: None,
        };
        object.set_pose(&Pose::default());
        object
    }

    /// The mesh as it was read, with its morph targets and joints.
    pub fn rest(&self) -> &Mesh {
        self.rest.as_deref().unwrap_or(&self.mesh)
    }

    /// How the mesh is deformed.
    pub fn pose(&self) -> &Pose {
        &self.pose
    }

    /// The mesh in a pose; names it does not know are passed over.
    pub fn deformed(&self, pose: &Pose) -> Mesh {
        deformed(self.rest(), &pose.on_mesh(self.rest()))
    }

    /// Puts the mesh into a pose, from rest, whatever pose it has; see [`crate::Scene::set_pose`], which knows all objects.
    /// Charts and seams stay: no pose moves texture coordinates or tears the surface.
    pub(crate) fn set_pose(&mut self, pose: &Pose) {
        self.pose = pose.clone();
        let on_mesh = pose.on_mesh(self.rest());
        if on_mesh.is_rest() {
            if let Some(rest) = self.rest.take() {
                self.mesh = Arc::unwrap_or_clone(rest);
            }
            return;
        }
        let posed = deformed(self.rest(), &on_mesh);
        let before = std::mem::replace(&mut self.mesh, posed);
        self.rest.get_or_insert_with(|| Arc::new(before));
    }

    /// Place in the material's maps at barycentric coordinates `(b1, b2)` of a triangle.
    pub fn map_uv_at(&self, triangle: u32, b1: f32, b2: f32) -> Vec2 {
        between(self.mesh.corner_map_uvs(triangle as usize), b1, b2)
    }

    /// Place in the maps of light at barycentric coordinates `(b1, b2)` of a triangle.
    pub fn atlas_uv_at(&self, triangle: u32, b1: f32, b2: f32) -> Vec2 {
        between(self.mesh.corner_atlas_uvs(triangle as usize), b1, b2)
    }

    /// The surface at barycentric coordinates `(b1, b2)` of a triangle (weights of its second and third corner).
    ///
    /// The lifted position is where shadow rays should start: the flat facets of a coarse mesh would otherwise shade
    /// themselves near the terminator. It is the mean, by barycentric weights, of the projections onto the corners'
    /// tangent planes (Hanika 2021, "Hacking the shadow terminator", Ray Tracing Gems II ch. 4).
    pub fn surface_point(&self, triangle: u32, b1: f32, b2: f32) -> SurfacePoint {
        let mesh = &self.mesh;
        let vertices = mesh.triangles[triangle as usize].map(|v| v as usize);
        let weights = [1.0 - b1 - b2, b1, b2];
        let corners = vertices.map(|v| mesh.positions_mm[v]);
        let normals = vertices.map(|v| mesh.normals[v]);
        let mix3 =
            |values: [Vec3; 3]| values[0] * weights[0] + values[1] * weights[1] + values[2] * weights[2];
        let position_mm = mix3(corners);
        let flat_normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or(normals[0]);
        let lift = |i: usize| -normals[i] * (position_mm - corners[i]).dot(normals[i]).min(0.0);
        let tangent = (0..3).fold(Vec4::ZERO, |sum, i| sum + mesh.tangents[vertices[i]] * weights[i]);
        let normal = mix3(normals).normalize_or(flat_normal);
        SurfacePoint {
            position_mm,
            lifted_position_mm: position_mm + mix3([lift(0), lift(1), lift(2)]),
            flat_normal,
            normal,
            tangent: orthonormal_tangent(tangent, normal),
            map_uv: self.map_uv_at(triangle, b1, b2),
            atlas_uv: self.atlas_uv_at(triangle, b1, b2),
        }
    }
}

impl SurfacePoint {
    /// The mean of several points that lie close together on one chart. `None` without any.
    pub fn mean(points: impl Iterator<Item = Self>) -> Option<Self> {
        let add = |a: Self, b: Self| Self {
            position_mm: a.position_mm + b.position_mm,
            lifted_position_mm: a.lifted_position_mm + b.lifted_position_mm,
            flat_normal: a.flat_normal + b.flat_normal,
            normal: a.normal + b.normal,
            tangent: a.tangent + b.tangent,
            map_uv: a.map_uv + b.map_uv,
            atlas_uv: a.atlas_uv + b.atlas_uv,
        };
        let mut count = 0.0;
        let sum = points.inspect(|_| count += 1.0).reduce(add)?;
        let normal = sum.normal.normalize_or(Vec3::Y);
        Some(Self {
            position_mm: sum.position_mm / count,
            lifted_position_mm: sum.lifted_position_mm / count,
            flat_normal: sum.flat_normal.normalize_or(normal),
            normal,
            tangent: orthonormal_tangent(sum.tangent, normal),
            map_uv: sum.map_uv / count,
            atlas_uv: sum.atlas_uv / count,
        })
    }
}

fn between([a, b, c]: [Vec2; 3], b1: f32, b2: f32) -> Vec2 {
    a * (1.0 - b1 - b2) + b * b1 + c * b2
}

fn orthonormal_tangent(tangent: Vec4, normal: Vec3) -> Vec4 {
    let t = tangent.truncate();
    let t = (t - normal * normal.dot(t)).normalize_or(normal.any_orthonormal_vector());
    t.extend(if tangent.w < 0.0 { -1.0 } else { 1.0 })
}
