//! What the paths of every pixel have brought.

use crate::frame::{Frame, Layer};
use crate::sampling::{r2_point, random2};
use crate::settings::{Aov, Settings};
use crate::transport::estimate::Estimate;
use crate::transport::path::Transport;
use crate::transport::random::Random;
use cutis_scene::{CameraRays, Scene};
use glam::{DVec3, Vec2, Vec4};
use rayon::prelude::*;
use std::ops::Range;

/// Stream of random numbers that shifts the samples of a pixel.
const STREAM: u32 = 0x77;

/// Sums of what came along the paths, pixel by pixel.
pub struct Film {
    rays: CameraRays,
    eye_mm: DVec3,
    width: u32,
    height: u32,
    seed: u64,
    /// Whether there is something behind the bodies, so that no pixel is transparent.
    is_backed: bool,
    samples: u64,
    pixels: Vec<Pixel>,
}

/// Sums over the samples of a pixel.
#[derive(Debug, Clone, Copy, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct Pixel {
    diffuse: DVec3,
    specular: DVec3,
    all: Estimate,
    covered: u64,
    events: u64,
}

impl Film {
    /// Nothing seen yet.
    pub fn new(scene: &Scene, settings: &Settings) -> Self {
        let Settings { width, height, seed, .. } = *settings;
        Self {
            rays: scene.camera.rays(width as f32 / height as f32),
            eye_mm: scene.camera.position_mm.as_dvec3(),
            width,
            height,
            seed,
            is_backed: scene.background.is_some() || scene.environment.as_ref().is_some_and(|e| e.visible),
            samples: 0,
            pixels: vec![Pixel::default(); width as usize * height as usize],
        }
    }

    /// Adds as many samples to the pixels of some rows as they lack of `count` more than all have.
    pub fn expose(&mut self, transport: &Transport, count: u64, rows: Range<usize>) {
        let (wanted, width) = (self.samples + count, self.width as usize);
        let first = rows.start * width;
        let mut pixels = std::mem::take(&mut self.pixels);
        let some = pixels[first..rows.end * width].par_iter_mut().with_min_len(16).enumerate();
        some.for_each(|(i, pixel)| {
            let i = first + i;
            for sample in pixel.all.count()..wanted {
                let mut random = Random::new(self.seed, i as u64, sample);
                let dir = self.dir((i % width) as u32, (i / width) as u32, sample);
                let came = transport.radiance(self.eye_mm, dir, &mut random);
                pixel.diffuse += came.diffuse;
                pixel.specular += came.specular;
                pixel.all.add(came.diffuse + came.specular + came.background);
                pixel.covered += u64::from(came.covered);
                pixel.events += came.events;
            }
        });
        self.pixels = pixels;
    }

    /// All rows have `count` samples more.
    pub fn finish(&mut self, count: u64) {
        self.samples += count;
    }

    /// Direction of a sample: an even sequence over the pixel, shifted by chance.
    fn dir(&self, x: u32, y: u32, sample: u64) -> DVec3 {
        let within = r2_point(sample as u32, random2(x, y, STREAM, self.seed));
        let place =
            (Vec2::new(x as f32, y as f32) + within) / Vec2::new(self.width as f32, self.height as f32);
        self.rays.dir_through(Vec2::new(2.0 * place.x - 1.0, 1.0 - 2.0 * place.y)).as_dvec3().normalize()
    }

    /// Root of the mean squared standard error over the mean radiance, over the pixels that see a body.
    pub fn noise(&self) -> f64 {
        let covered = self.pixels.iter().filter(|pixel| pixel.covered > 0);
        let (mut squares, mut mean, mut count) = (0.0, 0.0, 0.0);
        for pixel in covered {
            squares += pixel.all.standard_error().length_squared() / 3.0;
            mean += pixel.all.mean().element_sum() / 3.0;
            count += 1.0;
        }
        if mean > 0.0 { (squares / count).sqrt() / (mean / count) } else { 0.0 }
    }

    /// Samples that every pixel has; some rows may have more.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// The sums, to be kept.
    pub fn state(&self) -> &[u8] {
        bytemuck::cast_slice(&self.pixels)
    }

    /// Goes on from sums that were kept, of the same size.
    pub fn restore(&mut self, samples: u64, state: &[u8]) {
        bytemuck::cast_slice_mut(&mut self.pixels).copy_from_slice(state);
        self.samples = samples;
    }

    /// Steps of all paths inside bodies.
    pub fn events(&self) -> u64 {
        self.pixels.iter().map(|pixel| pixel.events).sum()
    }

    /// The picture by now, with the layers asked for.
    pub fn frame(&self, settings: &Settings) -> Frame {
        let samples = self.samples as f64;
        let (width, height) = (self.width, self.height);
        let of = |value: DVec3, pixel: &Pixel| {
            let alpha = if self.is_backed { 1.0 } else { pixel.covered as f32 / samples as f32 };
            value.as_vec3().extend(alpha)
        };
        let layer = |&aov: &Aov| Layer {
            name: aov.to_string(),
            width,
            height,
            channels: aov.channels(),
            pixels: self
                .pixels
                .iter()
                .map(|pixel| match aov {
                    Aov::Diffuse => of(pixel.diffuse / samples, pixel),
                    Aov::Specular => of(pixel.specular / samples, pixel),
                    Aov::Samples => Vec4::new(pixel.covered as f32, pixel.all.count() as f32, 0.0, 0.0),
                    _ => of(pixel.all.standard_error(), pixel),
                })
                .collect::<Vec<Vec4>>(),
        };
        Frame {
            width,
            height,
            pixels: self.pixels.iter().map(|pixel| of(pixel.all.mean(), pixel)).collect(),
            layers: settings.aovs.iter().map(layer).collect(),
            ..Frame::default()
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::transport::tests::{ball, even_environment, material, scene_of};

    #[test]
    fn a_state_kept_between_rows_goes_on_as_if_nothing_had_happened() {
        let scene =
            scene_of(vec![ball(10.0, 8, material(0.1, 1.0, 1.4, 0.3))], vec![], Some(even_environment()));
        let transport = Transport::new(&scene, 1).unwrap();
        let settings = Settings { width: 12, height: 10, ..Settings::default() };
        let mut at_once = Film::new(&scene, &settings);
        at_once.expose(&transport, 4, 0..10);
        let mut broken_off = Film::new(&scene, &settings);
        broken_off.expose(&transport, 4, 0..6);
        assert_ne!(at_once.state(), broken_off.state());
        let mut resumed = Film::new(&scene, &settings);
        resumed.restore(broken_off.samples(), broken_off.state());
        resumed.expose(&transport, 3, 0..10);
        resumed.finish(3);
        // The first rows have four already.
        resumed.expose(&transport, 1, 0..10);
        assert_eq!(at_once.state(), resumed.state());
    }
}
