//! What each light sees and how far it is through the body, at half the size of the irradiance.
//!
//! Rays are what the irradiance pass spends its time on, and most of them only say what those next to them have said.
//! Distances are blurred anyway. Shadows are not: where four neighbours disagree, or one of them lies in a half shadow,
//! the irradiance pass casts its own rays.

use crate::passes::atlas::{Atlas, ChartMap};
use crate::passes::visibility::{faces, light_facing_surface, scaled_mm, visible_fraction};
use crate::progress::Progress;
use crate::sampling::random2;
use crate::settings::Settings;
use cutis_scene::{Bvh, Light, Object, Scene, SurfacePoint};
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Streams of random numbers this pass draws from: one per light from here on.
const STREAM: u32 = 0x200;
/// In place of a visibility: the surface faces away. Neither lit nor in shadow, so that neighbours never agree with it.
const FACES_AWAY: f32 = -1.0;

/// What casting a ray needs to know.
#[derive(Clone, Copy)]
pub struct Rays<'a> {
    /// The whole scene.
    pub scene: &'a Scene,
    /// Rays against it.
    pub bvh: &'a Bvh,
    /// How to draw.
    pub settings: &'a Settings,
    /// Distance beyond which nothing comes through, mm.
    pub opaque_mm: f32,
    /// Factor on distances through the body.
    pub thickness_scale: f32,
}

impl Rays<'_> {
    /// Fraction of a light that a place sees; `None` where the smooth surface faces away from it.
    pub fn visible(&self, light: &Light, point: &SurfacePoint, shift: Vec2) -> Option<f32> {
        let towards = light.sample(point.position_mm);
        if point.normal.dot(towards.dir_to_light) <= 0.0 {
            return None;
        }
        if towards.irradiance_w_per_m2 == Vec3::ZERO {
            return Some(0.0);
        }
        Some(visible_fraction(self.bvh, point, light, self.settings.shadow_samples, shift))
    }

    /// Distance d through the body towards a light, scaled, mm; 0 on the lit side, and never more than what is opaque anyway.
    pub fn distance_mm(&self, light: &Light, point: &SurfacePoint) -> f32 {
        if self.opaque_mm <= 0.0 || faces(point, light) {
            return 0.0;
        }
        let there = light_facing_surface(self.scene, self.bvh, point, light);
        let d_mm = there.map(|there| scaled_mm(there.corrected_mm, self.thickness_scale));
        d_mm.map_or(self.opaque_mm, |d_mm| d_mm.min(self.opaque_mm))
    }
}

/// One object's surface as its lights see it.
pub struct HalfSize<'a> {
    charts: &'a ChartMap,
    lights: Vec<Seen>,
}

/// One light's map: in x the fraction of the light that is seen, in y the distance through the body, mm.
type Seen = Vec<Vec2>;

impl<'a> HalfSize<'a> {
    /// Casts the rays of every texel of `charts`, the halved map of the atlas.
    pub fn new(
        rays: Rays,
        object: &Object,
        atlas: &Atlas,
        charts: &'a ChartMap,
        progress: &dyn Progress,
    ) -> Self {
        progress.begin("shadows", (rays.scene.lights.len() * charts.size) as u64);
        let lights = rays.scene.lights.iter().enumerate().map(|(l, light)| {
            let mut seen = vec![Vec2::new(FACES_AWAY, 0.0); charts.chart.len()];
            seen.par_chunks_mut(charts.size).enumerate().for_each(|(y, row)| {
                for (x, texel) in row.iter_mut().enumerate() {
                    let chart = charts.chart[y * charts.size + x];
                    let Some(point) = atlas.point_under(object, chart, [x, y], 2) else { continue };
                    let shift = random2(x as u32, y as u32, STREAM + l as u32, rays.settings.seed);
                    let visible = rays.visible(light, &point, shift).unwrap_or(FACES_AWAY);
                    *texel = Vec2::new(visible, rays.distance_mm(light, &point));
                }
                progress.advance(1);
            });
            seen
        });
        Self { charts, lights: lights.collect() }
    }

    /// Whether the place is lit (1) or in shadow (0), if the texels around it agree: four where shadows are sharp; sixteen
    /// for a light with extent, a few of whose rays may all miss what hides a little of it.
    pub fn visible(&self, l: usize, uv: Vec2, chart: u32, has_extent: bool) -> Option<f32> {
        let [(first, _), .., (last, _)] = self.charts.around(uv);
        let size = self.charts.size;
        let margin = usize::from(has_extent);
        let columns = (first % size).saturating_sub(margin)..(last % size + margin + 1).min(size);
        let mut rows = (first / size).saturating_sub(margin)..(last / size + margin + 1).min(size);
        let answer = self.lights[l][first].x;
        let agree = |t: usize| self.charts.chart[t] == chart && self.lights[l][t].x == answer;
        let all =
            (answer == 0.0 || answer == 1.0) && rows.all(|y| columns.clone().all(|x| agree(y * size + x)));
        all.then_some(answer)
    }

    /// Distance through the body, mm: the mean of those texels around the place that face away as well. `None` if there
    /// are none in its chart.
    pub fn distance_mm(&self, l: usize, uv: Vec2, chart: u32) -> Option<f32> {
        let (mut sum, mut weight) = (0.0, 0.0);
        for (texel, w) in self.charts.around(uv) {
            let seen = self.lights[l][texel];
            if self.charts.chart[texel] == chart && seen.x == FACES_AWAY {
                sum += seen.y * w;
                weight += w;
            }
        }
        // Below a thousandth the quotient would only magnify rounding.
        (weight > 1e-3).then(|| sum / weight)
    }
}
