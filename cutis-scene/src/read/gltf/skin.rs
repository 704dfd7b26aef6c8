//! Skins at rest: where each vertex stands when every joint is where the file leaves it.

use super::Document;
use super::accessor::Accept;
use crate::SceneError;
use glam::Mat4;
use gltf::json::Index;
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::validation::Checked;

/// Most joints of a skin.
const MAX_JOINTS: usize = 65_536;

/// Most sets of four influences per vertex.
const MAX_SETS: u32 = 4;

/// Matrix from a vertex' own space at bind time to the world, mm, of each joint.
pub(super) fn joint_matrices(
    document: &Document,
    world: &[Mat4],
    skin: Index<gltf::json::Skin>,
    place: &str,
) -> Result<Vec<Mat4>, SceneError> {
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
    for (joint, bind) in description.joints.iter().zip(bind) {
        let Some(joint_world) = world.get(joint.value()) else {
            return document.fail(place, format!("names node {}, which does not exist", joint.value()));
        };
        matrices.push(*joint_world * bind);
    }
    Ok(matrices)
}

/// Blended matrix of each vertex of a primitive; `None` if the primitive has no joints.
pub(super) fn vertex_matrices(
    document: &Document,
    primitive: &Primitive,
    joints: &[Mat4],
    vertices: usize,
    place: &str,
) -> Result<Option<Vec<Mat4>>, SceneError> {
    let root = &document.root;
    let mut sums = vec![(Mat4::ZERO, 0.0f32); vertices];
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
        for ((sum, numbers), weights) in sums.iter_mut().zip(numbers).zip(weights) {
            add_influences(document, sum, numbers, weights, joints, &at("JOINTS"))?;
        }
        any = true;
    }
    // Weights need not sum to one exactly; a vertex without any follows the first joint.
    let blend = |(sum, weight): (Mat4, f32)| if weight > 0.0 { sum * weight.recip() } else { joints[0] };
    Ok(any.then(|| sums.into_iter().map(blend).collect()))
}

fn add_influences(
    document: &Document,
    sum: &mut (Mat4, f32),
    numbers: [f32; 4],
    weights: [f32; 4],
    joints: &[Mat4],
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
        sum.0 += *joint * weight;
        sum.1 += weight;
    }
    Ok(())
}
