//! Edges of the mesh at which charts meet, and places along them as both charts see them.

use super::walk::Ground;
use glam::Vec2;

/// An edge across which the texture does not go on, though the surface does.
#[derive(Debug, Clone, Copy)]
pub struct SeamEdge {
    /// The triangle on either side, and its corner at which the edge begins.
    pub sides: [(u32, u8); 2],
    /// Its ends on the texture on either side, texels; the same end is the same point.
    ends: [[Vec2; 2]; 2],
}

/// All of them, each once.
pub fn seam_edges(ground: &Ground) -> Vec<SeamEdge> {
    let corners =
        (0..ground.triangle_count()).flat_map(|triangle| (0..3u8).map(move |corner| (triangle, corner)));
    let at = |own: (u32, u8)| {
        let other = ground.across(own.0, own.1)?;
        if ground.goes_on(own.0, own.1) || other < own {
            return None;
        }
        // Neighbours run along an edge in opposite directions.
        let [end, start] = ground.edge(other.0, other.1);
        Some(SeamEdge { sides: [own, other], ends: [ground.edge(own.0, own.1), [start, end]] })
    };
    corners.filter_map(at).collect()
}

impl SeamEdge {
    /// Number of places along it, so many for each texel of the longer side. No edge on a map is longer than once around it.
    pub fn place_count(&self, per_texel: f32, size: usize) -> usize {
        let length = |[a, b]: [Vec2; 2]| (b - a).length();
        let texels = length(self.ends[0]).max(length(self.ends[1])).min(4.0 * size as f32);
        (per_texel * texels).ceil().max(1.0) as usize
    }

    /// That many places at even distances, on either side of the texture, texels.
    pub fn places(&self, count: usize) -> impl Iterator<Item = [Vec2; 2]> {
        let ends = self.ends;
        (0..count).map(move |i| ends.map(|[a, b]| a.lerp(b, (i as f32 + 0.5) / count as f32)))
    }
}
