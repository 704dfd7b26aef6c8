//! Skins: where each vertex stands when every joint is where the file leaves it, and which joints it follows.

use super::Document;
use super::accessor::Accept;
use crate::skeleton::JOINTS_PER_VERTEX;
use crate::{Influence, SceneError};
use glam::Mat4;
use gltf::json::Index;
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::validation::Checked;

/// Most joints of a skin: their numbers have 16 bits.
const MAX_JOINTS: usize = 65_535;

/// Most sets of four influences per vertex.
const MAX_SETS: u32 = 4;

/// One joint of a skin as the file leaves it.
#[derive(Debug, Clone, Copy)]
pub(super) struct JointMatrices {
    /// From the mesh as it was bound, in the file's unit, to the joint's own axes.
    pub(super) inverse_bind: Mat4,
    /// From there to the world, mm.
    pub(super) world_from_bind: Mat4,
}

/// What the vertices of a primitive do under a skin.
pub(super) struct Skinned {
    /// Blended matrix of each vertex.
    pub(super) matrices: Vec<Mat4>,
    /// What each vertex follows, by the file's numbers.
    pub(super) influences: Vec<Influence>,
}

/// The matrices of each joint.
pub(super) fn joint_matrices(
    document: &Document,
    world: &[Mat4],
    skin: Index<gltf::json::Skin>,
    place: &str,
) -> Result<Vec<JointMatrices>, SceneError> {
    let root = &document.root;
    let description = document.get(&root.skins, skin, place)?;
    let place = format!("skins[{}]", skin.value());
    let count = description.joints.len();
    if count == 0 || count > MAX_JOINTS {
        return document.fail(place, format!("has {count} joints; 1 to {MAX_JOINTS}"));
    }
    let bind: Vec<Mat4> = match description.inverse_bind_matrices {
        Some(accessor) => document
            .accessors
            .read::<16>(root, accessor, Accept::Float, &place)?
            .iter()
            .map(Mat4::from_cols_array)
            .collect(),
        None => vec![Mat4::IDENTITY; count],
    };
    if bind.len() < count {
        return document.fail(place, format!("has {count} joints but {} bind matrices", bind.len()));
    }
    let mut matrices = Vec::with_capacity(count);
    for (joint, inverse_bind) in description.joints.iter().zip(bind) {
        let Some(joint_world) = world.get(joint.value()) else {
            return document.fail(place, format!("names node {}, which does not exist", joint.value()));
        };
        matrices.push(JointMatrices { inverse_bind, world_from_bind: *joint_world * inverse_bind });
    }
    Ok(matrices)
}

/// A vertex while its influences are read.
#[derive(Clone, Copy)]
struct Follower {
    sum: Mat4,
    weight: f32,
    /// Falling by weight.
    strongest: Influence,
}

/// What each vertex of a primitive follows; `None` if the primitive has no joints.
pub(super) fn skinned(
    document: &Document,
    primitive: &Primitive,
    joints: &[JointMatrices],
    vertices: usize,
    place: &str,
    warnings: &mut Vec<String>,
) -> Result<Option<Skinned>, SceneError> {
    let root = &document.root;
    let nobody = Follower { sum: Mat4::ZERO, weight: 0.0, strongest: Influence::default() };
    let mut followers = vec![nobody; vertices];
    let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).copied();
    let mut any = false;
    for set in 0..MAX_SETS {
        let (Some(joint_accessor), Some(weight_accessor)) =
            (attribute(Semantic::Joints(set)), attribute(Semantic::Weights(set)))
        else {
            break;
        };
        let at = |name: &str| format!("{place}.attributes.{name}_{set}");
        let numbers = document.accessors.read::<4>(root, joint_accessor, Accept::Unsigned, &at("JOINTS"))?;
        let accept = Accept::FloatOrNormalised;
        let weights = document.accessors.read::<4>(root, weight_accessor, accept, &at("WEIGHTS"))?;
        if numbers.len() != vertices || weights.len() != vertices {
            return document.fail(at("JOINTS"), format!("does not have one element per vertex ({vertices})"));
        }
        for ((follower, numbers), weights) in followers.iter_mut().zip(numbers).zip(weights) {
            add_influences(document, follower, numbers, weights, joints, &at("JOINTS"))?;
        }
        any = true;
    }
    if !any {
        return Ok(None);
    }
    tell(&followers, place, warnings);
    let (matrices, influences) = followers.iter().map(|follower| follower.finish(joints)).unzip();
    Ok(Some(Skinned { matrices, influences }))
}

fn add_influences(
    document: &Document,
    follower: &mut Follower,
    numbers: [f32; 4],
    weights: [f32; 4],
    joints: &[JointMatrices],
    place: &str,
) -> Result<(), SceneError> {
    for (number, weight) in numbers.into_iter().zip(weights) {
        // Joint numbers have at most 16 bits, so they are exact in single precision.
        let Some(joint) = joints.get(number as usize) else {
            return document.fail(place, format!("names joint {number}, but the skin has {}", joints.len()));
        };
        if !weight.is_finite() || weight < 0.0 {
            return document.fail(place, format!("has the weight {weight}"));
        }
        follower.add(number as u16, weight, joint.world_from_bind);
    }
    Ok(())
}

impl Follower {
    fn add(&mut self, joint: u16, weight: f32, matrix: Mat4) {
        self.sum += matrix * weight;
        self.weight += weight;
        let Influence { joints, weights } = &mut self.strongest;
        if let Some(slot) = weights.iter().position(|&w| w < weight) {
            joints[slot..].rotate_right(1);
            weights[slot..].rotate_right(1);
            (joints[slot], weights[slot]) = (joint, weight);
        }
    }

    /// Blended matrix and influences. Weights need not sum to one exactly; a vertex without any follows the first joint.
    fn finish(&self, joints: &[JointMatrices]) -> (Mat4, Influence) {
        let kept: f32 = self.strongest.weights.iter().sum();
        if !(self.weight > 0.0 && self.weight.is_finite() && kept > 0.0) {
            let first = Influence { weights: [1.0, 0.0, 0.0, 0.0], ..Influence::default() };
            return (joints[0].world_from_bind, first);
        }
        let weights = self.strongest.weights.map(|weight| weight / kept);
        (self.sum * self.weight.recip(), Influence { weights, ..self.strongest })
    }
}

/// Says what was mended.
fn tell(followers: &[Follower], place: &str, warnings: &mut Vec<String>) {
    let lost = followers.iter().filter(|f| f.weight <= 0.0).count();
    if lost > 0 {
        warnings
            .push(format!("{place}: the weights of {lost} vertices sum to 0; they follow the first joint"));
    }
    // Weights of 8 bits are off by up to 1/510 each; less than that is no fifth joint.
    let many = followers.iter().filter(|f| f.strongest.weights.iter().sum::<f32>() < 0.99 * f.weight).count();
    if many > 0 {
        warnings.push(format!(
            "{place}: {many} vertices follow more than {JOINTS_PER_VERTEX} joints; a pose moves them by the strongest"
        ));
    }
}
