//! Where light comes from, as a path asks for it: a direction towards a light, or what lies in a direction.
//!
//! Lights with an extent are real here: spheres and discs of even radiance that give exactly the irradiance that
//! [`Light::sample`] states. They are not seen and throw no shadows.

mod environment_table;

use super::random::Random;
use cutis_scene::{Light, Projector, Scene};
use environment_table::EnvironmentTable;
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};
use std::ops::Range;

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
        Light::Point { position_mm, radius_mm, .. }
        | Light::Spot { position_mm, radius_mm, .. }
        | Light::Projector(Projector { position_mm, radius_mm, .. }) => {
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

#[cfg(test)]
mod tests;
