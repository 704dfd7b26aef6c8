//! Rays against the whole scene: a binary hierarchy (obvhs) over the triangles of all objects. The eight-wide compressed
//! one of the same crate is made for GPUs; processors spend longer unpacking it than it saves.

use crate::Object;
use glam::{Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::ray::{Ray, RayHit};
use obvhs::triangle::Triangle;

/// How far outside of a triangle a ray still meets it, as a barycentric weight. From half a metre away, rounding moves a
/// ray by 3e-5 mm, which is as much of the edges of a triangle a millimetre wide.
const EDGE_SLACK: f32 = 1e-4;

/// The acceleration structure of a scene.
pub struct Bvh {
    tree: Bvh2,
    /// Triangles in the tree's own order.
    triangles: Vec<Triangle>,
    /// Object and triangle of each entry above.
    sources: Vec<[u32; 2]>,
    /// Step off the surface that rounding cannot undo, mm.
    offset_mm: f32,
}

/// Where a ray met a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Index of the object in the scene.
    pub object: u32,
    /// Index of the triangle in the object's mesh.
    pub triangle: u32,
    /// Barycentric weight of the triangle's second corner.
    pub b1: f32,
    /// Barycentric weight of the triangle's third corner.
    pub b2: f32,
    /// Distance from the ray's origin, mm.
    pub distance_mm: f32,
}

impl Bvh {
    /// Builds the hierarchy over all triangles.
    pub fn build(objects: &[Object]) -> Self {
        let positions_mm: Vec<_> = objects.iter().map(|object| object.mesh.positions_mm.as_slice()).collect();
        Self::moved(objects, &positions_mm)
    }

    /// The same over the triangles of objects whose vertices lie elsewhere: one list of places for each object, mm.
    pub fn moved(objects: &[Object], positions_mm: &[impl AsRef<[Vec3]>]) -> Self {
        let mut triangles = Vec::new();
        let mut sources = Vec::new();
        for (o, (object, places_mm)) in objects.iter().zip(positions_mm).enumerate() {
            let places_mm = places_mm.as_ref();
            for (t, corners) in object.mesh.triangles.iter().enumerate() {
                let [v0, v1, v2] = corners.map(|v| Vec3A::from(places_mm[v as usize]));
                triangles.push(Triangle { v0, v1, v2 });
                sources.push([o as u32, t as u32]);
            }
        }
        let extent_mm = triangles.iter().fold(0.0f32, |m, t| m.max(t.v0.abs().max_element()));
        let mut time = std::time::Duration::ZERO;
        let tree = build_bvh2_from_tris(&triangles, BvhBuildParams::slow_build(), &mut time);
        let order = |i: &u32| *i as usize;
        Self {
            triangles: tree.primitive_indices.iter().map(|i| triangles[order(i)]).collect(),
            sources: tree.primitive_indices.iter().map(|i| sources[order(i)]).collect(),
            tree,
            // 2^-18 is 32 times the rounding of a coordinate: enough for a ray's whole arithmetic.
            offset_mm: 1e-4 + extent_mm / 262_144.0,
        }
    }

    /// The nearest surface along a ray, up to `max_mm`. `dir` is a unit vector.
    pub fn closest(&self, origin_mm: Vec3, dir: Vec3, max_mm: f32) -> Option<Hit> {
        let ray = ray(origin_mm, dir, max_mm);
        let mut hit = RayHit::none();
        if !self.tree.ray_traverse(ray, &mut hit, |ray, id| intersect(&self.triangles[id], ray)) {
            return None;
        }
        let id = hit.primitive_id as usize;
        let [object, triangle] = self.sources[id];
        let (b1, b2) = barycentric(&self.triangles[id], origin_mm + dir * hit.t);
        Some(Hit { object, triangle, b1, b2, distance_mm: hit.t })
    }

    /// Whether anything lies within `max_mm` along a ray.
    pub fn occluded(&self, origin_mm: Vec3, dir: Vec3, max_mm: f32) -> bool {
        let ray = ray(origin_mm, dir, max_mm);
        !self.tree.ray_traverse_miss(ray, |ray, id| intersect(&self.triangles[id], ray))
    }

    /// A start for rays that leave the surface on the side of `normal`.
    pub fn step_off(&self, position_mm: Vec3, normal: Vec3) -> Vec3 {
        position_mm + normal * self.offset_mm
    }
}

/// A ray as obvhs wants it: a direction of -0 is turned into 0, because the sign of its inverse and the sign that its
/// boxes are sorted by would not agree, and rays along an axis would miss everything.
fn ray(origin_mm: Vec3, dir: Vec3, max_mm: f32) -> Ray {
    Ray::new(origin_mm.into(), (dir + Vec3::ZERO).into(), 0.0, max_mm)
}

/// Distance at which a ray meets a triangle, from either side; infinity if it does not (Möller & Trumbore 1997).
/// Triangles are larger than they are by [`EDGE_SLACK`], so that no ray slips through between two of them.
#[inline(always)]
fn intersect(triangle: &Triangle, ray: &Ray) -> f32 {
    let (e1, e2) = (triangle.v1 - triangle.v0, triangle.v2 - triangle.v0);
    let p = ray.direction.cross(e2);
    let per_determinant = 1.0 / e1.dot(p);
    let to_origin = ray.origin - triangle.v0;
    let b1 = to_origin.dot(p) * per_determinant;
    let q = to_origin.cross(e1);
    let b2 = ray.direction.dot(q) * per_determinant;
    let distance = e2.dot(q) * per_determinant;
    // A ray in the triangle's plane makes every number infinite or NaN, and every comparison false.
    let inside = b1 >= -EDGE_SLACK && b2 >= -EDGE_SLACK && b1 + b2 <= 1.0 + EDGE_SLACK;
    if inside && distance >= ray.tmin && distance <= ray.tmax { distance } else { f32::INFINITY }
}

/// Barycentric weights of the second and third corner for a point of the triangle's plane.
fn barycentric(triangle: &Triangle, point_mm: Vec3) -> (f32, f32) {
    let [origin, v1, v2] = [triangle.v0, triangle.v1, triangle.v2].map(Vec3::from);
    let (e1, e2, p) = (v1 - origin, v2 - origin, point_mm - origin);
    let (d11, d12, d22) = (e1.dot(e1), e1.dot(e2), e2.dot(e2));
    let (p1, p2) = (p.dot(e1), p.dot(e2));
    let determinant = d11 * d22 - d12 * d12;
    if determinant <= 0.0 {
        return (0.0, 0.0); // a triangle without area: any corner will do
    }
    let b1 = ((d22 * p1 - d12 * p2) / determinant).clamp(0.0, 1.0);
    let b2 = ((d11 * p2 - d12 * p1) / determinant).clamp(0.0, 1.0 - b1);
    (b1, b2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Material, Mesh};
    use glam::Vec2;

    /// A square of 2 mm in each of the three planes through the origin, 1 mm in front of it.
    fn corner() -> Vec<Object> {
        let mut mesh = Mesh::default();
        for normal in [Vec3::X, Vec3::Y, Vec3::Z] {
            let (a, b) = normal.any_orthonormal_pair();
            let base = mesh.positions_mm.len() as u32;
            mesh.positions_mm.extend([-a - b, a - b, a + b, b - a].map(|p| p * 2.0 + normal));
            mesh.uvs.extend([Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y]);
            mesh.triangles.extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
        }
        vec![Object::new("corner", mesh, Material::default())]
    }

    #[test]
    fn rays_along_an_axis_hit_whatever_the_sign_of_their_zeros() {
        let objects = corner();
        let bvh = Bvh::build(&objects);
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            // Off the middle, where the two triangles of a square meet.
            let aside = (Vec3::ONE - axis) * Vec3::new(0.31, 0.17, 0.07);
            for (from, dir) in [(axis * 9.0, -axis), (axis * -9.0 - axis, axis)] {
                assert!(bvh.occluded(from + aside, dir, f32::INFINITY), "from {from} along {dir}");
                assert!(bvh.closest(from + aside, dir, f32::INFINITY).is_some(), "from {from} along {dir}");
            }
        }
    }

    #[test]
    fn no_ray_slips_through_a_closed_surface() {
        let sphere = vec![sphere(24)];
        let bvh = Bvh::build(&sphere);
        let mesh = &sphere[0].mesh;
        // Through every edge and every corner, from half a metre away: where two triangles could leave a gap.
        for corners in &mesh.triangles {
            let [a, b, c] = corners.map(|v| mesh.positions_mm[v as usize]);
            for target in [a, b, c, 0.5 * (a + b), 0.3 * b + 0.7 * c, 0.9 * c + 0.1 * a] {
                let eye = Vec3::new(190.0, 220.0, 410.0);
                let dir = (target - eye).normalize();
                // Not near the silhouette, where a flat facet may hide the place.
                if target.dot(dir) < -20.0 {
                    let hit = bvh.closest(eye, dir, f32::INFINITY).expect("hits the sphere");
                    assert!((hit.distance_mm - (target - eye).length()).abs() < 1e-2, "{target}");
                }
            }
        }
    }

    /// A ball of 80 mm with so many rings, its corners off every regular place.
    fn sphere(rings: u32) -> Object {
        let mut mesh = Mesh::default();
        for i in 0..=rings {
            for j in 0..=2 * rings {
                let (uv, turn) = (Vec2::new(j as f32 / (2 * rings) as f32, i as f32 / rings as f32), 0.37);
                let (polar, azimuth) = (uv.y * std::f32::consts::PI, uv.x * std::f32::consts::TAU + turn);
                let dir = Vec3::new(polar.sin() * azimuth.cos(), polar.cos(), polar.sin() * azimuth.sin());
                mesh.positions_mm.push(dir * 80.0);
                mesh.uvs.push(uv);
            }
        }
        let row = 2 * rings + 1;
        for a in (0..rings).flat_map(|i| (0..2 * rings).map(move |j| i * row + j)) {
            mesh.triangles.extend([[a, a + 1, a + row], [a + 1, a + row + 1, a + row]]);
        }
        Object::new("sphere", mesh, Material::default())
    }

    #[test]
    fn a_hit_tells_where_on_the_triangle_it_is() {
        let objects = corner();
        let hit = Bvh::build(&objects)
            .closest(Vec3::new(0.4, 0.9, 5.0), Vec3::NEG_Z, 100.0)
            .expect("hits the square");
        let point = objects[0].surface_point(hit.triangle, hit.b1, hit.b2);
        assert!((point.position_mm - Vec3::new(0.4, 0.9, 1.0)).length() < 1e-5, "{}", point.position_mm);
        assert!((hit.distance_mm - 4.0).abs() < 1e-5);
    }
}
