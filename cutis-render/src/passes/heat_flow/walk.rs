//! Straight ways over the surface, from a texel's centre to where a neighbour would be: across seams into other charts.

use super::metric::derivatives_mm_per_texel;
use cutis_scene::Object;
use cutis_scene::topology::edges;
use glam::{Vec2, Vec3};

/// Triangles that a way of a texel or two may cross.
const CROSSINGS: usize = 256;
/// Beyond an edge by this, in barycentric weights, is rounding.
const ROUNDING: f32 = 1e-5;
/// What ends so little beyond a seam, or a border, ends on it: centres of texels that lie on the surface may miss it by as much, those of
/// the padding are farther off.
pub const ON_THE_EDGE_TEXELS: f32 = 3e-3;

/// A mesh that can be walked on.
pub struct Ground<'a> {
    object: &'a Object,
    size: usize,
    /// For every corner of every triangle the triangle and corner across the edge that begins there.
    across: Vec<[Option<(u32, u8)>; 3]>,
}

/// Where a way has led.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arrival {
    /// The triangle.
    pub triangle: u32,
    /// The place on the texture, texels.
    pub place: Vec2,
    /// Whether it has crossed a seam.
    pub over_seam: bool,
    /// Whether it ended at an open border.
    pub at_border: bool,
}

impl<'a> Ground<'a> {
    /// Of an object with a texture of `size` texels.
    pub fn new(object: &'a Object, size: usize) -> Self {
        let mut across = vec![[None; 3]; object.mesh.triangles.len()];
        let ends = |triangle: u32, corner: u8| {
            let points = object.mesh.triangles[triangle as usize].map(|v| object.point_of_vertex[v as usize]);
            [points[usize::from(corner)], points[(usize::from(corner) + 1) % 3]]
        };
        for uses in edges(&object.mesh, &object.point_of_vertex).values() {
            // Where more than two triangles meet nobody knows which way is straight on, nor where one of both is inside out.
            if let [(t, i), (u, j)] = uses[..]
                && ends(t, i) == [ends(u, j)[1], ends(u, j)[0]]
            {
                across[t as usize][usize::from(i)] = Some((u, j));
                across[u as usize][usize::from(j)] = Some((t, i));
            }
        }
        Self { object, size, across }
    }

    /// Makes borders of the edges of charts that are not `alive`.
    pub fn leave_out(&mut self, alive: impl Fn(u32) -> bool) {
        for (triangle, across) in self.across.iter_mut().enumerate() {
            let own = alive(self.object.charts.of_triangle[triangle]);
            across.iter_mut().for_each(|edge| {
                *edge =
                    edge.filter(|&(other, _)| own && alive(self.object.charts.of_triangle[other as usize]));
            });
        }
    }

    /// Whether the texture goes on across the edge that begins at a corner.
    pub fn goes_on(&self, triangle: u32, corner: u8) -> bool {
        let Some((other, there)) = self.across(triangle, corner) else { return false };
        let (own, others) = (self.corners(triangle), self.corners(other));
        let (i, j) = (usize::from(corner), usize::from(there));
        let same = |a: Vec2, b: Vec2| (a - b).abs().max_element() < 1e-4;
        same(own[i], others[(j + 1) % 3]) && same(own[(i + 1) % 3], others[j])
    }

    /// The triangle and corner across the edge that begins at a corner.
    pub fn across(&self, triangle: u32, corner: u8) -> Option<(u32, u8)> {
        self.across[triangle as usize][usize::from(corner)]
    }

    /// Number of triangles.
    pub fn triangle_count(&self) -> u32 {
        self.across.len() as u32
    }

    /// The ends, on the texture, of the edge that begins at a corner, texels.
    pub fn edge(&self, triangle: u32, corner: u8) -> [Vec2; 2] {
        let corners = self.corners(triangle);
        [corners[usize::from(corner)], corners[(usize::from(corner) + 1) % 3]]
    }

    /// Corners on the texture, texels.
    pub fn corners(&self, triangle: u32) -> [Vec2; 3] {
        self.object.mesh.corner_atlas_uvs(triangle as usize).map(|uv| uv * self.size as f32)
    }

    /// Goes straight on from a place of a triangle by a step on the texture, both in texels.
    pub fn walk(&self, triangle: u32, place: Vec2, step: Vec2) -> Arrival {
        let mut at = Arrival { triangle, place, over_seam: false, at_border: false };
        let (mut step, mut entered) = (step, None);
        for _ in 0..CROSSINGS {
            let Some((corner, part)) = self.exit(at.triangle, at.place, step, entered) else {
                at.place += step;
                return at;
            };
            let edge_place = at.place + step * part;
            let rest = step * (1.0 - part);
            let goes_on = self.goes_on(at.triangle, corner);
            if !goes_on && self.apart(at.triangle, corner, at.place + step) < ON_THE_EDGE_TEXELS {
                at.place += step;
                return at;
            }
            let Some((other, there)) = self.across(at.triangle, corner) else {
                return Arrival { place: edge_place, at_border: true, ..at };
            };
            if goes_on {
                (at.place, step) = (edge_place, rest);
            } else {
                let Some((place, turned)) =
                    self.over_seam(at.triangle, corner, other, there, edge_place, rest)
                else {
                    return Arrival { place: edge_place, at_border: true, ..at };
                };
                (at.place, step, at.over_seam) = (place, turned, true);
            }
            (at.triangle, entered) = (other, Some(there));
        }
        Arrival { at_border: true, ..at }
    }

    /// How far from an edge of a triangle a place lies, texels.
    fn apart(&self, triangle: u32, corner: u8, place: Vec2) -> f32 {
        let [a, b] = self.edge(triangle, corner);
        let along = (place - a).dot(b - a) / (b - a).length_squared().max(f32::MIN_POSITIVE);
        place.distance(a.lerp(b, along.clamp(0.0, 1.0)))
    }

    /// The edge, by the corner that it begins at, through which a step leaves a triangle, and after which part of it; none if it
    /// ends inside. It does not leave where it has come in.
    fn exit(&self, triangle: u32, place: Vec2, step: Vec2, entered: Option<u8>) -> Option<(u8, f32)> {
        let corners = self.corners(triangle);
        let area = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]);
        if area == 0.0 || !area.is_finite() {
            // Without an area it is left where it was not entered.
            return Some(((entered.unwrap_or(0) + 1) % 3, 0.0));
        }
        let mut first: Option<(u8, f32)> = None;
        for corner in (0..3u8).filter(|corner| Some(*corner) != entered) {
            let (a, b) = (corners[usize::from(corner)], corners[(usize::from(corner) + 1) % 3]);
            // Weight of the opposite corner: 0 on the edge, falling outwards.
            let weight = |p: Vec2| (b - a).perp_dot(p - a) / area;
            let (now, then) = (weight(place), weight(place + step));
            if then < -ROUNDING && then < now {
                let part = (now.max(0.0) / (now.max(0.0) - then)).clamp(0.0, 1.0);
                if first.is_none_or(|(_, least)| part < least) {
                    first = Some((corner, part));
                }
            }
        }
        first
    }

    /// A place of a seam and the rest of a step, on the texture of the triangle across: along the edge as it was, and across the
    /// edge as far, in the plane of the other triangle.
    fn over_seam(
        &self,
        triangle: u32,
        corner: u8,
        other: u32,
        there: u8,
        edge_place: Vec2,
        rest: Vec2,
    ) -> Option<(Vec2, Vec2)> {
        let (i, j) = (usize::from(corner), usize::from(there));
        let (own, others) = (self.corners(triangle), self.corners(other));
        let edge = own[(i + 1) % 3] - own[i];
        let along = ((edge_place - own[i]).dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
        // The other triangle runs along the edge the other way.
        let place = others[(j + 1) % 3].lerp(others[j], along);
        let [xu, xv] = derivatives_mm_per_texel(self.object, triangle as usize, self.size)?;
        let [yu, yv] = derivatives_mm_per_texel(self.object, other as usize, self.size)?;
        let mesh = &self.object.mesh;
        let (p, q) = (mesh.corners_mm(triangle as usize), mesh.corners_mm(other as usize));
        let edge_dir = (p[(i + 1) % 3] - p[i]).try_normalize()?;
        let step_mm = xu * rest.x + xv * rest.y;
        let along_mm = step_mm.dot(edge_dir);
        let across_mm = (step_mm - edge_dir * along_mm).length();
        let inwards: Vec3 = q[(j + 2) % 3] - q[j];
        let inwards = (inwards - edge_dir * inwards.dot(edge_dir)).try_normalize()?;
        let turned_mm = edge_dir * along_mm + inwards * across_mm;
        // Back onto the texture: the normal equations of two axes.
        let (e, f, g) = (yu.length_squared(), yu.dot(yv), yv.length_squared());
        let determinant = e * g - f * f;
        let (u, v) = (turned_mm.dot(yu), turned_mm.dot(yv));
        let turned = Vec2::new(u * g - v * f, v * e - u * f) / determinant;
        turned.is_finite().then_some((place, turned))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cutis_scene::{Material, Mesh};

    fn two_triangles(second: [u32; 3]) -> Object {
        let corners = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
        let mesh = Mesh {
            positions_mm: corners.iter().map(|c| c.extend(0.0)).collect(),
            uvs: corners.iter().map(|c| 0.25 + 0.5 * *c).collect(),
            triangles: vec![[0, 1, 2], second],
            ..Mesh::default()
        };
        Object::new("two", mesh, Material::default())
    }

    /// Straight on into the next triangle, unless that one is inside out.
    #[test]
    fn ways_end_where_a_triangle_is_inside_out() {
        for (second, crosses) in [([0, 2, 3], true), ([0, 3, 2], false)] {
            let object = two_triangles(second);
            let way = Ground::new(&object, 64).walk(0, Vec2::new(36.0, 30.0), Vec2::new(-6.0, 6.0));
            assert_eq!((way.triangle == 1, way.at_border), (crosses, !crosses), "{way:?}");
        }
    }
}
