//! Light that comes through thin parts into the light map, as a depth map tells it (Green 2004, GPU Gems, chapter 16: what
//! its section 16.4.1 leaves to the future, the depth map of section 16.3 and the blur of section 16.4 together).
//!
//! Symbols: s distance through the body towards a light; what comes through is e^(-s/deviation) of what the light map holds
//! where that light enters, so that shadows, relief and colour of the entry are in it. The blur that follows keeps features
//! of the back from showing through.
//! Not modelled: light of the environment has no direction; what of it lies on the lit side comes through with the lights,
//! by their shares.

use crate::passes::atlas::NO_CHART;
use crate::passes::transmission::Bodies;
use crate::passes::visibility::{light_facing_surface, scaled_mm};
use crate::progress::Progress;
use cutis_scene::SurfacePoint;
use glam::{Vec3, Vec4};
use rayon::prelude::*;

/// What came through object number `object`, W/m², at half the size of its light map; `deviation_mm` is how far its material
/// spreads light.
pub fn come_through(
    bodies: &Bodies,
    object: usize,
    deviation_mm: Vec3,
    progress: &dyn Progress,
) -> Vec<Vec4> {
    let maps = &bodies.maps[object];
    let charts = &maps.half_charts;
    progress.begin("transmission", charts.size as u64);
    let mut map: Vec<Vec4> = bytemuck::zeroed_vec(charts.chart.len());
    map.par_chunks_mut(charts.size).enumerate().for_each(|(y, row)| {
        for (x, texel) in row.iter_mut().enumerate() {
            let chart = charts.chart[y * charts.size + x];
            if chart == NO_CHART {
                continue;
            }
            if let Some(point) = maps.atlas.point_under(&bodies.scene.objects[object], chart, [x, y], 2) {
                *texel = from_all_lights(bodies, object, deviation_mm, &point).extend(0.0);
            }
        }
        progress.advance(1);
    });
    map
}

fn from_all_lights(bodies: &Bodies, object: usize, deviation_mm: Vec3, point: &SurfacePoint) -> Vec3 {
    let scale = bodies.scene.objects[object].material.thickness_scale;
    let from_light = |(l, light)| {
        let Some(there) = light_facing_surface(bodies.scene, bodies.bvh, point, light) else {
            return Vec3::ZERO;
        };
        let lit = &bodies.maps[there.object].diffused;
        let entered = lit.sample(0, 0, there.atlas_uv, there.chart).truncate() * bodies.share(l, &there);
        entered * left_after(scaled_mm(there.distance_mm, scale), deviation_mm)
    };
    bodies.scene.lights.iter().enumerate().map(from_light).sum()
}

/// e^(-s/deviation): what a distance leaves of the light of each channel. A body that spreads nothing lets nothing through.
pub fn left_after(s_mm: f32, deviation_mm: Vec3) -> Vec3 {
    if s_mm > 0.0 { (-s_mm / deviation_mm).exp() } else { Vec3::ONE }
}
