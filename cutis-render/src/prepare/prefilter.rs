//! The environment, filtered once: irradiance for every normal, and reflected radiance for every mirror direction and a
//! few roughnesses.
//!
//! Both are plain sums over the map on a coarse grid of directions, so nothing rings and nothing is negative, unlike a
//! fit with few spherical harmonics. The reflection uses the lobe seen from straight above (V = N = R), the usual
//! approximation of a prefiltered environment; its energy comes from the table of [`crate::prepare::RhoDt`].

use crate::specular_brdf::beckmann_per_sr;
use cutis_scene::{Environment, Texels, Texture};
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::f32::consts::{PI, TAU};

/// Directions at which the environment is summed.
const SOURCE: [u32; 2] = [96, 48];
/// Directions for which the filtered values are kept.
const TARGET: [u32; 2] = [64, 32];
/// Roughnesses of the kept reflections.
pub const ROUGHNESSES: [f32; 5] = [0.12, 0.2, 0.3, 0.45, 0.7];

/// A filtered environment.
#[derive(Debug, Clone)]
pub struct FilteredEnvironment {
    frame: Environment,
    irradiance: Texture,
    reflections: Vec<Texture>,
}

/// One direction of the coarse grid.
struct Ray {
    dir: Vec3,
    radiance: Vec3,
    solid_angle_sr: f32,
}

impl FilteredEnvironment {
    /// Filters an environment.
    pub fn new(environment: &Environment) -> Self {
        let rays = coarse_rays(environment);
        let irradiance = filter(environment, &rays, |cos| cos.max(0.0));
        let reflections = ROUGHNESSES.iter().map(|&m| normalised(environment, &rays, m)).collect();
        Self { frame: environment.clone(), irradiance, reflections }
    }

    /// The environment that was filtered; it knows where a direction falls on the maps.
    pub fn frame(&self) -> &Environment {
        &self.frame
    }

    /// Irradiance by the normal, W/m², in latitude-longitude layout.
    pub fn irradiance_map(&self) -> &Texture {
        &self.irradiance
    }

    /// Reflected radiance by the mirror direction, W/(m² sr), one map for each of [`ROUGHNESSES`].
    pub fn reflection_maps(&self) -> &[Texture] {
        &self.reflections
    }

    /// Irradiance on a surface with this normal that sees the whole environment, W/m².
    pub fn irradiance(&self, normal: Vec3) -> Vec3 {
        self.irradiance.sample_latlong(self.frame.uv(normal)).truncate()
    }

    /// Mean radiance over the specular lobe around a mirror direction.
    pub fn reflection(&self, dir: Vec3, roughness: f32) -> Vec3 {
        let uv = self.frame.uv(dir);
        let last = ROUGHNESSES.len() - 1;
        let upper = ROUGHNESSES.iter().position(|&m| m >= roughness).unwrap_or(last).max(1);
        let (lo, hi) = (ROUGHNESSES[upper - 1], ROUGHNESSES[upper]);
        let f = ((roughness - lo) / (hi - lo)).clamp(0.0, 1.0);
        let [a, b] = [upper - 1, upper].map(|i| self.reflections[i].sample_latlong(uv).truncate());
        a.lerp(b, f)
    }
}

/// The map averaged over the cells of the coarse grid.
fn coarse_rays(environment: &Environment) -> Vec<Ray> {
    let [columns, rows] = SOURCE;
    let per_cell_x = (environment.map.width() / columns).clamp(1, 16);
    let per_cell_y = (environment.map.height() / rows).clamp(1, 16);
    (0..columns * rows)
        .into_par_iter()
        .map(|i| {
            let cell = Vec2::new((i % columns) as f32, (i / columns) as f32);
            let size = Vec2::new(columns as f32, rows as f32);
            let mut radiance = Vec3::ZERO;
            for s in 0..per_cell_x * per_cell_y {
                let within = Vec2::new((s % per_cell_x) as f32 + 0.5, (s / per_cell_x) as f32 + 0.5);
                let uv = (cell + within / Vec2::new(per_cell_x as f32, per_cell_y as f32)) / size;
                radiance += environment.map.sample_latlong(uv).truncate();
            }
            let dir = environment.dir((cell + 0.5) / size);
            let [top, bottom] = [cell.y, cell.y + 1.0].map(|y| (y / size.y * PI).cos());
            let solid_angle_sr = (top - bottom) * TAU / size.x;
            let mean = radiance / (per_cell_x * per_cell_y) as f32;
            Ray { dir, radiance: mean * environment.radiance_scale, solid_angle_sr }
        })
        .collect()
}

/// Sums radiance times `lobe(cos)` for every kept direction.
fn filter(frame: &Environment, rays: &[Ray], lobe: impl Fn(f32) -> f32 + Sync) -> Texture {
    let texels = targets(frame)
        .map(|dir| {
            let sum: Vec3 =
                rays.iter().map(|ray| ray.radiance * (lobe(ray.dir.dot(dir)) * ray.solid_angle_sr)).sum();
            sum.extend(1.0).to_array()
        })
        .collect();
    Texture::new(TARGET[0], TARGET[1], Texels::LinearF32(texels))
}

/// The weighted mean over the lobe of roughness `m` around every kept direction.
fn normalised(frame: &Environment, rays: &[Ray], m: f32) -> Texture {
    let lobe = LobeTable::new(m);
    let texels = targets(frame)
        .map(|dir| {
            let (sum, weights) = rays.iter().fold((Vec3::ZERO, 0.0), |(sum, weights), ray| {
                let weight = lobe.at(ray.dir.dot(dir)) * ray.solid_angle_sr;
                (sum + ray.radiance * weight, weights + weight)
            });
            (sum / weights.max(f32::MIN_POSITIVE)).extend(1.0).to_array()
        })
        .collect();
    Texture::new(TARGET[0], TARGET[1], Texels::LinearF32(texels))
}

/// A lobe by its cosine: there are ten million values to be had for every roughness.
struct LobeTable(Vec<f32>);

impl LobeTable {
    /// Steps of the cosine from 0 to 1; the narrowest lobe has fallen by half after 41 of them.
    const STEPS: usize = 2048;

    fn new(m: f32) -> Self {
        Self((0..=Self::STEPS).map(|i| mirror_lobe(i as f32 / Self::STEPS as f32, m)).collect())
    }

    fn at(&self, cos: f32) -> f32 {
        let x = cos * Self::STEPS as f32;
        if x <= 0.0 {
            return 0.0;
        }
        let i = (x as usize).min(Self::STEPS - 1);
        self.0[i] + (self.0[i + 1] - self.0[i]) * (x - i as f32)
    }
}

/// Shape of the lobe with eye and normal along the mirror direction: D(H) cos_l / (V·H)², H halfway.
fn mirror_lobe(cos: f32, m: f32) -> f32 {
    if cos <= 0.0 {
        return 0.0;
    }
    let cos_half2 = 0.5 * (1.0 + cos);
    beckmann_per_sr(cos_half2.sqrt(), m) * cos / cos_half2
}

fn targets(frame: &Environment) -> impl IndexedParallelIterator<Item = Vec3> + '_ {
    let [columns, rows] = TARGET;
    (0..columns * rows).into_par_iter().map(move |i| {
        let cell = Vec2::new((i % columns) as f32 + 0.5, (i / columns) as f32 + 0.5);
        frame.dir(cell / Vec2::new(columns as f32, rows as f32))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    fn environment(radiance: impl Fn(Vec3) -> f32) -> Environment {
        let blank = |map: Texture| Environment {
            map: Arc::new(map),
            rotation_rad: 0.4,
            radiance_scale: Vec3::ONE,
            visible: false,
        };
        let (width, height) = (256, 128);
        let frame = blank(Texture::new(1, 1, Texels::LinearF32(vec![[0.0; 4]])));
        let texel = |i: u32| {
            let uv = Vec2::new((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
            [radiance(frame.dir(uv / Vec2::new(width as f32, height as f32))); 4]
        };
        blank(Texture::new(width, height, Texels::LinearF32((0..width * height).map(texel).collect())))
    }

    #[test]
    fn an_even_environment_gives_pi_and_itself() {
        let filtered = FilteredEnvironment::new(&environment(|_| 1.0));
        for dir in [Vec3::X, Vec3::Y, Vec3::NEG_Z, Vec3::new(0.6, -0.48, 0.64)] {
            // The midpoint rule on 96 × 48 cells integrates a cosine to about (pi/48)²/24 = 2e-4.
            assert!((filtered.irradiance(dir).x / PI - 1.0).abs() < 1e-3, "{dir}");
            assert!((filtered.reflection(dir, 0.27).x - 1.0).abs() < 1e-5, "{dir}");
        }
    }

    #[test]
    fn a_clamped_sky_gives_the_analytic_irradiance() {
        // Radiance 1 above the horizon, 0 below: E(n) = pi (1 + n·up) / 2.
        let filtered = FilteredEnvironment::new(&environment(|dir| if dir.y > 0.0 { 1.0 } else { 0.0 }));
        for height in [1.0f32, 0.5, 0.0, -0.5, -1.0] {
            let normal = Vec3::new((1.0 - height * height).sqrt(), height, 0.0);
            let expected = PI * 0.5 * (1.0 + height);
            // A row of the kept map is pi/32 high; at the poles its nearest centre lies half of that away.
            assert!((filtered.irradiance(normal).x - expected).abs() < 0.01, "{height}");
        }
    }
}
