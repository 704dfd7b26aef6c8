//! What a mesh needs to be deformed on the device: itself at rest, offsets of its shapes, joints. A pose is a few numbers.

use super::geometry::{Vertex, check_size, vertex};
use crate::{Gpu, GpuError};
use bytemuck::{Pod, Zeroable};
use cutis_scene::skeleton::JOINTS_PER_VERTEX;
use cutis_scene::{Mesh, MeshPose, Wave};
use glam::Vec3;

/// The numbers of a pose; the twin of `Deformation` in `deform.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Deformation {
    /// Along which the wave displaces.
    pub wave_direction: [f32; 3],
    /// 0 without a wave.
    pub wave_amplitude_mm: f32,
    /// Along which crests follow each other.
    pub wave_travel: [f32; 3],
    /// From crest to crest.
    pub wavelength_mm: f32,
    /// At the origin.
    pub wave_phase_rad: f32,
    /// 1 where joints are turned.
    pub turned: u32,
    /// 1 where shapes are in.
    pub morphed: u32,
    /// Fills up the struct.
    pub pad0: u32,
}

/// What one shape does to one vertex; the twin of `Offset`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Offset {
    /// At weight 1, mm.
    pub position_mm: [f32; 3],
    /// Number of the shape.
    pub morph_target: u32,
    /// At weight 1.
    pub normal: [f32; 3],
    /// Fills up the struct.
    pub pad0: u32,
    /// At weight 1.
    pub tangent: [f32; 3],
    /// Fills up the struct.
    pub pad1: u32,
}

/// What a vertex follows; the twin of `Influence`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct GpuInfluence {
    /// Numbers of joints.
    pub joints: [u32; JOINTS_PER_VERTEX],
    /// How much of each.
    pub weights: [f32; JOINTS_PER_VERTEX],
}

/// A joint's matrices from the mesh as it was bound to the world, mm; the twin of `JointPair`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct JointPair {
    /// At rest.
    pub rest: [f32; 16],
    /// In the pose.
    pub posed: [f32; 16],
}

/// The buffers of one mesh.
#[derive(Debug)]
pub struct Deformable {
    /// [`Deformation`].
    pub numbers: wgpu::Buffer,
    /// Every vertex at rest.
    pub rest: wgpu::Buffer,
    /// Where the offsets of every vertex begin, and one end more.
    pub first_offsets: wgpu::Buffer,
    /// [`Offset`]s, vertex by vertex; vertices that a shape leaves alone have none.
    pub offsets: wgpu::Buffer,
    /// Weight of every shape.
    pub morph_weights: wgpu::Buffer,
    /// [`GpuInfluence`] of every vertex.
    pub influences: wgpu::Buffer,
    /// [`JointPair`] of every joint.
    pub joints: wgpu::Buffer,
}

impl Deformable {
    /// Uploads a mesh at rest.
    ///
    /// # Errors
    /// If it is larger than the device takes.
    pub fn new(gpu: &Gpu, rest: &Mesh) -> Result<Self, GpuError> {
        let vertices: Vec<Vertex> = (0..rest.positions_mm.len()).map(|v| vertex(rest, v)).collect();
        let (first_offsets, offsets) = offsets(rest);
        check_size(gpu, size_of_val(offsets.as_slice()))?;
        let skeleton = rest.skeleton.as_ref();
        let influences: Vec<GpuInfluence> = skeleton
            .iter()
            .flat_map(|skeleton| &skeleton.influences)
            .map(|i| GpuInfluence { joints: i.joints.map(u32::from), weights: i.weights })
            .collect();
        check_size(gpu, size_of_val(influences.as_slice()))?;
        let joints = skeleton.map_or(0, |skeleton| skeleton.joints.len());
        Ok(Self {
            numbers: gpu.uniform("pose", &Deformation::zeroed()),
            rest: gpu.storage("vertices at rest", &vertices),
            first_offsets: gpu.storage("first offsets", &first_offsets),
            offsets: gpu.storage("offsets", &offsets),
            morph_weights: gpu.storage("morph weights", &vec![0f32; rest.morph_targets.len()]),
            influences: gpu.storage("influences", &influences),
            joints: gpu.storage("joints", &vec![JointPair::zeroed(); joints]),
        })
    }

    /// Writes the numbers of a pose, for the next time the pass runs.
    pub fn write(&self, gpu: &Gpu, pose: &MeshPose) {
        gpu.queue.write_buffer(&self.numbers, 0, bytemuck::bytes_of(&deformation(pose)));
        if !pose.morph_weights.is_empty() {
            gpu.queue.write_buffer(&self.morph_weights, 0, bytemuck::cast_slice(&pose.morph_weights));
        }
        if !pose.joints.is_empty() {
            let pairs = pose
                .joints
                .iter()
                .map(|[rest, posed]| JointPair { rest: rest.to_cols_array(), posed: posed.to_cols_array() });
            let pairs: Vec<JointPair> = pairs.collect();
            gpu.queue.write_buffer(&self.joints, 0, bytemuck::cast_slice(&pairs));
        }
    }
}

fn deformation(pose: &MeshPose) -> Deformation {
    // The wavelength is divided by.
    let wave = pose.wave.unwrap_or(Wave::sideways(0.0, 1.0, 0.0));
    Deformation {
        wave_direction: wave.direction.to_array(),
        wave_amplitude_mm: wave.amplitude_mm,
        wave_travel: wave.travel.to_array(),
        wavelength_mm: wave.wavelength_mm,
        wave_phase_rad: wave.phase_rad,
        turned: u32::from(!pose.joints.is_empty()),
        morphed: u32::from(pose.morph_weights.iter().any(|&weight| weight != 0.0)),
        pad0: 0,
    }
}

/// Where the offsets of each vertex begin, with one end more; then the offsets themselves.
fn offsets(mesh: &Mesh) -> (Vec<u32>, Vec<Offset>) {
    let mut first = vec![0];
    let mut all = Vec::new();
    for v in 0..mesh.positions_mm.len() {
        for (number, target) in (0..).zip(&mesh.morph_targets) {
            let [position, normal, tangent] =
                [target.position_offsets_mm[v], target.normal_offsets[v], target.tangent_offsets[v]];
            if [position, normal, tangent].iter().any(|&offset| offset != Vec3::ZERO) {
                all.push(Offset {
                    position_mm: position.to_array(),
                    morph_target: number,
                    normal: normal.to_array(),
                    tangent: tangent.to_array(),
                    ..Offset::zeroed()
                });
            }
        }
        first.push(all.len() as u32);
    }
    (first, all)
}
