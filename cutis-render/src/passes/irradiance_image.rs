//! The irradiance as an image, with the place and the normal of what is seen: what a camera or a light sees of it
//! (Mertens et al. 2003, section 5).

use crate::lit_scene::Lit;
use crate::passes::irradiance::irradiance_at;
use crate::prepare::LightView;
use crate::progress::Progress;
use crate::technique::image_space::plane_normal;
use cutis_scene::Camera;
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// In place of an object: nothing is seen.
const NOTHING: u32 = u32::MAX;
/// Cosine between view and surface below which a texel's plane is not followed beyond its middle.
pub const GRAZING: f32 = 0.02;
/// Most area on the body that an area on the tangent plane may stand for: at the edges of things it has no bound.
pub const MAX_JACOBIAN: f32 = 8.0;
/// Part of a distance that is lost by rounding: a few digits of an f32.
pub const ROUNDING: f32 = 1e-6;
/// Widths of texels within which two depths are one surface.
pub const SAME_SURFACE_TEXELS: f32 = 2.0;
/// Cosine between normals above which two places are on one side of a thin part.
pub const SAME_SIDE: f32 = 0.3;
/// Cosine between view and surface below which a texel holds no more depths than at it.
pub const MIN_SLANT: f32 = 0.1;

/// From where an image is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Whether the view lines are parallel.
    pub parallel: bool,
    /// The eye, mm; for parallel lines a point that they are counted from.
    pub origin_mm: Vec3,
    /// Unit axis to the right.
    pub right: Vec3,
    /// Unit axis upwards.
    pub up: Vec3,
    /// Unit axis of the view.
    pub forward: Vec3,
    /// Half the width and half the height: in mm for parallel lines, else at distance 1.
    pub half: Vec2,
}

impl View {
    /// That of a camera, with a picture of this shape.
    pub fn of_camera(camera: &Camera, aspect_width_over_height: f32) -> Self {
        let [right, up, forward] = camera.axes();
        let half_height = (0.5 * camera.vertical_fov_rad).tan();
        let half = Vec2::new(half_height * aspect_width_over_height, half_height);
        Self { parallel: false, origin_mm: camera.position_mm, right, up, forward, half }
    }

    /// That of a light.
    pub fn of_light(view: &LightView) -> Self {
        let LightView { parallel, origin_mm, right, up, forward, half_width, .. } = *view;
        Self { parallel, origin_mm, right, up, forward, half: Vec2::splat(half_width) }
    }

    /// Where a point falls: (0, 0) is the upper left corner, (1, 1) the lower right. `None` for points behind the eye.
    fn place_of(&self, point_mm: Vec3) -> Option<Vec2> {
        let p = point_mm - self.origin_mm;
        let depth = if self.parallel { 1.0 } else { self.forward.dot(p) };
        let ndc = Vec2::new(self.right.dot(p), self.up.dot(p)) / (self.half * depth);
        (depth > 0.0).then(|| Vec2::new(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y))
    }

    /// The view line through a place of the image: where it begins, and its unit direction.
    fn line_through(&self, place: Vec2) -> [Vec3; 2] {
        let ndc = Vec2::new(2.0 * place.x - 1.0, 1.0 - 2.0 * place.y) * self.half;
        let aside = self.right * ndc.x + self.up * ndc.y;
        if self.parallel {
            [self.origin_mm + aside, self.forward]
        } else {
            [self.origin_mm, (self.forward + aside).normalize()]
        }
    }

    /// Direction of the view line through a point.
    pub fn dir_at(&self, point_mm: Vec3) -> Vec3 {
        if self.parallel { self.forward } else { (point_mm - self.origin_mm).normalize_or(self.forward) }
    }

    /// Distance along the view line, mm.
    fn distance_mm(&self, point_mm: Vec3) -> f32 {
        if self.parallel {
            self.forward.dot(point_mm - self.origin_mm)
        } else {
            point_mm.distance(self.origin_mm)
        }
    }

    /// Area on the body around `body_mm` over the area on a plane around `plane_mm`, which lies on the same view line: both fill
    /// the same solid angle. (The paper prints the inverse of this, between equations 8 and 9.)
    pub fn jacobian(&self, [body_mm, body_normal]: [Vec3; 2], [plane_mm, plane_normal]: [Vec3; 2]) -> f32 {
        let dir = self.dir_at(plane_mm);
        let farther = if self.parallel {
            1.0
        } else {
            self.distance_mm(body_mm) / self.distance_mm(plane_mm).max(1e-6)
        };
        let cosines = plane_normal.dot(dir).abs() / body_normal.dot(dir).abs().max(1e-6);
        (farther * farther * cosines).min(MAX_JACOBIAN)
    }
}

/// One texel.
#[derive(Debug, Clone, Copy)]
struct Texel {
    position_mm: Vec3,
    normal: Vec3,
    irradiance_w_per_m2: Vec3,
    object: u32,
}

/// A texel that shows nothing.
const EMPTY: Texel =
    Texel { position_mm: Vec3::ZERO, normal: Vec3::Z, irradiance_w_per_m2: Vec3::ZERO, object: NOTHING };

/// The image.
pub struct IrradianceImage {
    /// From where it is seen.
    pub view: View,
    size: [usize; 2],
    texels: Vec<Texel>,
}

/// What the image shows in the place of a point.
#[derive(Debug, Clone, Copy)]
pub struct Seen {
    /// Place on the body, mm.
    pub position_mm: Vec3,
    /// From the point that was asked for to that place, mm: nothing where both are one but for rounding.
    pub from_point_mm: Vec3,
    /// Unit normal there: see [`plane_normal`].
    pub normal: Vec3,
    /// Irradiance under the surface, W/m².
    pub irradiance_w_per_m2: Vec3,
    /// Width of the texel on the body along the view, mm: how far the place may be off.
    pub uncertain_mm: f32,
}

impl IrradianceImage {
    /// What is seen of a scene in an image of so many texels.
    pub fn new(lit: Lit, view: View, size: [usize; 2], progress: &dyn Progress) -> Self {
        progress.begin("irradiance image", size[1] as u64);
        // Parallel lines begin before everything.
        let back_mm = if view.parallel { before_all_mm(lit, &view) } else { 0.0 };
        let row = |y: usize| {
            progress.advance(1);
            let wanted = progress.goes_on();
            let texel = |x: usize| {
                let place =
                    Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / Vec2::new(size[0] as f32, size[1] as f32);
                let [from_mm, dir] = view.line_through(place);
                if wanted { seen_along(lit, from_mm - dir * back_mm, dir) } else { EMPTY }
            };
            (0..size[0]).map(texel).collect::<Vec<_>>()
        };
        let texels = (0..size[1]).into_par_iter().flat_map_iter(row).collect();
        Self { view, size, texels }
    }

    fn texel(&self, point_mm: Vec3, object: usize) -> Option<&Texel> {
        let place = self.view.place_of(point_mm)? * Vec2::new(self.size[0] as f32, self.size[1] as f32);
        let inside =
            place.min_element() >= 0.0 && place.x < self.size[0] as f32 && place.y < self.size[1] as f32;
        let texel = inside.then(|| &self.texels[place.y as usize * self.size[0] + place.x as usize])?;
        (texel.object == object as u32).then_some(texel)
    }

    /// What of an object is seen in the place of a point.
    pub fn through(&self, point_mm: Vec3, object: usize) -> Option<Seen> {
        let texel = self.texel(point_mm, object)?;
        let dir = self.view.dir_at(point_mm);
        let cos = texel.normal.dot(dir);
        // The middle of a texel lies a little aside: its plane is followed to the view line of the point.
        let further_mm = if cos.abs() < GRAZING {
            self.view.distance_mm(texel.position_mm) - self.view.distance_mm(point_mm)
        } else {
            texel.normal.dot(texel.position_mm - point_mm) / cos
        };
        let rounding_mm = ROUNDING * self.view.distance_mm(point_mm).abs();
        let from_point_mm = if further_mm.abs() < rounding_mm { Vec3::ZERO } else { dir * further_mm };
        Some(Seen {
            position_mm: point_mm + from_point_mm,
            from_point_mm,
            normal: texel.normal,
            irradiance_w_per_m2: texel.irradiance_w_per_m2,
            uncertain_mm: self.uncertain_mm(texel),
        })
    }

    /// Depths that a texel's surface has within the texel, mm.
    fn uncertain_mm(&self, texel: &Texel) -> f32 {
        let spread = if self.view.parallel { 1.0 } else { self.view.distance_mm(texel.position_mm) };
        let slant = texel.normal.dot(self.view.dir_at(texel.position_mm)).abs().max(MIN_SLANT);
        2.0 * self.view.half.y * spread / (self.size[1] as f32 * slant)
    }

    /// Whether a place on an object, found in another image, is seen here as well: the same surface, from the same side.
    pub fn shows(&self, there: &Seen, object: usize) -> bool {
        let Some(texel) = self.texel(there.position_mm, object) else { return false };
        let apart_mm = self.view.distance_mm(texel.position_mm) - self.view.distance_mm(there.position_mm);
        let uncertain_mm = self.uncertain_mm(texel) + there.uncertain_mm;
        texel.normal.dot(there.normal) > SAME_SIDE && apart_mm.abs() <= SAME_SURFACE_TEXELS * uncertain_mm
    }
}

fn seen_along(lit: Lit, from_mm: Vec3, dir: Vec3) -> Texel {
    let Some(hit) = lit.bvh.closest(from_mm, dir, f32::INFINITY) else { return EMPTY };
    let object = &lit.scene.objects[hit.object as usize];
    let point = object.surface_point(hit.triangle, hit.b1, hit.b2);
    let chart = object.charts.of_triangle[hit.triangle as usize];
    Texel {
        position_mm: point.position_mm,
        normal: plane_normal(&lit.settings.techniques.image_space, &point),
        irradiance_w_per_m2: irradiance_at(lit, hit.object as usize, &point, chart),
        object: hit.object,
    }
}

/// How far before the origin of a view nothing of the scene lies any more, mm.
fn before_all_mm(lit: Lit, view: &View) -> f32 {
    let bounds = lit.scene.bounds_mm();
    bounds.map_or(0.0, |[lo, hi]| lo.distance(hi) + (0.5 * (lo + hi)).distance(view.origin_mm))
}
