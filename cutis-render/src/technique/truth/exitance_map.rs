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
/// Samples before the noise is believed.
const SAMPLES_MIN: u64 = 16;

/// Where estimates begin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Start {
    /// Packets at the lights: good where few places shine.
    Light,
    /// Paths at the texels: good where light comes from everywhere, and for the dark side.
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

/// Median of error over mean, channels summed, over what shines at all.
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
    /// Triangles of the object itself; further ones are caps and have no texels.
    triangles: u32,
    sums: Vec<DVec3>,
    squares: Vec<DVec3>,
    packets: u64,
}

impl<'a, 'b> FromLights<'a, 'b> {
    fn new(transport: &'b Transport<'a>, size: usize, seed: u64) -> Self {
        let object = &transport.scene.objects[0];
        let triangles = object.mesh.triangles.len() as u32;
        let nothing = vec![DVec3::ZERO; size * size];
        Self {
            entrances: Entrances::new(transport),
            size,
            seed,
            areas_mm2: areas_mm2(object, size),
            triangles,
            sums: nothing.clone(),
            squares: nothing,
            packets: 0,
        }
    }
}

impl Estimator for FromLights<'_, '_> {
    fn add(&mut self, first: u64, count: u64) -> u64 {
        let Self { entrances, size, seed, triangles, sums, squares, .. } = self;
        let per_sample = (*size * *size) as u64;
        self.packets += count * per_sample;
        entrances.walk(*seed, first * per_sample, count * per_sample, |exit| {
            if exit.object == 0 && exit.triangle < *triangles {
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
            let weights = [f64::from(surface.b1), f64::from(surface.b2)];
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

/// Area of the surface in each texel, mm²: triangles are cut into parts smaller than a texel.
fn areas_mm2(object: &Object, size: usize) -> Vec<f64> {
    let mut areas = vec![0.0; size * size];
    for triangle in 0..object.mesh.triangles.len() {
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
