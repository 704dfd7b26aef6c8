//! Where light comes from, as a path asks for it: a direction towards a light, or what lies in a direction.
//!
//! Lights with an extent are real here: spheres and discs of even radiance that give exactly the irradiance that
//! [`Light::sample`] states. They are not seen and throw no shadows.

use super::random::Random;
use cutis_scene::{Environment, Light, Scene};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// Largest number of columns of the table that environments are drawn from.
const COLUMNS_MAX: usize = 512;
/// Share of the environment that is drawn evenly, so that nothing bright between two entries is found rarely.
const EVEN_SHARE: f64 = 0.05;

/// All lights of a scene.
pub struct Emitters<'a> {
    lights: &'a [Light],
    environment: Option<EnvironmentTable<'a>>,
}

/// A direction towards a light.
#[derive(Debug, Clone, Copy)]
pub struct Draw {
    /// Unit vector towards the light.
    pub dir: DVec3,
    /// Distance to it, mm; infinite where it is far away.
    pub distance_mm: f64,
    /// Radiance over the density, or irradiance over the probability of a light without extent: what a density of
    /// scattering towards it is multiplied with, W/m².
    pub light: DVec3,
    /// Density of the draw, 1/sr; none for a light without extent, which no direction meets by chance.
    pub density_per_sr: Option<f64>,
}

/// A light that a direction meets.
#[derive(Debug, Clone, Copy)]
pub struct Seen {
    /// Its radiance, W/(m² sr).
    pub radiance: DVec3,
    /// Its distance, mm.
    pub distance_mm: f64,
    /// Density with which [`Emitters::draw`] would have drawn the direction, 1/sr.
    pub density_per_sr: f64,
}

impl<'a> Emitters<'a> {
    /// The lights and the environment.
    pub fn new(scene: &'a Scene) -> Self {
        Self { lights: &scene.lights, environment: scene.environment.as_ref().map(EnvironmentTable::new) }
    }

    /// Whether some light has no extent, so that only a rough surface shows it.
    pub fn has_sharp_light(&self) -> bool {
        self.lights.iter().any(|light| !light.has_extent())
    }

    /// All lights.
    pub fn all(&self) -> Range<usize> {
        0..self.lights.len() + usize::from(self.environment.is_some())
    }

    /// Those with a place or a direction.
    pub fn lamps(&self) -> Range<usize> {
        0..self.lights.len()
    }

    /// The environment.
    pub fn surroundings(&self) -> Range<usize> {
        self.lights.len()..self.all().end
    }

    /// Draws one of some lights, the brighter at this point the likelier, and a direction towards it.
    pub fn draw(&self, some: Range<usize>, point_mm: DVec3, random: &mut Random) -> Option<Draw> {
        let (i, probability) = self.choose(some, point_mm, random)?;
        let draw = match (self.lights.get(i), &self.environment) {
            (Some(light), _) => draw_light(light, point_mm, random),
            (None, Some(environment)) => environment.draw(random),
            (None, None) => return None,
        };
        let density_per_sr = draw.density_per_sr.map(|density| density * probability);
        Some(Draw { light: draw.light / probability, density_per_sr, ..draw })
    }

    /// One of some lights, and the probability with which it is chosen.
    fn choose(&self, some: Range<usize>, point_mm: DVec3, random: &mut Random) -> Option<(usize, f64)> {
        if some.len() <= 1 {
            return some.map(|only| (only, 1.0)).next();
        }
        let total: f64 = some.clone().map(|i| self.brightness(i, point_mm)).sum();
        if total <= 0.0 {
            return None;
        }
        let mut left = random.unit() * total;
        let mut chosen = None;
        for i in some {
            let brightness = self.brightness(i, point_mm);
            if brightness > 0.0 {
                chosen = Some((i, brightness / total));
                left -= brightness;
                if left <= 0.0 {
                    break;
                }
            }
        }
        chosen
    }

    /// Those of some lights that have an extent and lie in a direction; the environment last.
    pub fn seen(&self, some: Range<usize>, point_mm: DVec3, dir: DVec3) -> impl Iterator<Item = Seen> + '_ {
        let is_alone = some.len() == 1;
        let total: f64 =
            if is_alone { 1.0 } else { some.clone().map(|i| self.brightness(i, point_mm)).sum::<f64>() };
        // Where nothing shines, nothing is drawn, and zero over zero is no share.
        let total = total.max(f64::MIN_POSITIVE);
        let surroundings = some.end > self.lights.len();
        let share = move |i| if is_alone { 1.0 } else { self.brightness(i, point_mm) / total };
        let lamps = some.start..some.end.min(self.lights.len());
        let lights = lamps.filter_map(move |i| {
            let seen = see_light(&self.lights[i], point_mm, dir)?;
            Some(Seen { density_per_sr: seen.density_per_sr * share(i), ..seen })
        });
        let environment = self.environment.iter().filter(move |_| surroundings).map(move |environment| {
            let seen = environment.see(dir);
            Seen { density_per_sr: seen.density_per_sr * share(self.lights.len()), ..seen }
        });
        lights.chain(environment)
    }

    /// Irradiance on a surface that faces the light, were nothing in between: its mean over the channels, W/m².
    fn brightness(&self, i: usize, point_mm: DVec3) -> f64 {
        match (self.lights.get(i), &self.environment) {
            (Some(light), _) => {
                light.sample(point_mm.as_vec3()).irradiance_w_per_m2.as_dvec3().element_sum() / 3.0
            }
            (None, Some(environment)) => environment.irradiance_w_per_m2,
            (None, None) => 0.0,
        }
    }
}

/// Cosine of the half angle under which a light is seen, its direction, distance and irradiance; cosine 1 without extent.
fn cone(light: &Light, point_mm: DVec3) -> (f64, DVec3, f64, DVec3) {
    let centre = light.sample(point_mm.as_vec3());
    let irradiance = centre.irradiance_w_per_m2.as_dvec3();
    match *light {
        Light::Directional { dir_to_light, angular_radius_rad, .. } => (
            f64::from(angular_radius_rad).cos(),
            dir_to_light.as_dvec3().normalize(),
            f64::INFINITY,
            irradiance,
        ),
        Light::Point { position_mm, radius_mm, .. } | Light::Spot { position_mm, radius_mm, .. } => {
            let to_light = position_mm.as_dvec3() - point_mm;
            let distance_mm = to_light.length().max(f64::MIN_POSITIVE);
            // From inside of the light there is no cone; a hair outside is as good.
            let sin = (f64::from(radius_mm) / distance_mm).min(0.999);
            ((1.0 - sin * sin).sqrt(), to_light / distance_mm, distance_mm, irradiance)
        }
    }
}

/// Solid angle of a cone, sr.
fn solid_angle_sr(cos: f64) -> f64 {
    TAU * (1.0 - cos)
}

/// Radiance that gives an irradiance from a cone around the normal: E = L pi sin².
fn even_radiance(irradiance: DVec3, cos: f64) -> DVec3 {
    irradiance / (PI * (1.0 - cos * cos))
}

fn draw_light(light: &Light, point_mm: DVec3, random: &mut Random) -> Draw {
    let (cos_edge, dir, distance_mm, irradiance) = cone(light, point_mm);
    if !light.has_extent() {
        return Draw { dir, distance_mm, light: irradiance, density_per_sr: None };
    }
    let cos = 1.0 - random.unit() * (1.0 - cos_edge);
    let aside = DVec2::from_angle(TAU * random.unit()) * (1.0 - cos * cos).max(0.0).sqrt();
    let (u, v) = dir.any_orthonormal_pair();
    let dir = (dir * cos + u * aside.x + v * aside.y).normalize();
    let density = solid_angle_sr(cos_edge).recip();
    let light = even_radiance(irradiance, cos_edge) / density;
    Draw { dir, distance_mm, light, density_per_sr: Some(density) }
}

fn see_light(light: &Light, point_mm: DVec3, dir: DVec3) -> Option<Seen> {
    let (cos_edge, towards, distance_mm, irradiance) = cone(light, point_mm);
    (light.has_extent() && dir.dot(towards) >= cos_edge).then(|| Seen {
        radiance: even_radiance(irradiance, cos_edge),
        distance_mm,
        density_per_sr: solid_angle_sr(cos_edge).recip(),
    })
}

/// A table to draw directions from as bright as the environment is there.
struct EnvironmentTable<'a> {
    environment: &'a Environment,
    columns: usize,
    rows: usize,
    /// Sums over the cells before each one, of brightness times solid angle; one more than there are cells.
    sums: Vec<f64>,
    /// Mean over channels of a quarter of what all directions together shine, as a surface on a ball gets it, W/m².
    irradiance_w_per_m2: f64,
}

impl<'a> EnvironmentTable<'a> {
    fn new(environment: &'a Environment) -> Self {
        let (width, height) = (environment.map.width() as usize, environment.map.height() as usize);
        let columns = width.min(COLUMNS_MAX);
        let rows = (height * columns / width).max(1);
        let cell = |i: usize| {
            let (x, y) = (i % columns, i / columns);
            let mut brightest = 0.0f64;
            // At corners, sides and middle: what lies between is interpolated from texels at least so close.
            let steps = (width / columns).max(1) + 1;
            for (a, b) in (0..=steps).flat_map(|a| (0..=steps).map(move |b| (a, b))) {
                let place = |at: usize, step: usize, count: usize| {
                    (at as f32 + step as f32 / steps as f32) / count as f32
                };
                let uv = glam::Vec2::new(place(x, a, columns), place(y, b, rows));
                let radiance = environment.radiance(environment.dir(uv));
                brightest += f64::from(radiance.element_sum()) / 3.0;
            }
            brightest / ((steps + 1) * (steps + 1)) as f64
        };
        let mut weights: Vec<f64> = (0..columns * rows).map(cell).collect();
        for (i, weight) in weights.iter_mut().enumerate() {
            *weight = weight.max(0.0) * cell_sr(i / columns, rows, columns);
        }
        let whole: f64 = weights.iter().sum();
        let mut sum = 0.0;
        let mut sums = vec![0.0];
        for (i, weight) in weights.iter().enumerate() {
            // A black one is drawn evenly.
            let even = cell_sr(i / columns, rows, columns) / (4.0 * PI) * whole.max(1e-30);
            sum += (1.0 - EVEN_SHARE) * weight + EVEN_SHARE * even;
            sums.push(sum);
        }
        Self { environment, columns, rows, sums, irradiance_w_per_m2: whole / 4.0 }
    }

    fn draw(&self, random: &mut Random) -> Draw {
        let wanted = random.unit() * self.sums[self.columns * self.rows];
        let i = self.sums.partition_point(|&sum| sum <= wanted).clamp(1, self.columns * self.rows) - 1;
        let column = (i % self.columns) as f64 + random.unit();
        let [top, bottom] = cosines(i / self.columns, self.rows);
        let y = top + (bottom - top) * random.unit();
        let v = y.acos() / PI;
        let uv = DVec2::new(column / self.columns as f64, v).as_vec2();
        let dir = self.environment.dir(uv).as_dvec3().normalize();
        let seen = self.see(dir);
        Draw {
            dir,
            distance_mm: f64::INFINITY,
            light: seen.radiance / seen.density_per_sr,
            density_per_sr: Some(seen.density_per_sr),
        }
    }

    fn see(&self, dir: DVec3) -> Seen {
        let uv = self.environment.uv(dir.as_vec3());
        let place = |share: f32, count: usize| ((share * count as f32) as usize).min(count - 1);
        let row = place(uv.y, self.rows);
        let i = row * self.columns + place(uv.x, self.columns);
        let probability = (self.sums[i + 1] - self.sums[i]) / self.sums[self.columns * self.rows];
        Seen {
            radiance: self.environment.radiance(dir.as_vec3()).as_dvec3(),
            distance_mm: f64::INFINITY,
            density_per_sr: probability / cell_sr(row, self.rows, self.columns),
        }
    }
}

/// Cosines of the polar angles between which a row lies.
fn cosines(row: usize, rows: usize) -> [f64; 2] {
    [row, row + 1].map(|r| (PI * r as f64 / rows as f64).cos())
}

/// Solid angle of a cell of the table, sr.
fn cell_sr(row: usize, rows: usize, columns: usize) -> f64 {
    let [top, bottom] = cosines(row, rows);
    TAU * (top - bottom) / columns as f64
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::transport::tests::scene_of;
    use cutis_scene::{Texels, Texture};
    use glam::{Vec3, Vec4};
    use std::sync::Arc;

    /// Irradiance on a surface facing +y, from draws and from directions that happen to meet lights.
    fn irradiance(scene: &Scene, draws: u32) -> [DVec3; 2] {
        let emitters = Emitters::new(scene);
        let mut random = Random::new(4, 0, 0);
        let (mut drawn, mut met) = (DVec3::ZERO, DVec3::ZERO);
        for _ in 0..draws {
            let draw = emitters.draw(emitters.all(), DVec3::ZERO, &mut random).unwrap();
            drawn += draw.light * draw.dir.y.max(0.0);
            let d = random.cosine_hemisphere();
            let dir = DVec3::new(d.x, d.z, d.y);
            met +=
                emitters.seen(emitters.all(), DVec3::ZERO, dir).map(|seen| seen.radiance * PI).sum::<DVec3>();
        }
        [drawn / f64::from(draws), met / f64::from(draws)]
    }

    #[test]
    fn a_sphere_gives_the_irradiance_it_states() {
        let light = Light::Point {
            position_mm: Vec3::new(0.0, 100.0, 0.0),
            intensity_w_per_sr: Vec3::new(1.0, 2.0, 0.5) * 0.01,
            radius_mm: 60.0,
        };
        let scene = scene_of(vec![], vec![light], None);
        for found in irradiance(&scene, 40_000) {
            // sin² of 0.36 of all directions meet it: standard error 0.67 %; drawn ones vary less.
            assert!((found / DVec3::new(1.0, 2.0, 0.5) - 1.0).abs().max_element() < 0.03, "{found}");
        }
    }

    #[test]
    fn an_environment_is_drawn_as_bright_as_it_is() {
        let texel = |i: usize| {
            let (x, y) = (i % 16, i / 16);
            let bright = if x == 5 && y == 1 { 40.0 } else { 1.0 + (x + 2 * y) as f32 * 0.05 };
            [bright, 0.5 * bright, 1.0, 1.0]
        };
        let map = Arc::new(Texture::new(16, 8, Texels::LinearF32((0..128).map(texel).collect())));
        let environment =
            Environment { map, rotation_rad: 0.4, radiance_scale: Vec3::splat(0.7), visible: false };
        let scene = scene_of(vec![], vec![], Some(environment.clone()));
        // By quadrature over the upper hemisphere.
        let (rings, sectors) = (400, 1600);
        let mut expected = Vec4::ZERO.truncate().as_dvec3();
        for (i, j) in (0..rings).flat_map(|i| (0..sectors).map(move |j| (i, j))) {
            let (theta, turn) = (0.5 * PI * (i as f64 + 0.5) / rings as f64, TAU * j as f64 / sectors as f64);
            let dir = DVec3::new(theta.sin() * turn.cos(), theta.cos(), theta.sin() * turn.sin());
            let angle = theta.sin() * theta.cos() * 0.5 * PI / rings as f64 * TAU / sectors as f64;
            expected += environment.radiance(dir.as_vec3()).as_dvec3() * angle;
        }
        for found in irradiance(&scene, 40_000) {
            // Directions by chance vary by 2.6 of the mean for the bright texel: 1.3 %; drawn ones by 0.5 %. Four of them.
            assert!((found / expected - 1.0).abs().max_element() < 0.05, "{found} {expected}");
        }
    }

    #[test]
    fn the_density_told_is_that_of_the_draws() {
        // Mean of 1/density over the draws is the solid angle they come from, if density is what it says.
        let map =
            Arc::new(Texture::new(2, 2, Texels::LinearF32(vec![[1.0; 4], [5.0; 4], [2.0; 4], [0.0; 4]])));
        let environment = Environment { map, rotation_rad: 0.0, radiance_scale: Vec3::ONE, visible: false };
        let scene = scene_of(vec![], vec![], Some(environment));
        let emitters = Emitters::new(&scene);
        let mut random = Random::new(4, 0, 0);
        let n = 20_000;
        let mean: f64 = (0..n)
            .map(|_| {
                emitters
                    .draw(emitters.all(), DVec3::ZERO, &mut random)
                    .unwrap()
                    .density_per_sr
                    .unwrap()
                    .recip()
            })
            .sum::<f64>()
            / f64::from(n);
        // Densities vary by a factor of some ten: standard error below 2 %.
        assert!((mean / (4.0 * PI) - 1.0).abs() < 0.08, "{mean}");
    }
}
