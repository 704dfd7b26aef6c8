//! How far light has gone through bodies when it comes to a place, and where it entered: what the paper's depth map tells
//! (Green 2004, GPU Gems, listings 16-2 to 16-4), by rays.
//!
//! Symbols: d_o distance of the light from the place, d_i from where it enters, s = d_o - d_i.
//!
//! Growth: listing 16-2 draws the body grown along its normals, but stores distances of the vertices as they are. A texel
//! then tells how far a place of the body is whose grown copy lies there. Here rays meet the grown body, and distances are
//! those of the same place of the triangle as it is. On a convex body with smooth normals s never becomes negative: the ray
//! comes to the grown surface at least g / cos before the plane that touches the body at the place, cos that of the light on
//! it, and the place itself is only g cos behind its copy.
//!
//! Peeling (Everitt 2001; James 2003, after the paper's section 16.4.1; neither opened): surfaces where light enters and
//! where it leaves are told apart, and what lies between leaving and entering again does not count. All behind the last
//! surface that was looked for is flesh; with one surface that is the paper's map.

use super::settings::DepthAbsorptionSettings;
use cutis_scene::{Bvh, Light, LightSample, Object, Scene, SurfacePoint};
use glam::Vec3;

/// Most surfaces that are told apart.
pub const MAX_LAYERS: usize = 16;
/// The same surface of the same body, met again within this way, is the neighbour of a triangle that a ray met at its edge,
/// mm: [`Bvh`] takes triangles for a little larger than they are, by 0.016 mm where one is as large as a hand.
const EDGE_MM: f32 = 0.02;

/// Ways of light through a scene.
pub struct Ways<'a> {
    scene: &'a Scene,
    bvh: &'a Bvh,
    /// The bodies as the depth map shows them, where that is larger than they are.
    grown: Option<Bvh>,
    layers: usize,
    /// Middle of the scene, and how far everything is from there at most, mm.
    bounds_mm: (Vec3, f32),
}

/// One way of light to a place.
#[derive(Debug, Clone, Copy)]
pub struct Way {
    /// Distance s through bodies, mm.
    pub inside_mm: f32,
    /// Object in which it entered.
    pub object: usize,
    /// Where it entered.
    pub entry: SurfacePoint,
}

/// A surface on the way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// How far before the end of the way, mm.
    pub before_mm: f32,
    /// Whether light enters a body there, or leaves it.
    pub enters: bool,
}

impl<'a> Ways<'a> {
    /// Through a scene as some settings see it.
    pub fn new(scene: &'a Scene, bvh: &'a Bvh, settings: &DepthAbsorptionSettings) -> Self {
        let growth_mm = settings.growth_mm;
        let grown = (growth_mm > 0.0).then(|| {
            let places_mm: Vec<_> = scene.objects.iter().map(|o| grown_positions_mm(o, growth_mm)).collect();
            Bvh::moved(&scene.objects, &places_mm)
        });
        let [lo, hi] = scene.bounds_mm().unwrap_or_default();
        // Twice, so that rays begin well before what is grown.
        let bounds_mm = (0.5 * (lo + hi), 0.5 * lo.distance(hi) + 2.0 * growth_mm);
        Self { scene, bvh, grown, layers: settings.layers as usize, bounds_mm }
    }

    /// The way of a light to a place. `None` if nothing is before the place, or what is nearest to the light shows it its
    /// inner side: then nobody knows where the light came in.
    pub fn to(&self, light: &Light, place_mm: Vec3) -> Option<Way> {
        let towards = light.sample(place_mm);
        let mut met = Met { crossings: [Crossing { before_mm: 0.0, enters: false }; MAX_LAYERS], count: 0 };
        let mut first: Option<(usize, SurfacePoint)> = None;
        let mut before: Option<(usize, Crossing)> = None;
        let all = self.surfaces(&towards, place_mm, |object, point| {
            let crossing = crossing(&towards, place_mm, point);
            let again = before.is_some_and(|(before_object, before)| {
                before_object == object
                    && before.enters == crossing.enters
                    && (before.before_mm - crossing.before_mm).abs() < EDGE_MM
            });
            if again {
                return true;
            }
            before = Some((object, crossing));
            first.get_or_insert((object, *point));
            met.crossings[met.count] = crossing;
            met.count += 1;
            met.count < self.layers
        });
        let (object, entry) = first?;
        let inside_mm = inside_mm(&met.crossings[..met.count], all)?;
        Some(Way { inside_mm, object, entry })
    }

    /// Shows the surfaces that a light meets on its way to a place, one after the other, for as long as `wants_more`. Tells
    /// whether those were all.
    fn surfaces(
        &self,
        towards: &LightSample,
        place_mm: Vec3,
        mut wants_more: impl FnMut(usize, &SurfacePoint) -> bool,
    ) -> bool {
        let bvh = self.grown.as_ref().unwrap_or(self.bvh);
        let (middle_mm, radius_mm) = self.bounds_mm;
        // From before all bodies, but not from before the light.
        let mut left_mm = towards.distance_mm.min(place_mm.distance(middle_mm) + radius_mm);
        let dir = -towards.dir_to_light;
        let mut origin_mm = place_mm - dir * left_mm;
        while let Some(hit) = bvh.closest(origin_mm, dir, left_mm) {
            let object = &self.scene.objects[hit.object as usize];
            let point = object.surface_point(hit.triangle, hit.b1, hit.b2);
            if !wants_more(hit.object as usize, &point) {
                return false;
            }
            origin_mm = bvh.step_off(origin_mm + dir * hit.distance_mm, dir);
            left_mm = (place_mm - origin_mm).dot(dir);
            if left_mm <= 0.0 {
                break;
            }
        }
        true
    }
}

/// The first surfaces on a way.
struct Met {
    crossings: [Crossing; MAX_LAYERS],
    count: usize,
}

/// A surface on the way of light to a place.
fn crossing(towards: &LightSample, place_mm: Vec3, point: &SurfacePoint) -> Crossing {
    // A mesh may be wound either way round; its normals point out of it.
    let outwards =
        if point.flat_normal.dot(point.normal) < 0.0 { -point.flat_normal } else { point.flat_normal };
    Crossing {
        before_mm: before_mm(towards, place_mm, point.position_mm),
        enters: outwards.dot(towards.dir_to_light) > 0.0,
    }
}

/// d_o - d_i of a place that light comes to and one where it was before, mm.
fn before_mm(towards: &LightSample, place_mm: Vec3, entry_mm: Vec3) -> f32 {
    let back_mm = entry_mm - place_mm;
    if towards.distance_mm.is_infinite() {
        return back_mm.dot(towards.dir_to_light);
    }
    // |a| - |b| = (a - b)·(a + b) / (|a| + |b|): of two large distances the difference would keep few digits.
    let a = towards.dir_to_light * towards.distance_mm;
    let b = a - back_mm;
    back_mm.dot(a + b) / (a.length() + b.length()).max(f32::MIN_POSITIVE)
}

/// Distance through bodies along surfaces in the order in which light meets them, mm; `all` if there are no more before the
/// end of the way. `None` if light has not come in.
pub fn inside_mm(crossings: &[Crossing], all: bool) -> Option<f32> {
    if !crossings.first()?.enters {
        return None;
    }
    let (mut sum_mm, mut bodies, mut from_mm) = (0.0, 0u32, 0.0);
    for crossing in crossings {
        // What lies behind the place, as its own surface may by rounding, is on nobody's way.
        let before_mm = crossing.before_mm.max(0.0);
        if bodies > 0 {
            sum_mm += from_mm - before_mm;
        }
        from_mm = before_mm;
        bodies = if crossing.enters { bodies + 1 } else { bodies.saturating_sub(1) };
    }
    if bodies > 0 || !all {
        sum_mm += from_mm;
    }
    Some(sum_mm.max(0.0))
}

/// Vertices of an object moved out along its normals, mm. Vertices at one point move together, along the mean of their
/// normals, so that no gap opens at an edge.
pub fn grown_positions_mm(object: &Object, growth_mm: f32) -> Vec<Vec3> {
    let mesh = &object.mesh;
    let mut normals = vec![Vec3::ZERO; mesh.positions_mm.len()];
    for (&point, &normal) in object.point_of_vertex.iter().zip(&mesh.normals) {
        normals[point as usize] += normal;
    }
    let places = mesh.positions_mm.iter().zip(&object.point_of_vertex);
    places.map(|(&p, &point)| p + normals[point as usize].normalize_or_zero() * growth_mm).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn crossings(list: &[(f32, bool)]) -> Vec<Crossing> {
        list.iter().map(|&(before_mm, enters)| Crossing { before_mm, enters }).collect()
    }

    #[test]
    fn what_lies_between_leaving_and_entering_again_does_not_count() {
        let (enters, leaves) = (true, false);
        let two = crossings(&[(10.0, enters), (7.0, leaves), (4.0, enters), (0.0, leaves)]);
        // All surfaces, and the first few of them: the rest is flesh.
        assert_eq!(inside_mm(&two, true), Some(7.0));
        assert_eq!(inside_mm(&two[..3], true), Some(7.0));
        assert_eq!(inside_mm(&two[..1], false), Some(10.0));
        assert_eq!(inside_mm(&two[..2], false), Some(10.0));
        assert_eq!(inside_mm(&two[..3], false), Some(7.0));
        // A body in a body counts once.
        let nested = crossings(&[(9.0, enters), (8.0, enters), (2.0, leaves), (1.0, leaves)]);
        assert_eq!(inside_mm(&nested, true), Some(8.0));
        // The place's own surface a little behind it.
        assert_eq!(inside_mm(&crossings(&[(5.0, enters), (-0.1, leaves)]), true), Some(5.0));
        // Nothing, and the inner side of an open surface.
        assert_eq!(inside_mm(&[], true), None);
        assert_eq!(inside_mm(&crossings(&[(5.0, leaves), (3.0, enters)]), true), None);
    }

    #[test]
    fn growth_never_makes_a_distance_negative_on_a_convex_body() {
        use cutis_scene::validation::shapes::capsule;
        let mesh = capsule(Vec3::new(3.0, -2.0, 1.0), 10.0, 7.0, 96);
        let object = Object::new("capsule", mesh, cutis_scene::Material::default());
        let scene = Scene {
            camera: cutis_scene::Camera::framing(object.mesh.bounds_mm().expect("has points"), Vec3::Z, 0.5),
            objects: vec![object],
            lights: Vec::new(),
            environment: None,
            background: None,
            warnings: Vec::new(),
        };
        let bvh = Bvh::build(&scene.objects);
        for growth_mm in [0.001, 0.2, 2.0, 30.0] {
            let settings = DepthAbsorptionSettings { growth_mm, ..DepthAbsorptionSettings::default() };
            let ways = Ways::new(&scene, &bvh, &settings);
            let mut seen = 0;
            for i in 0..4000u32 {
                let [a, b] = crate::sampling::random2(i, 0, 0, 7).to_array();
                let dir =
                    crate::sampling::cosine_hemisphere(glam::Vec2::new(a, b), Vec3::new(0.2, 0.3, -0.93));
                let object = &scene.objects[0];
                let point = object.surface_point(i * 7 % object.mesh.triangles.len() as u32, 0.3, 0.4);
                let directional = LightSample {
                    dir_to_light: dir,
                    distance_mm: f32::INFINITY,
                    irradiance_w_per_m2: Vec3::ONE,
                };
                for towards in [directional, LightSample { distance_mm: 200.0, ..directional }] {
                    // Facets turn away a little before the smooth surface does.
                    if point.normal.dot(dir) > -0.035 {
                        continue;
                    }
                    ways.surfaces(&towards, point.position_mm, |_, entry| {
                        let before_mm = before_mm(&towards, point.position_mm, entry.position_mm);
                        // Places of 30 mm, told by weights of 24 bits, by way of 200 mm.
                        assert!(before_mm > -1e-3, "{growth_mm}, {i}: {before_mm}");
                        seen += 1;
                        false
                    });
                }
            }
            assert!(seen > 2000, "{seen}");
        }
    }

    #[test]
    fn differences_of_large_distances_keep_their_digits() {
        let towards = LightSample { dir_to_light: Vec3::Z, distance_mm: 1e6, irradiance_w_per_m2: Vec3::ONE };
        let before = before_mm(&towards, Vec3::ZERO, Vec3::new(0.0, 0.0, 1.25));
        // Eight roundings.
        assert!((before - 1.25).abs() < 1.25 * 8.0 * f32::EPSILON, "{before}");
    }
}
