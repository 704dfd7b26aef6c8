//! Primitives: vertices and triangles, brought to the world in mm and gathered into one mesh per material.

use super::accessor::Accept;
use super::skeleton::{self, Bones};
use super::skin::{self, JointMatrices, Skinned};
use super::{Document, material};
use crate::read::checks::MAX_COUNT;
use crate::read::textures::Textures;
use crate::read::{Piece, Textured};
use crate::skeleton::normal_matrix;
use crate::{Influence, Joint, Mesh, MorphTarget, SceneError};
use glam::{Mat3, Mat4, Vec2, Vec3, Vec4};
use gltf::json::Index;
use gltf::json::mesh::{Mode, MorphTarget as JsonTarget, Primitive, Semantic};
use gltf::json::validation::Checked;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Most offsets that all morph targets of an object may hold together.
const MAX_MORPH_OFFSETS: usize = 50_000_000;

/// Meshes under construction, by material; those without a material come last.
#[derive(Default)]
pub(super) struct Gathering {
    by_material: BTreeMap<usize, Gathered>,
    vertices: usize,
    triangles: usize,
}

#[derive(Default)]
struct Gathered {
    name: String,
    place: String,
    mesh: Mesh,
    /// Whether a primitive came without normals or tangents, so that they must be computed for all.
    lacks_normals: bool,
    lacks_tangents: bool,
    /// Whether one came with texture coordinates.
    has_uvs: bool,
    /// Whether one came without.
    lacks_uvs: bool,
    /// Morph targets that some primitive gives without offsets of normals.
    lacks_normal_offsets: BTreeSet<usize>,
    /// Number of the first joint of each skin.
    first_joint: HashMap<usize, usize>,
}

/// The skin of a node.
struct Skin {
    index: usize,
    matrices: Vec<JointMatrices>,
    /// None where its joints cannot be turned.
    bones: Option<Bones>,
}

/// The matrices of a primitive's vertices.
enum Placement {
    One(Mat4),
    PerVertex(Vec<Mat4>),
}

impl Placement {
    fn of(&self, vertex: usize) -> Mat4 {
        match self {
            Self::One(matrix) => *matrix,
            Self::PerVertex(matrices) => matrices[vertex],
        }
    }
}

impl Gathering {
    /// Adds the mesh of a node.
    pub(super) fn add_node(
        &mut self,
        document: &Document,
        world: &[Mat4],
        node_index: usize,
        mesh_index: Index<gltf::json::Mesh>,
        warnings: &mut Vec<String>,
    ) -> Result<(), SceneError> {
        let root = &document.root;
        let node = &root.nodes[node_index];
        let node_place = format!("nodes[{node_index}]");
        let mesh = document.get(&root.meshes, mesh_index, &format!("{node_place}.mesh"))?;
        let skin = match node.skin {
            Some(index) => Some(Skin::read(document, world, index, &node_place, warnings)?),
            None => None,
        };
        let weights = node.weights.as_ref().or(mesh.weights.as_ref()).map_or(&[][..], Vec::as_slice);
        let names = document.target_names.get(mesh_index.value()).map_or(&[][..], Vec::as_slice);
        for (i, primitive) in mesh.primitives.iter().enumerate() {
            let place = format!("meshes[{}].primitives[{i}]", mesh_index.value());
            let Checked::Valid(mode) = primitive.mode else {
                return document.fail(place, "has an unknown mode");
            };
            if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
                warnings.push(format!("{place}: points and lines are not drawn"));
                continue;
            }
            let reading = Reading { document, primitive, place, weights, names };
            let count = reading.vertex_count()?;
            let skinned = match &skin {
                Some(skin) => reading.skinned(&skin.matrices, count, warnings)?,
                None => None,
            };
            let key = primitive.material.map_or(usize::MAX, |m| m.value());
            let gathered = self.by_material.entry(key).or_insert_with(|| Gathered {
                name: mesh.name.clone().or_else(|| node.name.clone()).unwrap_or(node_place.clone()),
                place: reading.place.clone(),
                ..Gathered::default()
            });
            let before = (gathered.mesh.positions_mm.len(), gathered.mesh.triangles.len());
            let (placement, influences) = match skinned {
                Some(Skinned { matrices, influences }) => (Placement::PerVertex(matrices), influences),
                None => (Placement::One(world[node_index]), Vec::new()),
            };
            reading.append(gathered, mode, &placement)?;
            gathered.follow(before.0, skin.as_ref(), influences, &reading.place, warnings);
            self.vertices += gathered.mesh.positions_mm.len() - before.0;
            self.triangles += gathered.mesh.triangles.len() - before.1;
            if self.vertices > MAX_COUNT || self.triangles > MAX_COUNT {
                let reason = format!("with it there are more than {MAX_COUNT} vertices or triangles");
                return document.fail(node_place, reason);
            }
        }
        Ok(())
    }

    /// The finished meshes with their materials.
    pub(super) fn into_pieces(
        self,
        document: &Document,
        textures: &mut Textures,
        warnings: &mut Vec<String>,
    ) -> Result<Vec<Piece>, SceneError> {
        let mut pieces = Vec::new();
        for (key, mut gathered) in self.by_material {
            if gathered.mesh.triangles.is_empty() {
                continue;
            }
            if gathered.lacks_normals {
                gathered.mesh.normals.clear();
            }
            for slot in gathered.lacks_normal_offsets {
                gathered.mesh.morph_targets[slot].normal_offsets.clear();
            }
            // Tangents of a file belong to its own v direction.
            if gathered.lacks_tangents || document.flip_v {
                gathered.mesh.tangents.clear();
            }
            let material = material::read(document, key, textures, warnings)?;
            let Gathered { name, place, mut mesh, has_uvs, lacks_uvs, .. } = gathered;
            material.uv_transform.apply(&mut mesh);
            let material = material.material;
            let textured = Textured::new(has_uvs, lacks_uvs);
            pieces.push(Piece { name, place, mesh, textured, own_material: material.clone(), material });
        }
        Ok(pieces)
    }
}

impl Skin {
    fn read(
        document: &Document,
        world: &[Mat4],
        index: Index<gltf::json::Skin>,
        node_place: &str,
        warnings: &mut Vec<String>,
    ) -> Result<Self, SceneError> {
        let matrices = skin::joint_matrices(document, world, index, &format!("{node_place}.skin"))?;
        let bones = skeleton::read(document, world, index, &matrices)?;
        let bones = bones.inspect_err(|why| {
            warnings.push(format!("skins[{}]: no pose turns its joints: {why}", index.value()));
        });
        Ok(Self { index: index.value(), matrices, bones: bones.ok() })
    }
}

impl Gathered {
    /// Notes what the vertices from number `base` on follow.
    fn follow(
        &mut self,
        base: usize,
        skin: Option<&Skin>,
        influences: Vec<Influence>,
        place: &str,
        warnings: &mut Vec<String>,
    ) {
        let count = self.mesh.positions_mm.len();
        let bones = skin.and_then(|skin| Some((skin.index, skin.bones.as_ref()?)));
        if let Some((index, bones)) = bones.filter(|_| !influences.is_empty()) {
            let skeleton = self.mesh.skeleton.get_or_insert_default();
            let next = skeleton.joints.len();
            let first = *self.first_joint.entry(index).or_insert(next);
            if first == next && first + bones.joints.len() > usize::from(u16::MAX) {
                self.first_joint.remove(&index);
                warnings.push(format!("{place}: no pose turns its joints: with them there are too many"));
            } else {
                if first == next {
                    skeleton.joints.extend(bones.joints.iter().map(|joint| shifted(joint, first)));
                }
                skeleton.influences.resize(base, Influence::default());
                let renumbered = |joint: u16| bones.number[usize::from(joint)] + first as u16;
                skeleton.influences.extend(
                    influences.into_iter().map(|i| Influence { joints: i.joints.map(renumbered), ..i }),
                );
            }
        }
        if let Some(skeleton) = &mut self.mesh.skeleton {
            skeleton.influences.resize(count, Influence::default());
        }
    }
}

/// A joint behind `first` others.
fn shifted(joint: &Joint, first: usize) -> Joint {
    Joint { parent: joint.parent.map(|parent| parent + first as u16), ..joint.clone() }
}

/// One primitive while it is read.
struct Reading<'a> {
    document: &'a Document<'a>,
    primitive: &'a Primitive,
    place: String,
    weights: &'a [f32],
    names: &'a [String],
}

impl Reading<'_> {
    fn floats<const N: usize>(
        &self,
        semantic: Semantic,
        name: &str,
        accept: Accept,
    ) -> Result<Option<Vec<[f32; N]>>, SceneError> {
        let Some(&index) = self.primitive.attributes.get(&Checked::Valid(semantic)) else { return Ok(None) };
        let place = format!("{}.attributes.{name}", self.place);
        self.document.accessors.read(&self.document.root, index, accept, &place).map(Some)
    }

    fn fail<T>(&self, reason: impl Into<String>) -> Result<T, SceneError> {
        self.document.fail(self.place.clone(), reason)
    }

    fn vertex_count(&self) -> Result<usize, SceneError> {
        let Some(index) = self.primitive.attributes.get(&Checked::Valid(Semantic::Positions)) else {
            return self.fail("has no POSITION");
        };
        let place = format!("{}.attributes.POSITION", self.place);
        let accessor = self.document.get(&self.document.root.accessors, *index, &place)?;
        match usize::try_from(accessor.count.0) {
            Ok(count) if 0 < count && count <= MAX_COUNT => Ok(count),
            _ => self.fail(format!("has {} vertices; 1 to {MAX_COUNT}", accessor.count.0)),
        }
    }

    fn skinned(
        &self,
        joints: &[JointMatrices],
        count: usize,
        warnings: &mut Vec<String>,
    ) -> Result<Option<Skinned>, SceneError> {
        skin::skinned(self.document, self.primitive, joints, count, &self.place, warnings)
    }

    fn append(&self, gathered: &mut Gathered, mode: Mode, placement: &Placement) -> Result<(), SceneError> {
        let base = gathered.mesh.positions_mm.len();
        let Some(positions) = self.floats::<3>(Semantic::Positions, "POSITION", Accept::Float)? else {
            return self.fail("has no POSITION");
        };
        let count = positions.len();
        let mesh = &mut gathered.mesh;
        mesh.positions_mm.extend(
            positions.iter().enumerate().map(|(i, p)| placement.of(i).transform_point3(Vec3::from_array(*p))),
        );
        let has_uvs = self.append_uvs(mesh, count)?;
        gathered.has_uvs |= has_uvs;
        gathered.lacks_uvs |= !has_uvs;
        let normals = self.floats::<3>(Semantic::Normals, "NORMAL", Accept::Float)?;
        gathered.lacks_normals |= normals.is_none();
        let normals = self.one_per_vertex(normals, count, [0.0; 3], "NORMAL")?;
        mesh.normals.extend(
            normals.iter().enumerate().map(|(i, n)| turned_normal(placement.of(i), Vec3::from_array(*n))),
        );
        let tangents = self.floats::<4>(Semantic::Tangents, "TANGENT", Accept::Float)?;
        gathered.lacks_tangents |= tangents.is_none();
        let tangents = self.one_per_vertex(tangents, count, [0.0; 4], "TANGENT")?;
        mesh.tangents.extend(
            tangents.iter().enumerate().map(|(i, t)| turned_tangent(placement.of(i), Vec4::from_array(*t))),
        );
        self.append_targets(gathered, base, count, placement)?;
        let mesh = &mut gathered.mesh;
        self.append_triangles(mesh, base, count, mode, placement)
    }

    fn one_per_vertex<const N: usize>(
        &self,
        values: Option<Vec<[f32; N]>>,
        count: usize,
        missing: [f32; N],
        name: &str,
    ) -> Result<Vec<[f32; N]>, SceneError> {
        match values {
            Some(values) if values.len() != count => {
                self.fail(format!("{name} has {} elements for {count} vertices", values.len()))
            }
            Some(values) => Ok(values),
            None => Ok(vec![missing; count]),
        }
    }

    /// Tells whether there are any.
    fn append_uvs(&self, mesh: &mut Mesh, count: usize) -> Result<bool, SceneError> {
        let set = material::uv_set(self.document, self.primitive.material);
        let name = format!("TEXCOORD_{set}");
        let Some(uvs) = self.floats::<2>(Semantic::TexCoords(set), &name, Accept::FloatOrNormalised)? else {
            mesh.uvs.resize(mesh.uvs.len() + count, Vec2::ZERO);
            return Ok(false);
        };
        let uvs = self.one_per_vertex(Some(uvs), count, [0.0; 2], &name)?;
        let turn = |[u, v]: [f32; 2]| Vec2::new(u, if self.document.flip_v { 1.0 - v } else { v });
        mesh.uvs.extend(uvs.into_iter().map(turn));
        Ok(true)
    }

    fn append_targets(
        &self,
        gathered: &mut Gathered,
        base: usize,
        count: usize,
        placement: &Placement,
    ) -> Result<(), SceneError> {
        let targets = self.primitive.targets.as_deref().unwrap_or_default();
        let mesh = &mut gathered.mesh;
        let slots = mesh.morph_targets.len().max(targets.len());
        if slots.saturating_mul(base + count) > MAX_MORPH_OFFSETS {
            return self.fail(format!("{slots} morph targets of {} vertices are too many", base + count));
        }
        for slot in mesh.morph_targets.len()..slots {
            let given = self.names.get(slot).filter(|name| !name.is_empty());
            mesh.morph_targets.push(MorphTarget {
                name: given.cloned().unwrap_or_else(|| slot.to_string()),
                weight: self.weights.get(slot).copied().filter(|w| w.is_finite()).unwrap_or(0.0),
                ..MorphTarget::default()
            });
        }
        for (slot, morph) in mesh.morph_targets.iter_mut().enumerate() {
            // Primitives that came before without this target stay where they are.
            morph.position_offsets_mm.resize(base, Vec3::ZERO);
            morph.normal_offsets.resize(base, Vec3::ZERO);
            if let Some(target) = targets.get(slot) {
                if target.positions.is_some() && target.normals.is_none() {
                    gathered.lacks_normal_offsets.insert(slot);
                }
                self.append_target(morph, target, count, placement, slot)?;
            }
            morph.position_offsets_mm.resize(base + count, Vec3::ZERO);
            morph.normal_offsets.resize(base + count, Vec3::ZERO);
        }
        Ok(())
    }

    fn append_target(
        &self,
        morph: &mut MorphTarget,
        target: &JsonTarget,
        count: usize,
        placement: &Placement,
        slot: usize,
    ) -> Result<(), SceneError> {
        let document = self.document;
        let place = format!("{}.targets[{slot}]", self.place);
        let read = |index| document.accessors.read::<3>(&document.root, index, Accept::Float, &place);
        let positions = target.positions.map(read).transpose()?;
        let normals = target.normals.map(read).transpose()?;
        if let Some(offsets) = positions {
            let to_world = |matrix: Mat4, offset| matrix.transform_vector3(offset);
            morph.position_offsets_mm.extend(self.offsets(offsets, count, placement, &place, to_world)?);
        }
        if let Some(offsets) = normals {
            let to_world = |matrix, offset| normal_matrix(Mat3::from_mat4(matrix)) * offset;
            morph.normal_offsets.extend(self.offsets(offsets, count, placement, &place, to_world)?);
        }
        Ok(())
    }

    fn offsets(
        &self,
        offsets: Vec<[f32; 3]>,
        count: usize,
        placement: &Placement,
        place: &str,
        to_world: impl Fn(Mat4, Vec3) -> Vec3,
    ) -> Result<Vec<Vec3>, SceneError> {
        if offsets.len() != count || offsets.iter().flatten().any(|x| !x.is_finite()) {
            return self
                .document
                .fail(place, format!("is not one finite offset for each of {count} vertices"));
        }
        let offsets = offsets.into_iter().enumerate();
        Ok(offsets.map(|(i, o)| to_world(placement.of(i), Vec3::from_array(o))).collect())
    }

    fn append_triangles(
        &self,
        mesh: &mut Mesh,
        base: usize,
        count: usize,
        mode: Mode,
        placement: &Placement,
    ) -> Result<(), SceneError> {
        let indices = match self.primitive.indices {
            Some(index) => {
                let place = format!("{}.indices", self.place);
                self.document.accessors.read_indices(&self.document.root, index, &place)?
            }
            None => (0..count as u32).collect(),
        };
        if let Some(bad) = indices.iter().find(|&&i| i as usize >= count) {
            return self.fail(format!("an index names vertex {bad}, but there are {count}"));
        }
        if mode == Mode::Triangles && indices.len() % 3 != 0 {
            return self.fail(format!("{} indices do not make whole triangles", indices.len()));
        }
        let place_triangle = |t: [u32; 3]| {
            // A mirroring transform turns the surface inside out; the other winding turns it back.
            let mirrored = placement.of(t[0] as usize).determinant() < 0.0;
            let t = if mirrored { [t[0], t[2], t[1]] } else { t };
            t.map(|v| v + base as u32)
        };
        mesh.triangles.extend(triangles(mode, &indices).map(place_triangle));
        Ok(())
    }
}

/// The triangles that a list of indices means (glTF 2.0, section 3.7.2.1).
fn triangles(mode: Mode, indices: &[u32]) -> Box<dyn Iterator<Item = [u32; 3]> + '_> {
    let windows = indices.windows(3).enumerate();
    match mode {
        // Every second triangle of a strip runs the other way.
        Mode::TriangleStrip => {
            Box::new(windows.map(|(i, w)| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[0], w[2], w[1]] }))
        }
        Mode::TriangleFan => Box::new(indices.windows(2).skip(1).map(|pair| [pair[0], pair[1], indices[0]])),
        _ => Box::new(indices.chunks_exact(3).map(|c| [c[0], c[1], c[2]])),
    }
}

fn turned_normal(matrix: Mat4, normal: Vec3) -> Vec3 {
    (normal_matrix(Mat3::from_mat4(matrix)) * normal).normalize_or_zero()
}

fn turned_tangent(matrix: Mat4, tangent: Vec4) -> Vec4 {
    let sign = if matrix.determinant() < 0.0 { -1.0 } else { 1.0 };
    let w = if tangent.w < 0.0 { -sign } else { sign };
    matrix.transform_vector3(tangent.truncate()).normalize_or_zero().extend(w)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_the_winding() {
        let all = |mode| triangles(mode, &[0, 1, 2, 3]).collect::<Vec<_>>();
        assert_eq!(all(Mode::TriangleStrip), [[0, 1, 2], [1, 3, 2]]);
        assert_eq!(all(Mode::TriangleFan), [[1, 2, 0], [2, 3, 0]]);
        assert_eq!(triangles(Mode::Triangles, &[4, 5, 6]).collect::<Vec<_>>(), [[4, 5, 6]]);
    }

    #[test]
    fn a_mirrored_normal_still_points_out() {
        let mirror = Mat4::from_scale(Vec3::new(-2.0, 1.0, 1.0));
        assert!((turned_normal(mirror, Vec3::X) + Vec3::X).length() < 1e-6);
        assert!((turned_normal(mirror, Vec3::Z) - Vec3::Z).length() < 1e-6);
    }

    #[test]
    fn normals_stay_perpendicular_under_uneven_scale() {
        let scale = Mat4::from_scale(Vec3::new(1000.0, 10.0, 1.0));
        let (along, normal) = (Vec3::new(1.0, 1.0, 0.0), Vec3::new(1.0, -1.0, 0.0).normalize());
        let cosine = scale.transform_vector3(along).normalize().dot(turned_normal(scale, normal));
        assert!(cosine.abs() < 1e-6, "{cosine}");
    }
}
