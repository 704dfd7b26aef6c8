//! Closed bodies, and rays against them in double precision.
//!
//! Single precision and a step off the surface would bias thin parts by half a percent. Here boxes are in single precision
//! and padded, triangles are met in double precision, and a ray never meets the triangle it starts on.

use crate::{Object, SurfacePoint};
use glam::{DVec3, Vec2, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::ray::{Ray, RayHit};

/// Boxes are padded by this part of the largest coordinate: 16 roundings of single precision.
const PADDING: f32 = 1e-6;
/// Bodies that may lie around one another before a ray is given up.
const OVERLAPS_MAX: u32 = 1000;

/// All bodies of a scene.
pub struct Solids<'a> {
    objects: &'a [Object],
    tree: Bvh2,
    /// Triangles in the tree's own order.
    triangles: Vec<Triangle>,
    /// For every object and triangle its number in the tree; [`NOWHERE`] where it has no area.
    numbers: Vec<Vec<u32>>,
}

struct Triangle {
    corner_mm: DVec3,
    edges_mm: [DVec3; 2],
    /// Unit normal, out of the body.
    normal: DVec3,
    object: u32,
    triangle: u32,
}

/// Where a ray meets the surface of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Meeting {
    /// Number of the triangle in the tree: rays that start here leave it out.
    pub id: u32,
    /// Index of the object in the scene.
    pub object: u32,
    /// Distance from the ray's origin, mm.
    pub distance_mm: f64,
    /// Unit normal of the flat triangle, out of the body.
    pub flat_normal: DVec3,
    /// Index of the triangle in the object's mesh.
    pub triangle: u32,
    /// Barycentric weights of its second and third corner.
    pub weights: [f64; 2],
}

/// A ray that may start on a surface and inside of bodies.
#[derive(Debug, Clone, Copy)]
pub struct Ray64 {
    /// Start, mm.
    pub origin_mm: DVec3,
    /// Unit direction.
    pub dir: DVec3,
    /// Triangle the ray starts on; [`NOWHERE`] if on none.
    pub from: u32,
}

/// The ray starts on no triangle.
pub const NOWHERE: u32 = u32::MAX;

impl<'a> Solids<'a> {
    /// Builds the hierarchy.
    pub fn new(objects: &'a [Object]) -> Self {
        let mut triangles = Vec::new();
        for (o, object) in objects.iter().enumerate() {
            let outwards = if signed_volume_mm3(object) < 0.0 { -1.0 } else { 1.0 };
            for t in 0..object.mesh.triangles.len() {
                let [a, b, c] = object.mesh.corners_mm(t).map(|p| p.as_dvec3());
                let edges_mm = [b - a, c - a];
                let normal = edges_mm[0].cross(edges_mm[1]).normalize_or_zero() * outwards;
                triangles.push(Triangle {
                    corner_mm: a,
                    edges_mm,
                    normal,
                    object: o as u32,
                    triangle: t as u32,
                });
            }
        }
        // A triangle without area has no inside and no outside.
        triangles.retain(|t| t.normal != DVec3::ZERO);
        let largest =
            triangles.iter().flat_map(Triangle::corners).fold(0f64, |m, p| m.max(p.abs().max_element()));
        let padding = Vec3A::splat(largest as f32 * PADDING);
        let boxes: Vec<Aabb> = triangles
            .iter()
            .map(|t| {
                let corners = t.corners().map(|p| Vec3A::from(p.as_vec3()));
                let tight = Aabb::from_points(&corners);
                Aabb::new(tight.min - padding, tight.max + padding)
            })
            .collect();
        let mut time = std::time::Duration::ZERO;
        let tree = build_bvh2(&boxes, BvhBuildParams::slow_build(), &mut time);
        let mut slots: Vec<Option<Triangle>> = triangles.into_iter().map(Some).collect();
        let triangles: Vec<Triangle> =
            tree.primitive_indices.iter().filter_map(|&i| slots[i as usize].take()).collect();
        let mut numbers: Vec<Vec<u32>> =
            objects.iter().map(|o| vec![NOWHERE; o.mesh.triangles.len()]).collect();
        for (number, t) in triangles.iter().enumerate() {
            numbers[t.object as usize][t.triangle as usize] = number as u32;
        }
        Self { objects, tree, triangles, numbers }
    }

    /// The nearest surface within `max_mm`.
    pub fn nearest(&self, ray: &Ray64, max_mm: f64) -> Option<Meeting> {
        let mut best: Option<(f64, u32, [f64; 2])> = None;
        let mut nearest_mm = max_mm;
        let mut hit = RayHit::none();
        self.tree.ray_traverse(single(ray, max_mm), &mut hit, |_, id| {
            if id as u32 == ray.from {
                return f32::INFINITY;
            }
            match self.triangles[id].meet(ray.origin_mm, ray.dir) {
                Some((distance_mm, weights)) if distance_mm < nearest_mm => {
                    nearest_mm = distance_mm;
                    best = Some((distance_mm, id as u32, weights));
                    // Rounded up, so that the box of something nearer is still looked into.
                    (distance_mm as f32).next_up().max(f32::MIN_POSITIVE)
                }
                _ => f32::INFINITY,
            }
        });
        let (distance_mm, id, weights) = best?;
        let Triangle { normal, object, triangle, .. } = self.triangles[id as usize];
        Some(Meeting { id, object, distance_mm, flat_normal: normal, triangle, weights })
    }

    /// Whether a body lies within `max_mm`.
    pub fn occluded(&self, ray: &Ray64, max_mm: f64) -> bool {
        !self.tree.ray_traverse_miss(single(ray, max_mm), |_, id| {
            if id as u32 == ray.from {
                return f32::INFINITY;
            }
            match self.triangles[id].meet(ray.origin_mm, ray.dir) {
                Some((distance_mm, _)) if distance_mm < max_mm => 0.0,
                _ => f32::INFINITY,
            }
        })
    }

    /// The way out of the body: the nearest surface within `max_mm` through which the ray leaves all the bodies it is in.
    /// Where another body begins before the first one ends, the first one's inside goes on through it. `within` counts the
    /// bodies around the start and is brought up to date.
    pub fn way_out(&self, ray: &Ray64, max_mm: f64, within: &mut u32) -> Option<Meeting> {
        let (mut ray, mut gone_mm) = (*ray, 0.0);
        for _ in 0..OVERLAPS_MAX {
            let mut meeting = self.nearest(&ray, max_mm - gone_mm)?;
            gone_mm += meeting.distance_mm;
            let leaves = meeting.flat_normal.dot(ray.dir) > 0.0;
            if leaves && *within <= 1 {
                meeting.distance_mm = gone_mm;
                return Some(meeting);
            }
            *within = if leaves { *within - 1 } else { *within + 1 };
            ray = Ray64 { origin_mm: ray.origin_mm + ray.dir * meeting.distance_mm, from: meeting.id, ..ray };
        }
        None
    }

    /// The smooth surface at a meeting.
    pub fn surface(&self, meeting: &Meeting) -> SurfacePoint {
        let [b1, b2] = meeting.weights.map(|w| w as f32);
        self.objects[meeting.object as usize].surface_point(meeting.triangle, b1, b2)
    }

    /// The object a meeting is with.
    pub fn object(&self, meeting: &Meeting) -> &'a Object {
        &self.objects[meeting.object as usize]
    }

    /// Number of triangles.
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Whether there is nothing at all.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// Area of triangle `id`, mm².
    pub fn area_mm2(&self, id: usize) -> f64 {
        let [e1, e2] = self.triangles[id].edges_mm;
        0.5 * e1.cross(e2).length()
    }

    /// The place on triangle `id` with these barycentric weights of its second and third corner, and where it is, mm.
    pub fn place(&self, id: usize, weights: [f64; 2]) -> (Meeting, DVec3) {
        let Triangle { corner_mm, edges_mm: [e1, e2], normal, object, triangle } = self.triangles[id];
        let meeting =
            Meeting { id: id as u32, object, distance_mm: 0.0, flat_normal: normal, triangle, weights };
        (meeting, corner_mm + e1 * weights[0] + e2 * weights[1])
    }

    /// The same for a triangle of an object's mesh; none where it has no area or there is no such triangle.
    pub fn place_on(&self, object: usize, triangle: u32, weights: [f64; 2]) -> Option<(Meeting, DVec3)> {
        let number = *self.numbers.get(object)?.get(triangle as usize)?;
        (number != NOWHERE).then(|| self.place(number as usize, weights))
    }

    /// Distance to the nearest surface of an object, mm, where that is nearer than `max_mm`.
    pub fn depth_mm(&self, point_mm: DVec3, object: u32, max_mm: f64) -> Option<f64> {
        let mut nearest2 = max_mm * max_mm;
        let mut found = false;
        let reach = Vec3A::splat(max_mm as f32 * (1.0 + PADDING));
        let point = Vec3A::from(point_mm.as_vec3());
        self.tree.aabb_traverse(Aabb::new(point - reach, point + reach), |tree, node| {
            let node = &tree.nodes[node as usize];
            for id in node.first_index..node.first_index + node.prim_count {
                let triangle = &self.triangles[id as usize];
                if triangle.object == object {
                    let distance2 = (triangle.nearest_point_mm(point_mm) - point_mm).length_squared();
                    if distance2 < nearest2 {
                        (nearest2, found) = (distance2, true);
                    }
                }
            }
            true
        });
        found.then(|| nearest2.sqrt())
    }

    /// Where a meeting lies in the maps of light.
    pub fn atlas_uv(&self, meeting: &Meeting) -> Vec2 {
        let [b1, b2] = meeting.weights.map(|w| w as f32);
        self.objects[meeting.object as usize].atlas_uv_at(meeting.triangle, b1, b2)
    }
}

/// The ray as obvhs wants it; -0 is turned into 0 as in [`crate::Bvh`].
fn single(ray: &Ray64, max_mm: f64) -> Ray {
    let (origin, dir) = (ray.origin_mm.as_vec3(), (ray.dir + DVec3::ZERO).as_vec3());
    Ray::new(origin.into(), dir.into(), 0.0, (max_mm as f32).next_up())
}

impl Triangle {
    fn corners(&self) -> [DVec3; 3] {
        [self.corner_mm, self.corner_mm + self.edges_mm[0], self.corner_mm + self.edges_mm[1]]
    }

    /// Distance and barycentric weights where a ray meets the triangle, from either side (Möller & Trumbore 1997).
    #[inline(always)]
    fn meet(&self, origin_mm: DVec3, dir: DVec3) -> Option<(f64, [f64; 2])> {
        let [e1, e2] = self.edges_mm;
        let p = dir.cross(e2);
        let per_determinant = 1.0 / e1.dot(p);
        let to_origin = origin_mm - self.corner_mm;
        let b1 = to_origin.dot(p) * per_determinant;
        let q = to_origin.cross(e1);
        let b2 = dir.dot(q) * per_determinant;
        let distance_mm = e2.dot(q) * per_determinant;
        // A ray in the triangle's plane makes every number infinite or NaN, and every comparison false.
        let inside = b1 >= -EDGE_SLACK && b2 >= -EDGE_SLACK && b1 + b2 <= 1.0 + EDGE_SLACK;
        (inside && distance_mm > 0.0).then_some((distance_mm, [b1, b2]))
    }

    /// The point of the triangle nearest to another (Ericson 2005, Real-Time Collision Detection, 5.1.5; not opened).
    fn nearest_point_mm(&self, point_mm: DVec3) -> DVec3 {
        let [a, b, c] = self.corners();
        let [ab, ac] = self.edges_mm;
        let on_segment = |from: DVec3, along: DVec3| {
            let share = (point_mm - from).dot(along) / along.length_squared();
            from + along * share.clamp(0.0, 1.0)
        };
        let above = self.normal.dot(point_mm - a);
        let flat = point_mm - self.normal * above - a;
        let (d11, d12, d22) = (ab.dot(ab), ab.dot(ac), ac.dot(ac));
        let (p1, p2) = (flat.dot(ab), flat.dot(ac));
        let determinant = d11 * d22 - d12 * d12;
        let (b1, b2) = ((d22 * p1 - d12 * p2) / determinant, (d11 * p2 - d12 * p1) / determinant);
        if b1 >= 0.0 && b2 >= 0.0 && b1 + b2 <= 1.0 {
            return a + flat;
        }
        let sides = [on_segment(a, ab), on_segment(a, ac), on_segment(b, c - b)];
        let distance2 = |p: &DVec3| (*p - point_mm).length_squared();
        sides.into_iter().min_by(|p, q| distance2(p).total_cmp(&distance2(q))).unwrap_or(a)
    }
}

/// How far outside of a triangle a ray still meets it, as a barycentric weight: what rounding makes of the edges in double
/// precision, and some.
const EDGE_SLACK: f64 = 1e-12;

/// Volume enclosed by a closed mesh, mm³; negative if it is inside out.
pub fn signed_volume_mm3(object: &Object) -> f64 {
    let corners = (0..object.mesh.triangles.len()).map(|t| object.mesh.corners_mm(t).map(|p| p.as_dvec3()));
    corners.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}
