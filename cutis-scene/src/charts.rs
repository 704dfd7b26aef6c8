//! UV charts: the pieces into which the parameterisation cuts the surface, the seams between them, and places where
//! two pieces of surface lie on the same part of the texture.

use crate::Mesh;
use crate::topology::{EdgeUses, edges};
use glam::Vec2;

/// The charts of one mesh.
#[derive(Debug, Clone, Default)]
pub struct Charts {
    /// Number of charts.
    pub count: u32,
    /// Chart of each triangle, numbered from 0 in the order of their first triangle.
    pub of_triangle: Vec<u32>,
    /// Edges of the surface at which two charts meet.
    pub seams: Vec<Seam>,
}

/// One edge of the surface that lies at two places of the texture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seam {
    /// The triangle on either side.
    pub triangles: [u32; 2],
    /// The edge's end points in the texture, on either side: `uvs[side][end]`; the same end is the same point.
    pub uvs: [[Vec2; 2]; 2],
}

impl Charts {
    /// Finds the charts: triangles belong together when they share an edge whose UVs agree on both sides.
    pub fn find(mesh: &Mesh, point_of_vertex: &[u32]) -> Self {
        let edges = sorted(edges(mesh, point_of_vertex));
        let mut groups = DisjointSets::new(mesh.triangles.len());
        for ([a, b], uses) in &edges {
            for pair in uses.windows(2) {
                let sides = [0, 1].map(|side| edge_uvs(mesh, point_of_vertex, pair[side], *a, *b));
                if sides[0] == sides[1] {
                    groups.join(pair[0].0, pair[1].0);
                }
            }
        }
        let (of_triangle, count) = groups.numbered();
        let seams = edges.iter().filter_map(|edge| seam(mesh, point_of_vertex, edge)).collect();
        Self { count, of_triangle, seams }
    }

    /// Whether all coordinates lie in the unit square, so that the texture is used at most once.
    pub fn inside_unit_square(mesh: &Mesh) -> bool {
        // A hair of slack: exporters round 1 up.
        mesh.in_atlas().iter().all(|uv| uv.min_element() >= -1e-4 && uv.max_element() <= 1.0001)
    }

    /// Fraction of the used texture that more than one triangle claims, counted on a grid of `size`² sample points.
    pub fn overlap_fraction(mesh: &Mesh, size: u32) -> f32 {
        let mut claims = vec![0u8; (size * size) as usize];
        for t in 0..mesh.triangles.len() {
            for_each_sample_inside(mesh.corner_atlas_uvs(t), size, |index| {
                claims[index] = claims[index].saturating_add(1)
            });
        }
        let used = claims.iter().filter(|&&c| c > 0).count();
        let twice = claims.iter().filter(|&&c| c > 1).count();
        if used == 0 { 0.0 } else { twice as f32 / used as f32 }
    }
}

/// Calls `visit` with every sample of a `size`² grid strictly inside a triangle of the texture.
fn for_each_sample_inside(uvs: [Vec2; 3], size: u32, mut visit: impl FnMut(usize)) {
    // An irrational-looking shift keeps samples off the round numbers at which edges like to lie.
    let shift = Vec2::new(0.437_61, 0.512_37);
    let [a, b, c] = uvs.map(|uv| uv * size as f32 - shift);
    let area = (b - a).perp_dot(c - a);
    if area == 0.0 || !area.is_finite() {
        return;
    }
    let clamp = |x: f32| x.clamp(0.0, size as f32) as u32;
    let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
    for y in clamp(lo.y.ceil())..clamp(hi.y.floor() + 1.0) {
        for x in clamp(lo.x.ceil())..clamp(hi.x.floor() + 1.0) {
            let p = Vec2::new(x as f32, y as f32);
            let inside =
                [(a, b), (b, c), (c, a)].iter().all(|(s, e)| (*e - *s).perp_dot(p - *s) * area > 0.0);
            if inside {
                visit((y * size + x) as usize);
            }
        }
    }
}

/// An edge between two points with the corners that use it, as in [`EdgeUses`].
type SharedEdge = ([u32; 2], Vec<(u32, u8)>);

/// Edges in the order of their points, so that charts and seams come out the same in every run.
fn sorted(uses: EdgeUses) -> Vec<SharedEdge> {
    let mut list: Vec<_> = uses.into_iter().collect();
    list.sort_unstable();
    list
}

/// UVs of the edge's ends, in the order of the points `a`, `b`.
fn edge_uvs(mesh: &Mesh, point_of_vertex: &[u32], (t, corner): (u32, u8), a: u32, b: u32) -> [Vec2; 2] {
    let triangle = mesh.triangles[t as usize];
    let ends = [triangle[usize::from(corner)], triangle[(usize::from(corner) + 1) % 3]];
    let uvs = ends.map(|v| mesh.in_atlas()[v as usize]);
    debug_assert!(
        ends.iter().all(|&v| [a, b].contains(&point_of_vertex[v as usize])),
        "the edge has these ends"
    );
    if point_of_vertex[ends[0] as usize] == a { uvs } else { [uvs[1], uvs[0]] }
}

fn seam(mesh: &Mesh, point_of_vertex: &[u32], ([a, b], uses): &SharedEdge) -> Option<Seam> {
    let [first, second] = uses[..] else { return None };
    let uvs = [first, second].map(|side| edge_uvs(mesh, point_of_vertex, side, *a, *b));
    (uvs[0] != uvs[1]).then_some(Seam { triangles: [first.0, second.0], uvs })
}

/// Sets of triangles that grow together.
struct DisjointSets {
    parent: Vec<u32>,
}

impl DisjointSets {
    fn new(len: usize) -> Self {
        Self { parent: (0..len as u32).collect() }
    }

    fn root(&mut self, mut i: u32) -> u32 {
        while self.parent[i as usize] != i {
            let grandparent = self.parent[self.parent[i as usize] as usize];
            self.parent[i as usize] = grandparent;
            i = grandparent;
        }
        i
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        // The smaller number leads, so that the numbering depends on the mesh alone.
        self.parent[a.max(b) as usize] = a.min(b);
    }

    /// The set of each element, numbered in the order of first appearance, and how many there are.
    fn numbered(mut self) -> (Vec<u32>, u32) {
        let mut number = vec![u32::MAX; self.parent.len()];
        let mut count = 0;
        let of = (0..self.parent.len() as u32)
            .map(|i| {
                let root = self.root(i) as usize;
                if number[root] == u32::MAX {
                    number[root] = count;
                    count += 1;
                }
                number[root]
            })
            .collect();
        (of, count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::topology::weld;
    use glam::Vec3;

    /// Two squares side by side in space; in the texture either joined or `gap` apart.
    fn two_squares(gap: f32) -> Mesh {
        let x = |i: f32| Vec3::new(i, 0.0, 0.0);
        let positions_mm =
            vec![x(0.), x(1.), x(1.) + Vec3::Y, Vec3::Y, x(1.), x(2.), x(2.) + Vec3::Y, x(1.) + Vec3::Y];
        let u = |i: f32, j: f32| Vec2::new(i * 0.3, j * 0.3);
        let g = 1.0 + gap;
        let uvs = vec![
            u(0., 0.),
            u(1., 0.),
            u(1., 1.),
            u(0., 1.),
            u(g, 0.),
            u(g + 1., 0.),
            u(g + 1., 1.),
            u(g, 1.),
        ];
        let triangles = vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
        Mesh { positions_mm, uvs, triangles, ..Mesh::default() }
    }

    #[test]
    fn a_gap_in_the_texture_cuts_a_chart_and_leaves_a_seam() {
        let joined = two_squares(0.0);
        let charts = Charts::find(&joined, &weld(&joined.positions_mm));
        assert_eq!((charts.count, charts.seams.len()), (1, 0));

        let cut = two_squares(0.2);
        let charts = Charts::find(&cut, &weld(&cut.positions_mm));
        assert_eq!((charts.count, charts.seams.len()), (2, 1));
        assert_eq!(charts.of_triangle, [0, 0, 1, 1]);
    }

    #[test]
    fn overlap_is_the_doubly_claimed_part_of_the_used_texture() {
        assert_eq!(Charts::overlap_fraction(&two_squares(0.0), 256), 0.0);
        // Shifted by half a square: 1.5 squares are used, half a square twice.
        let overlap = Charts::overlap_fraction(&two_squares(-0.5), 512);
        assert!((overlap - 1.0 / 3.0).abs() < 0.01, "{overlap}");
    }
}
