//! The film: from a [`Frame`] of linear, scene-referred light to a picture that a screen can show, and to files.
//!
//! In order: exposure (a factor 2^EV), [`Bloom`], [`ToneMapper`]. The picture that comes out is *display-linear*:
//! linear Rec. 709 in 0..=1 with 1 the screen's white; the sRGB curve is applied when [`codes()`] for a screen are made or
//! a PNG is written, and what has 8 bits is [dithered](dither).
//! EXR files hold the frame itself, before the film: see [`write()`].
//!
//! Coverage: colours are premultiplied from end to end. Exposure and bloom are linear and act on colour and coverage
//! alike (bloom of a picture over a plain background is the bloom of both), the tone mapper acts on the colour
//! itself, divided by its coverage and multiplied again afterwards, so that edges keep their tone.

mod bloom;
mod checkpoint;
mod codes;
pub mod dither;
mod error;
mod exr;
mod format;
mod layer_png;
mod partial_file;
mod png;
mod srgb;
mod tone_map;
mod write;

pub use bloom::{Bloom, MAX_REACH, Spread};
pub use checkpoint::{Checkpoint, CheckpointError};
pub use codes::{codes, encoded};
pub use error::FilmError;
pub use format::{Format, known_extensions};
pub use srgb::linear_to_srgb;
pub use tone_map::ToneMapper;
pub use write::{LayerFile, Written, annotated_exr, check_output, layer_path, write};

use crate::{Frame, PassTime};
use glam::{Vec3, Vec4};
use rayon::prelude::*;
use std::time::Instant;

/// Largest and smallest exposure. 32 stops are a factor of 4 billion: more than any light in this world needs.
const MAX_EXPOSURE_EV: f32 = 32.0;

/// Radiance beyond this is taken as this: the largest half float, so that PNG and EXR see the same brightest light.
pub const MAX_RADIANCE: f32 = 65_504.0;

/// How a frame becomes a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Film {
    /// Exposure in stops: each one doubles the light.
    pub exposure_ev: f32,
    /// Glow around bright things; none without it.
    pub bloom: Option<Bloom>,
    /// How light without limit is brought into the range of a screen.
    pub tone_mapper: ToneMapper,
}

impl Default for Film {
    fn default() -> Self {
        Self { exposure_ev: 0.0, bloom: Some(Bloom::default()), tone_mapper: ToneMapper::Neutral }
    }
}

impl Film {
    /// Checks every number against its range.
    ///
    /// # Errors
    /// Names the first number that is out of its range.
    pub fn check(&self) -> Result<(), FilmError> {
        error::in_range("exposure", self.exposure_ev, -MAX_EXPOSURE_EV..=MAX_EXPOSURE_EV, "-32 to 32 EV")?;
        self.bloom.map_or(Ok(()), |bloom| bloom.check())
    }
}

/// A developed picture.
#[derive(Debug, Clone, Default)]
pub struct Picture {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Display-linear Rec. 709 in 0..=1, premultiplied by alpha, rows from the top.
    pub pixels: Vec<Vec4>,
    /// What was done and how long it took.
    pub passes: Vec<PassTime>,
}

/// Develops a frame: exposure, bloom, tone mapping. Returns the same bits for any number of threads.
///
/// # Panics
/// If the frame does not hold `width * height` pixels.
pub fn develop(frame: &Frame, film: &Film) -> Picture {
    let (width, height) = (frame.width, frame.height);
    assert_eq!(
        frame.pixels.len(),
        width as usize * height as usize,
        "a frame holds width times height pixels"
    );
    let gain = film.exposure_ev.exp2();
    let mut pixels: Vec<Vec4> = frame.pixels.par_iter().map(|&pixel| exposed(pixel, gain)).collect();
    let mut passes = Vec::new();
    if let Some(bloom) = film.bloom {
        passes.push(timed("bloom", || bloom.apply(width, height, &mut pixels)));
    }
    passes.push(timed("tone map", || {
        pixels.par_iter_mut().for_each(|pixel| *pixel = shown(*pixel, film.tone_mapper));
    }));
    Picture { width, height, pixels, passes }
}

/// A pixel that the rest can rely on: a number in every channel (black where there was none), no negative light,
/// coverage in 0..=1.
fn exposed(pixel: Vec4, gain: f32) -> Vec4 {
    if pixel.is_nan() {
        return Vec4::ZERO;
    }
    let colour = (pixel.truncate() * gain).clamp(Vec3::ZERO, Vec3::splat(MAX_RADIANCE));
    colour.extend(pixel.w.clamp(0.0, 1.0))
}

/// Tone maps the colour itself, not its product with the coverage.
fn shown(pixel: Vec4, tone_mapper: ToneMapper) -> Vec4 {
    if pixel.w <= 0.0 {
        return Vec4::ZERO; // nothing there: the tails of the bloom end where its coverage ends
    }
    let colour = (pixel.truncate() / pixel.w).min(Vec3::splat(MAX_RADIANCE));
    (tone_mapper.map(colour) * pixel.w).extend(pixel.w)
}

fn timed(name: &str, pass: impl FnOnce()) -> PassTime {
    let start = Instant::now();
    pass();
    PassTime { name: name.to_owned(), time: start.elapsed() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(pixels: Vec<Vec4>) -> Frame {
        Frame { width: pixels.len() as u32, height: 1, pixels, ..Frame::default() }
    }

    fn plain(exposure_ev: f32) -> Film {
        Film { exposure_ev, bloom: None, tone_mapper: ToneMapper::None }
    }

    #[test]
    fn a_stop_doubles_the_light() {
        let picture = develop(&frame(vec![Vec4::new(0.1, 0.2, 0.3, 1.0)]), &plain(1.0));
        // exp2(1) is exact and so is doubling.
        assert_eq!(picture.pixels[0], Vec4::new(0.2, 0.4, 0.6, 1.0));
    }

    #[test]
    fn half_covered_pixels_have_the_tone_of_covered_ones() {
        let covered = Vec4::new(2.0, 0.5, 0.1, 1.0);
        for tone_mapper in ToneMapper::ALL {
            let film = Film { tone_mapper, ..plain(0.0) };
            let picture = develop(&frame(vec![covered, covered * 0.5]), &film);
            assert_eq!(picture.pixels[0] * 0.5, picture.pixels[1], "{tone_mapper}");
        }
    }

    #[test]
    fn hostile_pixels_come_out_in_range() {
        let worst = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN, -1.0, 1e-40];
        let pixels: Vec<_> = worst.iter().map(|&v| Vec4::new(v, 1.0, v, 1.0)).collect();
        let picture = develop(&frame(pixels), &Film { exposure_ev: 32.0, ..Film::default() });
        assert!(picture.pixels.iter().all(|p| p.cmpge(Vec4::ZERO).all() && p.cmple(Vec4::ONE).all()));
    }

    #[test]
    fn numbers_out_of_range_are_named() {
        let message = |film: Film| film.check().expect_err("out of range").to_string();
        assert!(message(plain(f32::NAN)).contains("exposure must be -32 to 32 EV, got NaN"));
        assert!(message(plain(33.0)).contains("33"));
        let bloom = Some(Bloom { strength: 1.5, ..Bloom::default() });
        assert!(message(Film { bloom, ..Film::default() }).contains("bloom"));
        assert!(Film::default().check().is_ok());
    }
}
