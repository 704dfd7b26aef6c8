//! Surface nets: one vertex in every cell the surface crosses, one quad for every crossed edge of the grid.
//!
//! After Gibson 1998, "Constrained elastic surface nets" (MICCAI; not opened). The grid is repaired before, so that
//! the net is a closed manifold; vertices are then pulled onto the sculpture.

use super::grid::Grid;
use super::sculpture::Sculpture;
use glam::Vec3;
use rayon::prelude::*;

/// A closed triangle surface without texture coordinates.
#[derive(Debug, Clone, Default)]
pub struct Surface {
    /// Positions, mm.
    pub points_mm: Vec<Vec3>,
    /// Corners, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// Meshes the sculpture with cells of `cell_mm`.
pub fn surface_nets(sculpture: &Sculpture, cell_mm: f32) -> Surface {
    let mut grid = Grid::sample(sculpture, cell_mm);
    grid.repair();
    let cells = grid.crossed_cells();
    let mut vertex_of_cell = vec![u32::MAX; grid.values_mm.len()];
    for (v, &cell) in cells.iter().enumerate() {
        vertex_of_cell[cell] = v as u32;
    }
    let points_mm =
        cells.par_iter().map(|&cell| sculpture.project(centre_of_crossings(&grid, cell), 1)).collect();
    let triangles: Vec<_> =
        cells.iter().flat_map(|&cell| triangles_at(&grid, cell, &vertex_of_cell)).collect();
    largest_piece(Surface { points_mm, triangles })
}

/// Drops crumbs: bubbles of a few cells that soft cuts may leave inside the head.
fn largest_piece(surface: Surface) -> Surface {
    let piece_of = pieces_of_points(&surface);
    let mut sizes = vec![0usize; surface.points_mm.len()];
    piece_of.iter().for_each(|&p| sizes[p as usize] += 1);
    let largest = (0..sizes.len()).max_by_key(|&p| sizes[p]).unwrap_or(0) as u32;
    let mut number = vec![0u32; surface.points_mm.len()];
    let mut kept = Surface::default();
    for (i, &p) in surface.points_mm.iter().enumerate().filter(|(i, _)| piece_of[*i] == largest) {
        number[i] = kept.points_mm.len() as u32;
        kept.points_mm.push(p);
    }
    let whole = surface.triangles.iter().filter(|c| piece_of[c[0] as usize] == largest);
    kept.triangles = whole.map(|c| c.map(|i| number[i as usize])).collect();
    kept
}

/// For each point the smallest point number of its piece.
fn pieces_of_points(surface: &Surface) -> Vec<u32> {
    let mut parent: Vec<u32> = (0..surface.points_mm.len() as u32).collect();
    let root = |parent: &mut [u32], mut i: u32| {
        while parent[i as usize] != i {
            parent[i as usize] = parent[parent[i as usize] as usize];
            i = parent[i as usize];
        }
        i
    };
    for [a, b, c] in &surface.triangles {
        for other in [b, c] {
            let (i, j) = (root(&mut parent, *a), root(&mut parent, *other));
            parent[i.max(j) as usize] = i.min(j);
        }
    }
    (0..parent.len() as u32).map(|i| root(&mut parent, i)).collect()
}

/// Mean of the places where the surface crosses the cell's edges, mm.
fn centre_of_crossings(grid: &Grid, cell: usize) -> Vec3 {
    let steps = grid.corner_steps();
    let corner = |c: usize| Vec3::new((c & 1) as f32, (c >> 1 & 1) as f32, (c >> 2) as f32);
    let (mut sum, mut count) = (Vec3::ZERO, 0.0);
    for a in 0..8usize {
        for b in [a | 1, a | 2, a | 4].into_iter().filter(|&b| b != a) {
            let (va, vb) = (grid.values_mm[cell + steps[a]], grid.values_mm[cell + steps[b]]);
            if (va < 0.0) != (vb < 0.0) {
                sum += corner(a).lerp(corner(b), va / (va - vb));
                count += 1.0;
            }
        }
    }
    let (nx, ny) = (grid.nodes.x as usize, grid.nodes.y as usize);
    let first = glam::UVec3::new((cell % nx) as u32, (cell / nx % ny) as u32, (cell / (nx * ny)) as u32);
    grid.position_mm(first) + sum / count * grid.cell_mm
}

/// The triangles around the three edges that leave the cell's first node.
fn triangles_at(grid: &Grid, cell: usize, vertex_of_cell: &[u32]) -> Vec<[u32; 3]> {
    let steps = grid.corner_steps();
    let axes = [steps[1], steps[2], steps[4]];
    let mut triangles = Vec::with_capacity(6);
    for axis in 0..3 {
        let inside = grid.values_mm[cell] < 0.0;
        if (grid.values_mm[cell + axes[axis]] < 0.0) == inside {
            continue;
        }
        let (s, t) = (axes[(axis + 1) % 3], axes[(axis + 2) % 3]);
        let around = [cell - s - t, cell - t, cell, cell - s].map(|c| vertex_of_cell[c]);
        let [a, b, c, d] = if inside { around } else { [around[3], around[2], around[1], around[0]] };
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    triangles
}
