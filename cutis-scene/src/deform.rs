//! Meshes in a pose: shapes, then joints, then the wave. The twin of cutis-gpu's pass `deform`.
//!
//! Positions are exact. Normals and tangents are so for the wave (its derivative is known), and for morph targets at the
//! weights 0 and 1; between, they are blended as a file's own normal offsets are. Under joints they follow the blended
//! matrix of their vertex, as usual for linear blend skinning: that weights change from vertex to vertex is left out.

use crate::pose::{MeshPose, Wave};
use crate::skeleton::{Skeleton, linear, normal_matrix};
use crate::topology::smooth_normals;
use crate::{Mesh, MorphTarget};
use glam::{Mat3, Mat4, Vec3, Vec4};
use rayon::prelude::*;

/// A vertex without its texture coordinates, which no pose moves.
#[derive(Debug, Clone, Copy)]
struct Frame {
    position_mm: Vec3,
    normal: Vec3,
    tangent: Vec4,
}

/// The mesh in a pose. It is a plain mesh: morph targets and joints stay behind with the one at rest.
///
/// # Panics
/// If the mesh lacks normals or tangents, or the pose was made for another mesh.
pub fn deformed(rest: &Mesh, pose: &MeshPose) -> Mesh {
    assert_eq!(rest.tangents.len(), rest.positions_mm.len(), "tangents are deformed, too");
    assert_eq!(rest.morph_targets.len(), pose.morph_weights.len(), "one weight for each morph target");
    let (at_rest, posed): (Vec<Mat4>, Vec<Mat4>) =
        pose.joints.iter().map(|&[rest, posed]| (rest, posed)).unzip();
    let frame = |v: usize| {
        let resting =
            Frame { position_mm: rest.positions_mm[v], normal: rest.normals[v], tangent: rest.tangents[v] };
        let mut frame = morphed(rest, &pose.morph_weights, v, resting);
        if let Some(skeleton) = rest.skeleton.as_ref().filter(|_| !at_rest.is_empty()) {
            frame = skinned(skeleton, [&at_rest, &posed], v, frame);
        }
        frame = pose.wave.map_or(frame, |wave| waved(&wave, frame));
        // Matrices of a hostile file may overflow; such a vertex does not move.
        if frame.position_mm.is_finite() { mended(frame, resting) } else { resting }
    };
    let frames: Vec<Frame> = (0..rest.positions_mm.len()).into_par_iter().map(frame).collect();
    Mesh {
        positions_mm: frames.iter().map(|f| f.position_mm).collect(),
        normals: frames.iter().map(|f| f.normal).collect(),
        tangents: frames.iter().map(|f| f.tangent).collect(),
        uvs: rest.uvs.clone(),
        atlas_uvs: rest.atlas_uvs.clone(),
        triangles: rest.triangles.clone(),
        morph_targets: Vec::new(),
        skeleton: None,
    }
}

fn morphed(mesh: &Mesh, weights: &[f32], v: usize, frame: Frame) -> Frame {
    let Frame { mut position_mm, mut normal, mut tangent } = frame;
    for (target, &weight) in mesh.morph_targets.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
        position_mm += target.position_offsets_mm[v] * weight;
        normal += target.normal_offsets[v] * weight;
        tangent += (target.tangent_offsets[v] * weight).extend(0.0);
    }
    Frame { position_mm, normal, tangent }
}

fn skinned(skeleton: &Skeleton, [rest, posed]: [&[Mat4]; 2], v: usize, frame: Frame) -> Frame {
    let map = skeleton.influences[v].posed_from_rest(rest, posed);
    let directions = linear(&map);
    // A joint that mirrors turns the bitangent around.
    let w = frame.tangent.w * if directions.determinant() < 0.0 { -1.0 } else { 1.0 };
    Frame {
        position_mm: map.transform_point3(frame.position_mm),
        normal: normal_matrix(directions) * frame.normal,
        tangent: (directions * frame.tangent.truncate()).extend(w),
    }
}

/// The derivative of the displacement is `1 + s direction travelᵀ`; its cofactors, which normals follow, are
/// `(1 + s direction·travel) - s travel directionᵀ`.
fn waved(wave: &Wave, frame: Frame) -> Frame {
    let (displacement_mm, slope) = wave.at(frame.position_mm);
    let Wave { direction, travel, .. } = *wave;
    let (normal, tangent) = (frame.normal, frame.tangent.truncate());
    let stretch = 1.0 + slope * direction.dot(travel);
    Frame {
        position_mm: frame.position_mm + direction * displacement_mm,
        normal: normal * stretch - travel * (slope * direction.dot(normal)),
        tangent: (tangent + direction * (slope * travel.dot(tangent))).extend(frame.tangent.w),
    }
}

/// Normal and tangent made unit vectors again, at a right angle. A vertex that nothing has moved keeps its bits.
fn mended(frame: Frame, resting: Frame) -> Frame {
    if frame.normal == resting.normal && frame.tangent == resting.tangent {
        return frame;
    }
    let normal = frame.normal.normalize_or(resting.normal);
    let along = frame.tangent.truncate();
    let tangent = (along - normal * normal.dot(along)).normalize_or(normal.any_orthonormal_vector());
    Frame { normal, tangent: tangent.extend(frame.tangent.w), ..frame }
}

/// Gives each morph target what its file leaves out: how normals and tangents differ when it is all the way in.
pub(crate) fn complete_targets(mesh: &mut Mesh, point_of_vertex: &[u32]) {
    let mut targets = std::mem::take(&mut mesh.morph_targets);
    if !targets.is_empty() {
        let resting = axes(mesh, mesh, point_of_vertex);
        let bare = &*mesh;
        targets.par_iter_mut().for_each(|target| complete(bare, point_of_vertex, &resting, target));
    }
    mesh.morph_targets = targets;
}

fn complete(mesh: &Mesh, point_of_vertex: &[u32], resting: &[Mat3], target: &mut MorphTarget) {
    let vertices = mesh.positions_mm.len();
    target.position_offsets_mm.resize(vertices, Vec3::ZERO);
    let moved = mesh.positions_mm.iter().zip(&target.position_offsets_mm).map(|(p, offset)| p + offset);
    let moved = Mesh { positions_mm: moved.collect(), triangles: mesh.triangles.clone(), ..Mesh::default() };
    // Normals and tangents of a file may differ from those of its triangles; they turn as much as these.
    let axes = axes(mesh, &moved, point_of_vertex);
    let turns = axes.iter().zip(resting).map(|(now, before)| *now * before.transpose());
    let offset = |(turn, own): (Mat3, Vec3)| turn * own - own;
    if target.normal_offsets.len() != vertices {
        target.normal_offsets = turns.clone().zip(mesh.normals.iter().copied()).map(offset).collect();
    }
    if target.tangent_offsets.len() != vertices {
        target.tangent_offsets = turns.zip(mesh.tangents.iter().map(|t| t.truncate())).map(offset).collect();
    }
}

/// Three unit vectors at right angles for every vertex, as the triangles tell them: where they carry its tangent, aside, and
/// its normal.
fn axes(rest: &Mesh, moved: &Mesh, point_of_vertex: &[u32]) -> Vec<Mat3> {
    let normals = smooth_normals(moved, point_of_vertex);
    let axes = |(normal, along): (Vec3, Vec3)| {
        let along = (along - normal * normal.dot(along)).normalize_or(normal.any_orthonormal_vector());
        Mat3::from_cols(along, normal.cross(along), normal)
    };
    normals.into_iter().zip(carried_tangents(rest, moved)).map(axes).collect()
}

/// Where the triangles around every vertex carry its tangent: the mean by their areas.
fn carried_tangents(rest: &Mesh, moved: &Mesh) -> impl Iterator<Item = Vec3> {
    let mut sums = vec![Vec3::ZERO; rest.positions_mm.len()];
    for (t, triangle) in rest.triangles.iter().enumerate() {
        let edges = |[a, b, c]: [Vec3; 3]| [b - a, c - a];
        let ([d, e], [to_d, to_e]) = (edges(rest.corners_mm(t)), edges(moved.corners_mm(t)));
        // A direction in the triangle is x d + y e, by the normal equations.
        let (dd, de, ee) = (d.dot(d), d.dot(e), e.dot(e));
        let determinant = dd * ee - de * de;
        if determinant <= 0.0 {
            continue;
        }
        for &v in triangle {
            let tangent = rest.tangents[v as usize].truncate();
            let (along_d, along_e) = (tangent.dot(d), tangent.dot(e));
            let x = (along_d * ee - along_e * de) / determinant;
            let y = (along_e * dd - along_d * de) / determinant;
            sums[v as usize] += (to_d * x + to_e * y) * determinant.sqrt();
        }
    }
    sums.into_iter()
}
