//! Charts on several tiles of the texture's plane (as UDIM numbers them): one unit square each. Textures repeat from tile to
//! tile; maps of light have the one square.

use crate::topology::weld;
use crate::unwrap::Unwrapped;
use crate::{Charts, Mesh};
use glam::Vec2;
use std::collections::HashMap;

/// Most tiles that are put side by side: beyond, each would be too small, and a new atlas is better.
pub const MAX_TILES: usize = 16;

/// Exporters round: a chart that leaves its tile by no more still belongs to it.
const SLACK: f32 = 1e-4;

/// The tile of every chart of a mesh.
#[derive(Debug)]
pub struct Tiles {
    charts: Charts,
    /// Tile of each chart, as a number in `corners`.
    of_chart: Vec<usize>,
    /// Least corner of each tile, row by row.
    corners: Vec<Vec2>,
}

impl Tiles {
    /// Finds them by the texture coordinates of the mesh. `None` if a chart lies on several tiles.
    pub fn of(mesh: &Mesh) -> Option<Self> {
        let charts = Charts::find(mesh, &weld(&mesh.positions_mm));
        let mut boxes = vec![[Vec2::INFINITY, Vec2::NEG_INFINITY]; charts.count as usize];
        for (t, &chart) in charts.of_triangle.iter().enumerate() {
            for uv in mesh.corner_atlas_uvs(t) {
                let [lo, hi] = &mut boxes[chart as usize];
                (*lo, *hi) = (lo.min(uv), hi.max(uv));
            }
        }
        let tile = |[lo, hi]: [Vec2; 2]| {
            let tile = (lo + SLACK).floor();
            // Adding 0 turns -0 into 0.
            (hi.cmple(tile + 1.0 + SLACK).all()).then_some(tile + 0.0)
        };
        let tiles = boxes.into_iter().map(tile).collect::<Option<Vec<Vec2>>>()?;
        let mut corners = tiles.clone();
        let by_rows = |a: &Vec2, b: &Vec2| a.y.total_cmp(&b.y).then(a.x.total_cmp(&b.x));
        corners.sort_by(by_rows);
        corners.dedup();
        let number = |tile: &Vec2| corners.binary_search_by(|corner| by_rows(corner, tile)).ok();
        let of_chart = tiles.iter().map(number).collect::<Option<_>>()?;
        Some(Self { charts, of_chart, corners })
    }

    /// How many tiles are used.
    pub fn count(&self) -> usize {
        self.corners.len()
    }

    /// Tiles along each side of the smallest square that holds all of them.
    pub fn per_side(&self) -> usize {
        (1..).find(|n| n * n >= self.count()).unwrap_or(1)
    }

    /// The atlas that has them in rows of `per_side`; with 1, all of them on one another.
    pub fn atlas(&self, mesh: &Mesh, per_side: usize) -> Unwrapped {
        let mut atlas = Unwrapped { vertices: Vec::new(), uvs: Vec::new(), triangles: Vec::new() };
        // Charts may share a vertex at the border of their tiles.
        let mut known = HashMap::new();
        for (triangle, &chart) in mesh.triangles.iter().zip(&self.charts.of_triangle) {
            let tile = self.of_chart[chart as usize];
            let slot = Vec2::new((tile % per_side) as f32, (tile / per_side % per_side) as f32);
            let vertices = triangle.map(|v| {
                *known.entry((v, tile)).or_insert_with(|| {
                    let in_tile =
                        (mesh.in_atlas()[v as usize] - self.corners[tile]).clamp(Vec2::ZERO, Vec2::ONE);
                    atlas.vertices.push(v);
                    atlas.uvs.push((slot + in_tile) / per_side as f32);
                    atlas.vertices.len() as u32 - 1
                })
            });
            atlas.triangles.push(vertices);
        }
        atlas
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::validation::shapes;

    /// A patch over 2 × 2 tiles in one piece; then the same within one tile.
    #[test]
    fn a_chart_over_several_tiles_is_none_of_theirs() {
        let mut mesh = shapes::patch(8, 0.0, |u| u, |v| v);
        mesh.uvs.iter_mut().for_each(|uv| *uv *= 2.0);
        assert!(Tiles::of(&mesh).is_none());
        mesh.uvs.iter_mut().for_each(|uv| *uv = *uv * 0.5 + 7.0);
        let tiles = Tiles::of(&mesh).expect("one tile");
        assert_eq!((tiles.count(), tiles.per_side()), (1, 1));
        let mut gathered = mesh.clone();
        tiles.atlas(&mesh, 1).lay(&mut gathered);
        for t in 0..mesh.triangles.len() {
            assert_eq!(gathered.corner_atlas_uvs(t), mesh.corner_map_uvs(t).map(|uv| uv - 7.0));
            assert_eq!(gathered.corner_map_uvs(t), mesh.corner_map_uvs(t), "maps lie where they lay");
        }
    }

    /// Two triangles that touch in a point between their tiles, and share its vertex.
    #[test]
    fn a_vertex_of_two_tiles_becomes_two() {
        let mesh = Mesh {
            positions_mm: [[0., 0.], [1., 0.], [0., 1.], [-1., 0.], [0., -1.]]
                .map(|[x, y]| glam::Vec3::new(x, y, 0.))
                .to_vec(),
            uvs: [[1., 0.5], [1.5, 0.5], [1., 0.9], [0.5, 0.5], [1., 0.1]].map(Vec2::from_array).to_vec(),
            triangles: vec![[0, 1, 2], [0, 3, 4]],
            ..Mesh::default()
        };
        let tiles = Tiles::of(&mesh).expect("two tiles");
        assert_eq!((tiles.count(), tiles.per_side()), (2, 2));
        let atlas = tiles.atlas(&mesh, 2);
        assert_eq!(atlas.vertices, [0, 1, 2, 0, 3, 4]);
        assert_eq!(atlas.uvs[0], Vec2::new(0.5, 0.25));
        assert_eq!(atlas.uvs[3], Vec2::new(0.5, 0.25));
        assert_eq!(atlas.uvs[1], Vec2::new(0.75, 0.25));
        assert_eq!(atlas.uvs[4], Vec2::new(0.25, 0.25));
    }
}
