//! Radiant exitance per texel: what leaves the skin, after having been inside, before any eye looks.

mod from_lights;
mod from_texels;
mod keeper;

use super::key;
use crate::RenderError;
use crate::frame::Layer;
use crate::passes::atlas::Atlas;
use crate::progress::Progress;
use crate::settings::{Aov, Settings};
use crate::transport::path::Transport;
use from_lights::FromLights;
use from_texels::FromTexels;
use glam::DVec3;
use keeper::Keeper;

/// Width and height of the map that decides where to start, and samples per texel of it.
const PILOT_SIZE: usize = 64;
const PILOT_SAMPLES: u64 = 24;
/// Work between two looks at the noise, in samples of all texels: some seconds.
const STEP: u64 = 1 << 20;
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
    /// The sums, to be kept.
    fn state(&self) -> Vec<u8>;
    /// Goes on from sums that were kept after so many samples per texel.
    fn restore(&mut self, samples: u64, state: &[u8]);
}

impl ExitanceMap {
    /// Estimates the map from where that is quicker, until there are enough samples or the median noise is low enough.
    ///
    /// # Errors
    /// If its checkpoint belongs to something else, or cannot be kept.
    pub fn new(
        transport: &Transport,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<Self, RenderError> {
        let start = quicker(transport, settings);
        tracing::info!("exitance starts at each {start:?}");
        Self::starting(start, transport, settings, progress)
    }

    /// The same from a given start.
    ///
    /// # Errors
    /// If its checkpoint belongs to something else, or cannot be kept.
    pub fn starting(
        start: Start,
        transport: &Transport,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<Self, RenderError> {
        let size = settings.irradiance_size as usize;
        let atlas = Atlas::new(&transport.scene.objects[0], size);
        let mut estimator: Box<dyn Estimator + '_> = match start {
            Start::Light => Box::new(FromLights::new(transport, size, settings.seed)),
            Start::Texel => Box::new(FromTexels::new(transport, &atlas, settings.seed)),
        };
        let wanted = u64::from(settings.samples_per_pixel);
        let mut keeper = Keeper::new(settings, key::of_map(transport.scene, settings, start));
        let mut samples = keeper.load(estimator.as_mut())?;
        let step = (STEP / (size * size) as u64).max(1);
        progress.begin("exitance", wanted);
        progress.advance(samples.min(wanted));
        while samples < wanted {
            let count = step.min(wanted - samples);
            estimator.add(samples, count);
            samples += count;
            progress.advance(count);
            let noise = median_noise((0..size * size).map(|texel| estimator.texel(texel)));
            progress.note(&format!("exitance, noise {:.2} %", 100.0 * noise));
            if samples >= SAMPLES_MIN && settings.target_error.is_some_and(|target| noise <= target) {
                break;
            }
            keeper.keep_now_and_then(samples, estimator.as_ref())?;
        }
        keeper.keep(samples, estimator.as_ref())?;
        let (exitance_w_per_m2, standard_error_w_per_m2) =
            (0..size * size).map(|texel| estimator.texel(texel)).unzip();
        Ok(Self { size, start, exitance_w_per_m2, standard_error_w_per_m2, samples })
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

#[cfg(test)]
mod tests;
