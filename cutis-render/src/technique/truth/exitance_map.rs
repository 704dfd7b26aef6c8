//! Radiant exitance per texel: what leaves the skin, after having been inside, before any eye looks.

use crate::frame::Layer;
use crate::passes::atlas::{Atlas, TexelSurface};
use crate::progress::Progress;
use crate::settings::{Aov, Settings};
use crate::transport::estimate::Estimate;
use crate::transport::exitance::{Entrances, of_place};
use crate::transport::path::Transport;
use crate::transport::random::Random;
use cutis_scene::Object;
use cutis_scene::solids::Meeting;
use glam::{DVec3, Vec2};
use rayon::prelude::*;

/// Width and height of the map that decides where to start, and samples per texel of it.
const PILOT_SIZE: usize = 64;
const PILOT_SAMPLES: u64 = 24;
/// Parts of a texel's side as which triangles are cut to measure how much surface a texel holds.
const PARTS: f32 = 4.0;
/// Work between two looks at the noise, in samples.
const STEP: u64 = 4;
/// Least weight of a corner where paths start.
const OFF_EDGE: f64 = 1e-3;
/// Samples before the noise is believed.
const SAMPLES_MIN: u64 = 16;

/// Where estimates begin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Start {
    /// Packets at the lights: good where few places shine. A texel has the mean over its surface.
    Light,
    /// Paths at the texels: good where light comes from everywhere, and for the dark side. A texel has what leaves its middle, or
    /// the place next to it that lies on the surface.
    Texel,
}

/// Exitance of the first object's surface, texel by texel.
pub struct ExitanceMap {
    /// Width and height, texels.
    pub size: usize,
    /// Where the estimates began.
    pub start: Start,
    /// Exitance, W/m²; 0 where there is no surface.
    pub exitance_w_per_m2: Vec<DVec3>,
    /// Its standard error, W/m².
    pub standard_error_w_per_m2: Vec<DVec3>,
    /// Samples per texel.
    pub samples: u64,
}

/// One way to start, on its way.
trait Estimator {
    /// Adds samples `first` to `first + count - 1` per texel; returns how many random numbers they took.
    fn add(&mut self, first: u64, count: u64) -> u64;
    /// Exitance and its standard error at a texel, W/m².
    fn texel(&self, texel: usize) -> (DVec3, DVec3);
}

impl ExitanceMap {
    /// Estimates the map from where that is quicker, until there are enough samples or the median noise is low enough.
    pub fn new(transport: &Transport, settings: &Settings, progress: &dyn Progress) -> Self {
        let start = quicker(transport, settings);
        tracing::info!("exitance starts at each {start:?}");
        Self::starting(start, transport, settings, progress)
    }

    /// The same from a given start.
    pub fn starting(
        start: Start,
        transport: &Transport,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Self {
        let size = settings.irradiance_size as usize;
        let atlas = Atlas::new(&transport.scene.objects[0], size);
        let mut estimator: Box<dyn Estimator + '_> = match start {
            Start::Light => Box::new(FromLights::new(transport, size, settings.seed)),
            Start::Texel => Box::new(FromTexels::new(transport, &atlas, settings.seed)),
        };
        let wanted = u64::from(settings.samples_per_pixel);
        let mut samples = 0;
        progress.begin("exitance", wanted);
        while samples < wanted {
            let count = STEP.min(wanted - samples);
            estimator.add(samples, count);
            samples += count;
            progress.advance(count);
            let noise = median_noise((0..size * size).map(|texel| estimator.texel(texel)));
            progress.note(&format!("exitance, noise {:.2} %", 100.0 * noise));
            if samples >= SAMPLES_MIN && settings.target_error.is_some_and(|target| noise <= target) {
                break;
            }
        }
        let (exitance_w_per_m2, standard_error_w_per_m2) =
            (0..size * size).map(|texel| estimator.texel(texel)).unzip();
        Self { size, start, exitance_w_per_m2, standard_error_w_per_m2, samples }
    }

    /// Median over the texels of the standard error over the exitance.
    pub fn noise(&self) -> f64 {
        let texels = self.exitance_w_per_m2.iter().copied().zip(self.standard_error_w_per_m2.iter().copied());
        median_noise(texels)
    }

    /// The map as a layer.
    pub fn layer(&self, aov: Aov) -> Option<Layer> {
        let values = match aov {
            Aov::Exitance => &self.exitance_w_per_m2,
            Aov::StandardError => &self.standard_error_w_per_m2,
            _ => return None,
        };
        let side = self.size as u32;
        let pixels = values.iter().map(|v| v.as_vec3().extend(1.0)).collect();
        Some(Layer { name: aov.to_string(), width: side, height: side, channels: aov.channels(), pixels })
    }
}

/// Median of error over mean, channels summed, over what has been seen to shine: what no packet has left yet does not count.
fn median_noise(texels: impl Iterator<Item = (DVec3, DVec3)>) -> f64 {
    let relative = |(mean, error): (DVec3, DVec3)| {
        let sum = mean.element_sum();
        (sum > 0.0).then(|| error.element_sum() / sum)
    };
    let mut noise: Vec<f64> = texels.filter_map(relative).filter(|n| n.is_finite()).collect();
    let middle = noise.len() / 2;
    if noise.is_empty() { f64::INFINITY } else { *noise.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// The start with less variance for the same work, by a short run of each on a small map: squared noise times the random
/// numbers that were drawn, which any machine counts alike. With more texels both grow alike: packets are shared by more, and
/// paths are wanted for more.
fn quicker(transport: &Transport, settings: &Settings) -> Start {
    let atlas = Atlas::new(&transport.scene.objects[0], PILOT_SIZE);
    let cost = |estimator: &mut dyn Estimator| {
        let drawn = estimator.add(0, PILOT_SAMPLES) as f64;
        let noise = median_noise((0..PILOT_SIZE * PILOT_SIZE).map(|texel| estimator.texel(texel)));
        noise * noise * drawn
    };
    let light = cost(&mut FromLights::new(transport, PILOT_SIZE, settings.seed));
    let texel = cost(&mut FromTexels::new(transport, &atlas, settings.seed));
    tracing::debug!("squared noise times numbers drawn: {light:.2e} from lights, {texel:.2e} from texels");
    if light < texel { Start::Light } else { Start::Texel }
}

/// Packets from the lights, counted where they leave.
struct FromLights<'a, 'b> {
    entrances: Entrances<'a, 'b>,
    size: usize,
    seed: u64,
    /// Surface that each texel holds, mm².
    areas_mm2: Vec<f64>,
    /// Whether a triangle has texels: caps, whose texture is one point, have none.
    has_texels: Vec<bool>,
    sums: Vec<DVec3>,
    squares: Vec<DVec3>,
    packets: u64,
}

impl<'a, 'b> FromLights<'a, 'b> {
    fn new(transport: &'b Transport<'a>, size: usize, seed: u64) -> Self {
        let object = &transport.scene.objects[0];
        let triangles = 0..object.mesh.triangles.len();
        let nothing = vec![DVec3::ZERO; size * size];
        Self {
            entrances: Entrances::new(transport),
            size,
            seed,
            areas_mm2: areas_mm2(object, size),
            has_texels: triangles.map(|triangle| has_texels(object, triangle)).collect(),
            sums: nothing.clone(),
            squares: nothing,
            packets: 0,
        }
    }
}

impl Estimator for FromLights<'_, '_> {
    fn add(&mut self, first: u64, count: u64) -> u64 {
        let Self { entrances, size, seed, has_texels, sums, squares, .. } = self;
        let per_sample = (*size * *size) as u64;
        self.packets += count * per_sample;
        entrances.walk(*seed, first * per_sample, count * per_sample, |exit| {
            if exit.object == 0 && has_texels[exit.triangle as usize] {
                let texel = texel_of(exit.uv, *size);
                sums[texel] += exit.flux;
                squares[texel] += exit.flux * exit.flux;
            }
        })
    }

    fn texel(&self, texel: usize) -> (DVec3, DVec3) {
        let per = self.packets as f64 * self.areas_mm2[texel];
        if per <= 0.0 {
            return (DVec3::ZERO, DVec3::ZERO);
        }
        // Exits are rare and independent: the variance of their sum is the sum of their squares.
        (self.sums[texel] / per, self.squares[texel].map(f64::sqrt) / per)
    }
}

/// Paths from the middle of each texel.
struct FromTexels<'a, 'b> {
    transport: &'b Transport<'a>,
    places: Vec<Option<(Meeting, DVec3)>>,
    estimates: Vec<Estimate>,
    seed: u64,
}

impl<'a, 'b> FromTexels<'a, 'b> {
    fn new(transport: &'b Transport<'a>, atlas: &Atlas, seed: u64) -> Self {
        let place = |surface: &TexelSurface| {
            let weights = onto_triangle([f64::from(surface.b1), f64::from(surface.b2)]);
            transport.solids.place_on(0, surface.triangle, weights)
        };
        let places: Vec<_> = atlas.surface.iter().map(place).collect();
        Self { transport, estimates: vec![Estimate::default(); places.len()], places, seed }
    }
}

impl Estimator for FromTexels<'_, '_> {
    fn add(&mut self, first: u64, count: u64) -> u64 {
        let Self { transport, places, estimates, seed } = self;
        let texels = estimates.par_iter_mut().with_min_len(16).zip(places).enumerate();
        let add_to = |(texel, (estimate, place)): (usize, (&mut Estimate, &mut Option<(Meeting, DVec3)>))| {
            let Some((meeting, place_mm)) = place else { return 0 };
            let one = |sample| {
                let mut random = Random::new(*seed, texel as u64, sample);
                let begin = random.clone();
                estimate.add(of_place(transport, *meeting, *place_mm, &mut random));
                random.drawn_since(&begin)
            };
            (first..first + count).map(one).sum()
        };
        texels.map(add_to).sum()
    }

    fn texel(&self, texel: usize) -> (DVec3, DVec3) {
        match self.places[texel] {
            Some(_) => (self.estimates[texel].mean(), self.estimates[texel].standard_error()),
            None => (DVec3::ZERO, DVec3::ZERO),
        }
    }
}

/// The nearest weights within the triangle, a hair away from its edges: a texel at the border of a chart may have its middle
/// beside the surface, and a path that starts on an edge may miss the triangle beyond it.
fn onto_triangle([b1, b2]: [f64; 2]) -> [f64; 2] {
    let weights = [1.0 - b1 - b2, b1, b2].map(|weight| weight.max(OFF_EDGE));
    let sum: f64 = weights.iter().sum();
    [weights[1] / sum, weights[2] / sum]
}

fn has_texels(object: &Object, triangle: usize) -> bool {
    let [a, b, c] = object.mesh.corner_uvs(triangle);
    (b - a).perp_dot(c - a) != 0.0
}

/// Area of the surface in each texel, mm²: triangles are cut into parts smaller than a texel.
fn areas_mm2(object: &Object, size: usize) -> Vec<f64> {
    let mut areas = vec![0.0; size * size];
    for triangle in (0..object.mesh.triangles.len()).filter(|&triangle| has_texels(object, triangle)) {
        let [a, b, c] = object.mesh.corner_uvs(triangle);
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        let parts = ((longest * size as f32 * PARTS).ceil() as usize).clamp(1, 4 * size);
        let share = f64::from(object.mesh.area_mm2(triangle)) / (parts * parts) as f64;
        for i in 0..parts {
            // Along the side: small triangles that stand up, and between them those upside down.
            for j in 0..parts - i {
                let at = |third: f32| {
                    (a * (parts as f32 - (i + j) as f32 - 2.0 * third)
                        + b * (i as f32 + third)
                        + c * (j as f32 + third))
                        / parts as f32
                };
                areas[texel_of(at(1.0 / 3.0), size)] += share;
                if i + j + 1 < parts {
                    areas[texel_of(at(2.0 / 3.0), size)] += share;
                }
            }
        }
    }
    areas
}

/// The texel at texture coordinates, which repeat.
fn texel_of(uv: Vec2, size: usize) -> usize {
    let place = |share: f32| ((share.rem_euclid(1.0) * size as f32) as usize).min(size - 1);
    place(uv.y) * size + place(uv.x)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::Silent;
    use crate::transport::tests::{ball, material, scene_of};
    use cutis_scene::Light;
    use glam::Vec3;
    use std::f64::consts::PI;

    const SIZE: usize = 64;
    const RADIUS_MM: f64 = 10.0;
    const HALF_ANGLE: f64 = 0.5;

    /// A white ball of index 1 in even light from the side of +x: all that falls on it leaves it.
    #[test]
    fn the_light_that_fell_on_a_white_ball_is_all_on_its_map() {
        let body = ball(RADIUS_MM as f32, 48, material(0.0, 1.0, 1.0, 0.3));
        let light = Light::Directional {
            dir_to_light: Vec3::X,
            irradiance_w_per_m2: Vec3::splat(2.0),
            // Through a surface that bends nothing, paths meet the lamp by chance: it is large.
            angular_radius_rad: HALF_ANGLE as f32,
        };
        let scene = scene_of(vec![body], vec![light], None);
        let transport = Transport::new(&scene, 1).unwrap();
        let areas = areas_mm2(&scene.objects[0], SIZE);
        let whole: f64 = areas.iter().sum();
        assert!(
            (whole / (4.0 * PI * RADIUS_MM * RADIUS_MM) - 1.0).abs() < 3e-3,
            "the ball's surface: {whole}"
        );
        let settings =
            Settings { irradiance_size: SIZE as u32, samples_per_pixel: 16, ..Settings::default() };
        // The lamp's radiance E/(π sin²) times its solid angle 2π (1 - cos) times the ball's cross section, of which the
        // edges of 96 facets cut off 0.1 %.
        let expected = 2.0 * 2.0 / (1.0 + HALF_ANGLE.cos()) * PI * RADIUS_MM * RADIUS_MM;
        // On the ball +x is at a quarter of the turn or three, so that the map has a bright and a dark half.
        let sides = [Start::Light, Start::Texel].map(|start| {
            let map = ExitanceMap::starting(start, &transport, &settings, &Silent);
            let flux = |texel: usize| map.exitance_w_per_m2[texel].x * areas[texel];
            let total: f64 = (0..SIZE * SIZE).map(flux).sum();
            let error = (0..SIZE * SIZE).map(|t| (map.standard_error_w_per_m2[t].x * areas[t]).powi(2));
            let error = error.sum::<f64>().sqrt();
            // Four standard errors, and the facets and texels at the poles.
            let off = total - expected;
            assert!(off.abs() < 4.0 * error + 0.004 * expected, "{start:?}: {total} ± {error} of {expected}");
            assert!(error < 0.02 * expected, "{start:?}: {error}");
            (0..SIZE / 8)
                .map(|b| (0..SIZE * SIZE).filter(|t| t % SIZE / 8 == b).map(flux).sum())
                .collect::<Vec<f64>>()
        });
        for (block, (light, texel)) in sides[0].iter().zip(&sides[1]).enumerate() {
            assert!((light - texel).abs() < 0.02 * expected, "columns {block}: {light} and {texel}");
        }
        let (dark, bright) = sides[0].iter().fold((f64::MAX, 0.0f64), |(a, b), &x| (a.min(x), b.max(x)));
        assert!(bright > 3.0 * dark, "{dark} {bright}");
    }
}
