//! Samples of the sculpture on a regular grid, taken only near the surface.

use super::sculpture::{BOUNDS_MM, Sculpture};
use glam::{UVec3, Vec3};
use rayon::prelude::*;

/// Nodes along one edge of a block that is sampled or skipped as a whole.
const BLOCK: u32 = 4;
/// The sculpture's values may grow this much faster than true distance (soft unions of stretched shapes).
const STEEPEST: f32 = 1.5;

/// Samples at the nodes of a grid; far from the surface only the sign is right.
pub struct Grid {
    /// Edge of a cell, mm.
    pub cell_mm: f32,
    /// Position of node (0, 0, 0), mm.
    pub origin_mm: Vec3,
    /// Number of nodes along each axis.
    pub nodes: UVec3,
    /// Samples in mm, x fastest.
    pub values_mm: Vec<f32>,
}

impl Grid {
    /// Samples the sculpture.
    pub fn sample(sculpture: &Sculpture, cell_mm: f32) -> Self {
        let [lo, hi] = BOUNDS_MM;
        let blocks = ((hi - lo) / (cell_mm * BLOCK as f32)).ceil().as_uvec3();
        let nodes = blocks * BLOCK;
        // Even about x = 0, so that one half is the mirror image of the other.
        let origin_mm = Vec3::new(-0.5 * (nodes.x - 1) as f32 * cell_mm, lo.y, lo.z);
        let layer = (nodes.x * nodes.y * BLOCK) as usize;
        let mut grid = Self { cell_mm, origin_mm, nodes, values_mm: vec![0.0; layer * blocks.z as usize] };
        let mut values = std::mem::take(&mut grid.values_mm);
        values.par_chunks_mut(layer).enumerate().for_each(|(bz, values)| {
            for by in 0..blocks.y {
                for bx in blocks.x / 2..blocks.x {
                    grid.sample_block(sculpture, UVec3::new(bx, by, bz as u32), values);
                }
            }
            for row in values.chunks_exact_mut(nodes.x as usize) {
                for x in 0..row.len() / 2 {
                    row[x] = row[row.len() - 1 - x];
                }
            }
        });
        grid.values_mm = values;
        grid
    }

    /// Fills one block of a layer of blocks, `values` being the layer.
    fn sample_block(&self, sculpture: &Sculpture, block: UVec3, values: &mut [f32]) {
        let first = block * BLOCK;
        let half_mm = 0.5 * (BLOCK - 1) as f32 * self.cell_mm;
        let middle = self.position_mm(first) + half_mm;
        let at_middle = sculpture.distance(middle);
        // One cell more, so that both ends of every edge the surface crosses are sampled.
        let far = at_middle.abs() > STEEPEST * 3f32.sqrt() * (half_mm + self.cell_mm);
        for z in 0..BLOCK {
            for y in 0..BLOCK {
                for x in 0..BLOCK {
                    let node = first + UVec3::new(x, y, z);
                    let index = ((z * self.nodes.y + node.y) * self.nodes.x + node.x) as usize;
                    values[index] = if far { at_middle } else { sculpture.distance(self.position_mm(node)) };
                }
            }
        }
    }

    /// Where a node is, mm.
    pub fn position_mm(&self, node: UVec3) -> Vec3 {
        self.origin_mm + node.as_vec3() * self.cell_mm
    }

    /// Index steps to the eight corners of a cell, x fastest.
    pub fn corner_steps(&self) -> [usize; 8] {
        let (row, layer) = (self.nodes.x as usize, (self.nodes.x * self.nodes.y) as usize);
        std::array::from_fn(|c| (c & 1) + (c >> 1 & 1) * row + (c >> 2) * layer)
    }

    /// Removes sign patterns at which a surface net would touch itself: inside nodes of a cell that meet only across
    /// a diagonal. The outside node with the smallest value becomes inside by a hair, until nothing is left to do.
    pub fn repair(&mut self) {
        let steps = self.corner_steps();
        let mut suspects = self.crossed_cells();
        while !suspects.is_empty() {
            let mut touched = Vec::new();
            for cell in suspects {
                let corners = steps.map(|s| cell + s);
                let inside = corners.map(|i| self.values_mm[i] < 0.0);
                if let Some(nodes) = pinched(inside) {
                    let value = |c: &usize| self.values_mm[corners[*c]];
                    let chosen = nodes
                        .into_iter()
                        .filter(|&c| !inside[c])
                        .min_by(|a, b| value(a).total_cmp(&value(b)));
                    let node = corners[chosen.expect("a pinched pattern has an outside corner")];
                    self.values_mm[node] = -1e-3; // a thousandth of a millimetre inside
                    touched.extend(steps.map(|s| node - s));
                }
            }
            suspects = touched;
        }
    }

    /// Cells with both signs at their corners, by their first node.
    pub fn crossed_cells(&self) -> Vec<usize> {
        let steps = self.corner_steps();
        let (nx, ny) = (self.nodes.x as usize, self.nodes.y as usize);
        (0..self.nodes.z as usize - 1)
            .into_par_iter()
            .flat_map_iter(|z| {
                (0..ny - 1).flat_map(move |y| (0..nx - 1).map(move |x| (z * ny + y) * nx + x)).filter(
                    |&cell| {
                        let first = self.values_mm[cell] < 0.0;
                        steps[1..].iter().any(|s| (self.values_mm[cell + s] < 0.0) != first)
                    },
                )
            })
            .collect()
    }
}

/// Corners of the face or cell whose inside corners are joined only diagonally (or whose outside corners are).
fn pinched(inside: [bool; 8]) -> Option<Vec<usize>> {
    const FACES: [[usize; 4]; 6] =
        [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
    for [a, b, c, d] in FACES {
        if inside[a] == inside[c] && inside[b] == inside[d] && inside[a] != inside[b] {
            return Some(vec![a, b, c, d]);
        }
    }
    let count = inside.iter().filter(|&&i| i).count();
    let diagonal = (0..4).any(|c| inside[c] == inside[7 - c] && inside[c] == (count == 2));
    ((count == 2 || count == 6) && diagonal).then(|| (0..8).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pinched_patterns_are_found_and_plain_ones_are_not() {
        let inside = |corners: &[usize]| std::array::from_fn(|c| corners.contains(&c));
        assert!(pinched(inside(&[0, 3])).is_some(), "across a face");
        assert!(pinched(inside(&[0, 7])).is_some(), "across the cell");
        assert!(pinched(inside(&[0, 1, 2, 4])).is_none(), "a corner and its neighbours");
        assert!(pinched(inside(&[0, 1])).is_none(), "an edge");
        assert!(pinched(inside(&[1, 2, 3, 4, 5, 6])).is_some(), "all but two opposite corners");
    }
}
