//! Joints of a skin, ready to be turned: parents before children, everything in mm.
//!
//! Hands for WebXR come with joints that all hang on one node, for their program places each by itself. The names of such
//! hands tell how they hang together (W3C WebXR Hand Input Module, not opened), and they are read that way.

use super::Document;
use super::nodes::parents;
use super::skin::JointMatrices;
use crate::{Joint, SceneError};
use glam::Mat4;
use gltf::json::Index;
use std::collections::HashMap;

/// The joints of one skin.
pub(super) struct Bones {
    pub(super) joints: Vec<Joint>,
    /// Number of each of the file's joints among them.
    pub(super) number: Vec<u16>,
}

/// Orders the joints of a skin that was checked before; in words, why they cannot be turned.
pub(super) fn read(
    document: &Document,
    world: &[Mat4],
    skin: Index<gltf::json::Skin>,
    matrices: &[JointMatrices],
) -> Result<Result<Bones, String>, SceneError> {
    let nodes: Vec<usize> = document.root.skins[skin.value()].joints.iter().map(|j| j.value()).collect();
    // Of a node that is listed twice the first counts.
    let joint_of_node: HashMap<usize, usize> = (0..nodes.len()).rev().map(|j| (nodes[j], j)).collect();
    let node_parents = parents(document)?;
    let above = |node: usize| std::iter::successors(node_parents[node], |&up| node_parents[up]);
    let mut parent: Vec<Option<usize>> =
        nodes.iter().map(|&node| above(node).find_map(|up| joint_of_node.get(&up).copied())).collect();
    let names: Vec<String> = nodes.iter().map(|&node| name(document, node)).collect();
    if parent.iter().all(Option::is_none) {
        let of_name = |wanted: String| names.iter().position(|name| *name == wanted);
        parent = names.iter().map(|name| hand_parent(name).and_then(of_name)).collect();
    }
    let depth = |j: usize| std::iter::successors(parent[j], |&up| parent[up]).count();
    let mut order: Vec<usize> = (0..nodes.len()).collect();
    order.sort_by_cached_key(|&j| depth(j));
    let Ok(count) = u16::try_from(nodes.len()) else { return Ok(Err("has too many joints".to_owned())) };
    let mut number = vec![0; nodes.len()];
    (0..count).zip(&order).for_each(|(new, &old)| number[old] = new);
    let bind_from_world = matrices[0].world_from_bind.inverse();
    let joint = |&j: &usize| Joint {
        name: names[j].clone(),
        parent: parent[j].map(|up| number[up]),
        parent_from_joint: match parent[j] {
            Some(up) => world[nodes[up]].inverse() * world[nodes[j]],
            None => world[nodes[j]],
        },
        joint_from_bind: matrices[j].inverse_bind * bind_from_world,
    };
    let joints: Vec<Joint> = order.iter().map(joint).collect();
    match joints.iter().find(|j| !(j.parent_from_joint.is_finite() && j.joint_from_bind.is_finite())) {
        Some(joint) => Ok(Err(format!("the matrices around joint `{}` cannot be undone", joint.name))),
        None => Ok(Ok(Bones { joints, number })),
    }
}

fn name(document: &Document, node: usize) -> String {
    document.root.nodes[node].name.clone().unwrap_or_else(|| format!("nodes[{node}]"))
}

/// The joint that a joint of a WebXR hand hangs on.
fn hand_parent(name: &str) -> Option<String> {
    let (finger, bone) = match name.strip_prefix("thumb-") {
        Some(bone) => ("thumb", bone),
        None => {
            let (finger, bone) = name.split_once("-finger-")?;
            (finger, bone)
        }
    };
    let prefix = if finger == "thumb" { "thumb".to_owned() } else { format!("{finger}-finger") };
    match (finger, bone) {
        (_, "tip") => Some(format!("{prefix}-phalanx-distal")),
        // A thumb has one bone less.
        ("thumb", "phalanx-distal") => Some(format!("{prefix}-phalanx-proximal")),
        (_, "phalanx-distal") => Some(format!("{prefix}-phalanx-intermediate")),
        (_, "phalanx-intermediate") => Some(format!("{prefix}-phalanx-proximal")),
        (_, "phalanx-proximal") => Some(format!("{prefix}-metacarpal")),
        (_, "metacarpal") => Some("wrist".to_owned()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bone_of_a_hand_leads_to_the_wrist() {
        for (name, bones) in
            [("index-finger-tip", 5), ("thumb-tip", 4), ("wrist", 0), ("index-finger-nail", 0)]
        {
            let chain: Vec<_> = std::iter::successors(hand_parent(name), |up| hand_parent(up)).collect();
            assert_eq!(chain.len(), bones, "{name}: {chain:?}");
            assert!(chain.last().is_none_or(|last| last == "wrist"));
        }
    }
}
