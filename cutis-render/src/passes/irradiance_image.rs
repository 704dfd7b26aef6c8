//! The irradiance as an image: what a camera sees of it, with the place and the normal of what is seen
//! (Mertens et al. 2003, section 5).

use crate::lit_scene::Lit;
use crate::passes::irradiance::irradiance_at;
use crate::progress::Progress;
use cutis_scene::{Camera, CameraRays};
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// In place of an object: nothing is seen.
const NOTHING: u32 = u32::MAX;
/// Cosine between the view and a surface below which a texel's plane is not followed beyond its middle.
const GRAZING: f32 = 0.1;

/// One texel.
#[derive(Debug, Clone, Copy)]
struct Texel {
    position_mm: Vec3,
    normal: Vec3,
    irradiance_w_per_m2: Vec3,
    object: u32,
}

/// The image.
pub struct IrradianceImage {
    eye_mm: Vec3,
    rays: CameraRays,
    size: [usize; 2],
    texels: Vec<Texel>,
}

/// What the image shows in the place of a point.
pub struct Seen {
    /// Place on the body, mm.
    pub position_mm: Vec3,
    /// Irradiance under its surface, W/m².
    pub irradiance_w_per_m2: Vec3,
    normal: Vec3,
    /// Unit vector along the view.
    dir: Vec3,
    /// Distance from the eye to the body over that to the point.
    distance_ratio: f32,
}

impl Seen {
    /// Area on the body over the area on a plane through the point: both fill the same solid angle.
    pub fn jacobian(&self, plane_normal: Vec3) -> f32 {
        let cos = self.normal.dot(self.dir).abs().max(1e-3);
        self.distance_ratio * self.distance_ratio * plane_normal.dot(self.dir).abs() / cos
    }
}

impl IrradianceImage {
    /// What a camera sees of a scene.
    pub fn seen_by_camera(lit: Lit, camera: &Camera, progress: &dyn Progress) -> Self {
        let grid = (lit.settings.samples_per_pixel as f32).sqrt().ceil() as usize;
        let size = [lit.settings.width as usize * grid, lit.settings.height as usize * grid];
        let rays = camera.rays(size[0] as f32 / size[1] as f32);
        let texel = |i: usize| {
            let place = Vec2::new((i % size[0]) as f32 + 0.5, (i / size[0]) as f32 + 0.5)
                / Vec2::new(size[0] as f32, size[1] as f32);
            let dir = rays.dir_through(Vec2::new(2.0 * place.x - 1.0, 1.0 - 2.0 * place.y));
            seen_along(lit, camera.position_mm, dir)
        };
        progress.begin("irradiance image", size[1] as u64);
        let row = |y: usize| {
            progress.advance(1);
            let wanted = progress.goes_on();
            (0..size[0]).map(|x| if wanted { texel(y * size[0] + x) } else { EMPTY }).collect::<Vec<_>>()
        };
        let texels = (0..size[1]).into_par_iter().flat_map_iter(row).collect();
        Self { eye_mm: camera.position_mm, rays, size, texels }
    }

    /// What of an object is seen in the place of a point.
    pub fn through(&self, point_mm: Vec3, object: usize) -> Option<Seen> {
        let ndc = self.rays.ndc_of(point_mm - self.eye_mm)?;
        let place = Vec2::new(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y)
            * Vec2::new(self.size[0] as f32, self.size[1] as f32);
        if place.min_element() < 0.0 || place.x >= self.size[0] as f32 || place.y >= self.size[1] as f32 {
            return None;
        }
        let texel = &self.texels[place.y as usize * self.size[0] + place.x as usize];
        if texel.object != object as u32 {
            return None;
        }
        let to_point = point_mm - self.eye_mm;
        let distance_mm = to_point.length();
        let dir = to_point / distance_mm;
        let cos = texel.normal.dot(dir);
        // The texel's own plane, where the view meets it: its middle lies a little aside.
        let there_mm = if cos.abs() < GRAZING {
            texel.position_mm.distance(self.eye_mm)
        } else {
            texel.normal.dot(texel.position_mm - self.eye_mm) / cos
        };
        Some(Seen {
            position_mm: self.eye_mm + dir * there_mm,
            irradiance_w_per_m2: texel.irradiance_w_per_m2,
            normal: texel.normal,
            dir,
            distance_ratio: there_mm / distance_mm,
        })
    }
}

/// A texel that shows nothing.
const EMPTY: Texel =
    Texel { position_mm: Vec3::ZERO, normal: Vec3::Z, irradiance_w_per_m2: Vec3::ZERO, object: NOTHING };

fn seen_along(lit: Lit, eye_mm: Vec3, dir: Vec3) -> Texel {
    let Some(hit) = lit.bvh.closest(eye_mm, dir, f32::INFINITY) else { return EMPTY };
    let object = &lit.scene.objects[hit.object as usize];
    let point = object.surface_point(hit.triangle, hit.b1, hit.b2);
    let chart = object.charts.of_triangle[hit.triangle as usize];
    Texel {
        position_mm: point.position_mm,
        normal: point.flat_normal,
        irradiance_w_per_m2: irradiance_at(lit, hit.object as usize, &point, chart),
        object: hit.object,
    }
}
