//! The node hierarchy: where each node stands in the world, and which ones the scene shows.

use super::Document;
use crate::SceneError;
use glam::{Mat4, Quat, Vec3};
use gltf::json::scene::Node;

/// Most nodes of a document.
const MAX_NODES: usize = 200_000;

/// Deepest hierarchy: a finger ends at about ten.
const MAX_DEPTH: usize = 1000;

/// World matrix of every node, in mm. Refuses nodes with two parents and circles.
pub(super) fn world_transforms(document: &Document) -> Result<Vec<Mat4>, SceneError> {
    let nodes = &document.root.nodes;
    if nodes.len() > MAX_NODES {
        return document.fail("nodes", format!("there are {}; at most {MAX_NODES}", nodes.len()));
    }
    let parent_of = parents(document)?;
    let mut world: Vec<Option<Mat4>> = vec![None; nodes.len()];
    let to_mm = Mat4::from_scale(Vec3::splat(document.mm_per_unit));
    // A list instead of recursion: depth costs no stack.
    let roots = (0..nodes.len()).filter(|&i| parent_of[i].is_none());
    let mut open: Vec<(usize, Mat4, usize)> = roots.map(|i| (i, to_mm, 1)).collect();
    while let Some((index, parent, depth)) = open.pop() {
        if depth > MAX_DEPTH {
            return document.fail(format!("nodes[{index}]"), format!("is nested deeper than {MAX_DEPTH}"));
        }
        let matrix = parent * local(&nodes[index]);
        if !matrix.is_finite() {
            return document.fail(format!("nodes[{index}]"), "its transform is not finite");
        }
        world[index] = Some(matrix);
        open.extend(children(&nodes[index]).map(|child| (child, matrix, depth + 1)));
    }
    let circle = world.iter().position(Option::is_none);
    match circle {
        Some(index) => {
            document.fail(format!("nodes[{index}]"), "is its own ancestor: the nodes form a circle")
        }
        None => Ok(world.into_iter().flatten().collect()),
    }
}

/// The parent of each node, if it has one. Refuses nodes with two.
pub(super) fn parents(document: &Document) -> Result<Vec<Option<usize>>, SceneError> {
    let nodes = &document.root.nodes;
    let mut parent_of = vec![None; nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        for child in children(node) {
            match parent_of.get_mut(child) {
                None => {
                    let reason = format!("names node {child}, but there are {}", nodes.len());
                    return document.fail(format!("nodes[{index}].children"), reason);
                }
                Some(Some(_)) => {
                    let reason = "has two parents, or is its own ancestor; nodes must form trees";
                    return document.fail(format!("nodes[{child}]"), reason);
                }
                Some(free) => *free = Some(index),
            }
        }
    }
    Ok(parent_of)
}

/// The nodes of the scene in the order of the file: parents before children, left to right.
pub(super) fn shown(document: &Document) -> Result<Vec<usize>, SceneError> {
    let root = &document.root;
    let mut open: Vec<usize> = match (root.scene, root.scenes.first()) {
        (Some(index), _) => {
            document.get(&root.scenes, index, "scene")?.nodes.iter().map(|n| n.value()).collect()
        }
        (None, Some(first)) => first.nodes.iter().map(|n| n.value()).collect(),
        (None, None) => {
            let parent_of = parents(document)?;
            (0..root.nodes.len()).filter(|&i| parent_of[i].is_none()).collect()
        }
    };
    open.reverse();
    let mut seen = vec![false; root.nodes.len()];
    let mut order = Vec::new();
    while let Some(index) = open.pop() {
        match seen.get_mut(index) {
            None => return document.fail("scene", format!("names node {index}, which does not exist")),
            Some(true) => continue, // a scene may list a node and its parent
            Some(seen) => *seen = true,
        }
        order.push(index);
        open.extend(children(&root.nodes[index]).collect::<Vec<_>>().into_iter().rev());
    }
    Ok(order)
}

fn children(node: &Node) -> impl Iterator<Item = usize> + '_ {
    node.children.iter().flatten().map(|child| child.value())
}

fn local(node: &Node) -> Mat4 {
    if let Some(matrix) = &node.matrix {
        return Mat4::from_cols_array(matrix);
    }
    let rotation = node.rotation.map_or(Quat::IDENTITY, |q| Quat::from_array(q.0));
    // Exporters write few digits; a quaternion without length would turn everything into NaN.
    let rotation = if rotation.length_squared() > 1e-12 { rotation.normalize() } else { Quat::IDENTITY };
    Mat4::from_scale_rotation_translation(
        Vec3::from_array(node.scale.unwrap_or([1.0; 3])),
        rotation,
        Vec3::from_array(node.translation.unwrap_or_default()),
    )
}
