//! What of a scene is seen from afar, from directions all around: how open its surfaces are follows from that.

use super::lights::GpuLight;
use super::object::ObjectMaps;
use crate::Gpu;
use crate::map::Map;
use crate::passes::Passes;
use crate::passes::openness::{FORMAT, OpennessPass};
use crate::passes::shadow::Drawn;
use crate::step::Step;
use bytemuck::Zeroable;
use cutis_render::prepare::light_view::bounds_mm;
use cutis_scene::Light;
use glam::Vec3;

/// Directions for every ray that the processor casts from a texel: there, 16 neighbours share their rays.
const DIRECTIONS_PER_RAY: u32 = 8;
/// Fewest and most directions.
const DIRECTIONS: [u32; 2] = [16, 128];
/// Side of a map, texels.
const MAP_TEXELS: u32 = 256;

/// Directions, and what is seen from them.
#[derive(Debug)]
pub struct Surroundings {
    /// [`GpuLight`] of every direction.
    directions: wgpu::Buffer,
    count: u32,
    depths: Map,
}

impl Surroundings {
    /// Directions that see all of some points, for as good a result as so many rays from a texel give.
    pub fn new(gpu: &Gpu, samples: u32, shown: &[Vec3]) -> Self {
        let [fewest, most] = DIRECTIONS;
        let count = samples.saturating_mul(DIRECTIONS_PER_RAY).clamp(fewest, most);
        Self {
            directions: gpu.storage("directions", &lights(count, shown)),
            count,
            depths: OpennessPass::maps(gpu, MAP_TEXELS, count),
        }
    }

    /// Takes in other points from now on.
    pub fn show(&self, gpu: &Gpu, shown: &[Vec3]) {
        gpu.queue.write_buffer(&self.directions, 0, bytemuck::cast_slice(&lights(self.count, shown)));
    }

    /// The steps that find out how open all objects are.
    pub fn steps(&self, gpu: &Gpu, passes: &Passes, objects: &[ObjectMaps]) -> Vec<Step> {
        let pass = &passes.openness;
        let mut steps = Vec::new();
        for (light, depth) in (0..).zip(&self.depths.layers) {
            for (object, maps) in (0..).zip(objects) {
                let drawn = Drawn { light, object, ..Drawn::zeroed() };
                steps.push(pass.look(gpu, drawn, &self.directions, &maps.geometry, depth));
            }
        }
        let seen = (&self.directions, &self.depths);
        for ObjectMaps { atlas, charts, ambient, .. } in objects {
            let sharp = Map::square(gpu, "sharp openness", ambient.width(), 1, FORMAT);
            steps.push(pass.look_around(gpu, seen, (atlas, charts), &sharp));
            steps.push(pass.smooth(gpu, charts, [&sharp, ambient]));
        }
        steps
    }
}

/// Directions of a spherical Fibonacci lattice (Swinbank & Purser 2006), each with a map over some points.
fn lights(count: u32, shown: &[Vec3]) -> Vec<GpuLight> {
    let corners = bounds_mm(shown.iter().copied()).unwrap_or_default();
    let corner = |i: usize| Vec3::from_array([0, 1, 2].map(|axis| corners[i >> axis & 1][axis]));
    let corners: Vec<_> = (0..8).map(corner).collect();
    let golden_angle_rad = std::f32::consts::PI * (3.0 - 5f32.sqrt());
    let light = |i: u32| {
        let y = 1.0 - (2.0 * i as f32 + 1.0) / count as f32;
        let aside = (1.0 - y * y).sqrt();
        let angle_rad = golden_angle_rad * i as f32;
        let dir_to_light = Vec3::new(aside * angle_rad.cos(), y, aside * angle_rad.sin());
        let far =
            Light::Directional { dir_to_light, irradiance_w_per_m2: Vec3::ZERO, angular_radius_rad: 0.0 };
        GpuLight::over_points(&far, corners.iter().copied(), Some(i))
    };
    (0..count).map(light).collect()
}
