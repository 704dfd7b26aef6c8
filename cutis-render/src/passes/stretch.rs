//! Stretch: how many millimetres of surface one texel covers along u and along v
//! (d'Eon, Luebke & Enderton 2007, section 5.1; the paper stores the reciprocal).
//!
//! The derivatives of a flat triangle are exact, where the paper takes screen-space differences; but they jump from one
//! triangle to the next, which the surface that the mesh stands for does not. So texels per millimetre, squared, are
//! averaged at every vertex over the triangles around it, and the squared stretch is interpolated between vertices.
//! Triangles count by their areas on the surface and in the texture: slivers, whose derivatives are rounding, count for
//! nothing.

use crate::passes::atlas::{Atlas, NO_CHART, TexelSurface};
use cutis_scene::Object;
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Texels that stand still in space would have no size; nothing smaller than a micrometre is believed.
const MIN_STRETCH_MM: f32 = 1e-3;

/// Millimetres per texel along u and v, for every texel of the atlas. Empty texels hold 0.
pub fn stretch_mm_per_texel(object: &Object, atlas: &Atlas) -> Vec<Vec2> {
    let texels = atlas.size as f32;
    let at_vertices = squared_lengths_at_vertices_mm2(object);
    let of = |s: &TexelSurface| {
        if s.triangle == NO_CHART {
            return Vec2::ZERO;
        }
        let [a, b, c] = object.mesh.triangles[s.triangle as usize].map(|v| at_vertices[v as usize]);
        let squared = a * (1.0 - s.b1 - s.b2) + b * s.b1 + c * s.b2;
        (squared.max(Vec2::ZERO).map(f32::sqrt) / texels).max(Vec2::splat(MIN_STRETCH_MM))
    };
    atlas.surface.par_iter().map(of).collect()
}

/// |dX/du|² and |dX/dv|² at every vertex, mm² per unit of the texture.
fn squared_lengths_at_vertices_mm2(object: &Object) -> Vec<Vec2> {
    let mesh = &object.mesh;
    let mut sums = vec![(Vec2::ZERO, 0.0f32); mesh.positions_mm.len()];
    for (t, vertices) in mesh.triangles.iter().enumerate() {
        let Some([along_u, along_v]) = derivatives_mm(object, t) else { continue };
        let squares = Vec2::new(along_u.length_squared(), along_v.length_squared());
        let [a, b, c] = mesh.corner_atlas_uvs(t);
        let area = mesh.area_mm2(t) * (b - a).perp_dot(c - a).abs();
        let share = area * squares.recip();
        if !share.is_finite() {
            continue;
        }
        for &v in vertices {
            let (sum, weight) = &mut sums[v as usize];
            *sum += share;
            *weight += area;
        }
    }
    sums.into_iter().map(|(sum, weight)| weight / sum.max(Vec2::splat(f32::MIN_POSITIVE))).collect()
}

/// dX/du and dX/dv of a triangle, mm per unit of the texture. `None` if it has no area in the texture.
pub fn derivatives_mm(object: &Object, triangle: usize) -> Option<[Vec3; 2]> {
    let [p0, p1, p2] = object.mesh.corners_mm(triangle);
    let [t0, t1, t2] = object.mesh.corner_atlas_uvs(triangle);
    let (e1, e2, d1, d2) = (p1 - p0, p2 - p0, t1 - t0, t2 - t0);
    let determinant = d1.perp_dot(d2);
    (determinant != 0.0)
        .then(|| [(e1 * d2.y - e2 * d1.y) / determinant, (e2 * d1.x - e1 * d2.x) / determinant])
}

#[cfg(test)]
mod tests {
    use super::*;
    use cutis_scene::{Material, Mesh};

    /// Two triangles over the unit square of the texture: 3 mm by 2 mm, bent along the diagonal so that the second is
    /// twice as wide.
    fn bent() -> Object {
        let corners = [
            (0.0, 0.0, [0.0, 0.0]),
            (3.0, 0.0, [1.0, 0.0]),
            (0.0, -2.0, [0.0, 1.0]),
            (6.0, -2.0, [1.0, 1.0]),
        ];
        let mesh = Mesh {
            positions_mm: corners.iter().map(|c| Vec3::new(c.0, c.1, 0.0)).collect(),
            uvs: corners.iter().map(|c| Vec2::from_array(c.2)).collect(),
            triangles: vec![[0, 2, 1], [1, 2, 3]],
            ..Mesh::default()
        };
        Object::new("bent", mesh, Material::default())
    }

    #[test]
    fn the_derivatives_of_a_triangle_are_its_edges_in_the_texture() {
        let [along_u, along_v] = derivatives_mm(&bent(), 0).expect("has area");
        assert!((along_u - Vec3::new(3.0, 0.0, 0.0)).length() < 1e-6);
        assert!((along_v - Vec3::new(0.0, -2.0, 0.0)).length() < 1e-6);
    }

    #[test]
    fn a_sliver_in_the_texture_does_no_harm_to_its_neighbours() {
        let plain = bent();
        let mut mesh = plain.mesh.clone();
        // A large triangle in space, next to none in the texture.
        mesh.positions_mm.push(Vec3::new(0.0, 9.0, 0.0));
        mesh.uvs.push(Vec2::new(0.5, -1e-7));
        mesh.normals.push(Vec3::Z);
        mesh.tangents.push(glam::Vec4::X);
        mesh.triangles.push([0, 1, 4]);
        let spoiled = Object::new("spoiled", mesh, Material::default());
        let [before, after] = [&plain, &spoiled].map(squared_lengths_at_vertices_mm2);
        for (b, a) in before.iter().zip(&after) {
            assert!((*b - *a).abs().max_element() < 1e-3 * b.max_element(), "{b} {a}");
        }
    }

    #[test]
    fn stretch_is_continuous_across_an_edge() {
        let object = bent();
        let size = 64;
        let stretch = stretch_mm_per_texel(&object, &Atlas::new(&object, size));
        // Along a row the stretch in u runs from 3 mm on the left to 6 mm on the right without a jump.
        let row = &stretch[32 * size..33 * size];
        let steps = row.windows(2).map(|w| (w[1].x - w[0].x).abs());
        let largest = steps.fold(0.0, f32::max);
        assert!(row[0].x < 4.5 / 64.0 && row[63].x > 5.0 / 64.0, "{} {}", row[0].x, row[63].x);
        assert!(largest < 0.1 / 64.0, "{largest}");
    }
}
