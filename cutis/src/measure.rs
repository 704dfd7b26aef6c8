//! Pictures against references: what `cutis diff` and `cutis compare` have in common. The numbers come from
//! [`cutis_render::difference`].

use cutis_render::Frame;
use cutis_render::difference::{
    DifferenceError, FlipMap, HdrFlip, Numbers, Pair, RELATIVE_EPSILON, hdr_flip, ldr_flip, numbers,
    relative_luminance_errors,
};
use cutis_render::film::{Film, develop, linear_to_srgb};
use glam::{Vec3, Vec4};
use image::{ImageFormat, RgbImage};
use miette::{IntoDiagnostic, Result, miette};
use serde::Serialize;
use std::io::Cursor;

/// A picture ready to be compared. Where it covers nothing it is black.
#[derive(Debug, Clone)]
pub struct Seen {
    /// Pixels in a row.
    pub width: usize,
    /// Linear Rec. 709: scene-referred light, or what a screen shows.
    pub light: Vec<Vec3>,
    /// What a screen shows: display-linear Rec. 709 in 0..=1.
    pub screen: Vec<Vec3>,
    /// Whether `light` has no limit.
    pub scene_referred: bool,
}

impl Seen {
    /// What a file of a screen's picture holds.
    pub fn on_screen(width: u32, pixels: &[Vec4]) -> Self {
        let light = colours(pixels);
        Self { width: width as usize, screen: light.clone(), light, scene_referred: false }
    }

    /// Light, developed as `cutis render` does, but without bloom, which would carry errors to where none were made.
    pub fn developed(width: u32, height: u32, pixels: Vec<Vec4>, exposure_ev: f32) -> Self {
        let frame = Frame { width, height, pixels, ..Frame::default() };
        let film = Film { exposure_ev, bloom: None, ..Film::default() };
        let screen = colours(&develop(&frame, &film).pixels);
        Self { width: width as usize, light: colours(&frame.pixels), screen, scene_referred: true }
    }

    /// The picture on the screen, as PNG.
    pub fn png(&self) -> Result<Vec<u8>> {
        png(self.width, self.screen.iter().map(|p| p.to_array().map(code)))
    }
}

/// All that is known of a picture against its reference.
#[derive(Debug, Clone)]
pub struct Measured {
    /// Plain numbers of the light.
    pub numbers: Numbers,
    /// FLIP on the screen.
    pub flip_ldr: FlipMap,
    /// FLIP of the light, where it has no limit.
    pub flip_hdr: Option<HdrFlip>,
    /// Error of the luminance with its sign, relative to the reference, pixel by pixel.
    pub luminance_errors: Vec<f32>,
}

impl Measured {
    /// Compares two pictures of the same kind.
    pub fn new(
        test: &Seen,
        reference: &Seen,
        pixels_per_degree: f64,
    ) -> std::result::Result<Self, DifferenceError> {
        let light = Pair::new(&test.light, &reference.light, test.width)?;
        let screen = Pair::new(&test.screen, &reference.screen, test.width)?;
        Ok(Self {
            numbers: numbers(light),
            flip_ldr: ldr_flip(screen, pixels_per_degree),
            flip_hdr: test.scene_referred.then(|| hdr_flip(light, pixels_per_degree)),
            luminance_errors: relative_luminance_errors(light),
        })
    }

    /// The FLIP that suits the pictures best: of all exposures where light has no limit.
    pub fn flip(&self) -> &FlipMap {
        self.flip_hdr.as_ref().map_or(&self.flip_ldr, |hdr| &hdr.map)
    }
}

/// The numbers for JSON. Those of light are in the unit of the pictures: W/(m² sr), or parts of the screen's white.
#[derive(Debug, Clone, Serialize)]
pub struct MeasuredReport {
    pub rmse: f64,
    pub relative_mse: f64,
    pub relative_mse_epsilon: f64,
    pub bias_rgb: [f64; 3],
    pub relative_bias_rgb: [Option<f64>; 3],
    pub flip_ldr: FlipReport,
    pub flip_hdr: Option<HdrFlipReport>,
}

/// Errors from 0 (unseen) to 1.
#[derive(Debug, Clone, Serialize)]
pub struct FlipReport {
    pub mean: f64,
    pub max: f32,
}

/// The same over several exposures.
#[derive(Debug, Clone, Serialize)]
pub struct HdrFlipReport {
    pub mean: f64,
    pub max: f32,
    pub start_exposure_ev: f64,
    pub stop_exposure_ev: f64,
    pub exposures: u32,
}

impl MeasuredReport {
    pub fn new(measured: &Measured) -> Self {
        let Numbers { rmse, relative_mse, bias, relative_bias } = measured.numbers;
        Self {
            rmse,
            relative_mse,
            relative_mse_epsilon: RELATIVE_EPSILON,
            bias_rgb: bias,
            relative_bias_rgb: relative_bias,
            flip_ldr: FlipReport { mean: measured.flip_ldr.mean, max: measured.flip_ldr.max },
            flip_hdr: measured.flip_hdr.as_ref().map(|HdrFlip { map, exposures }| HdrFlipReport {
                mean: map.mean,
                max: map.max,
                start_exposure_ev: exposures.start_ev,
                stop_exposure_ev: exposures.stop_ev,
                exposures: exposures.count,
            }),
        }
    }
}

/// A map of values in colours, as PNG.
pub fn map_png(width: usize, values: &[f32], colour: impl Fn(f32) -> [u8; 3]) -> Result<Vec<u8>> {
    png(width, values.iter().map(|&value| colour(value)))
}

/// Checks `--pixels-per-degree`.
pub fn pixels_per_degree_in_range(value: f64) -> Result<f64> {
    if (1.0..=1000.0).contains(&value) {
        return Ok(value);
    }
    Err(miette!("--pixels-per-degree must be 1 to 1000, got {value}"))
}

fn png(width: usize, pixels: impl Iterator<Item = [u8; 3]>) -> Result<Vec<u8>> {
    let bytes: Vec<u8> = pixels.flatten().collect();
    let height = bytes.len() / (3 * width);
    let image = RgbImage::from_raw(width as u32, height as u32, bytes)
        .ok_or_else(|| miette!("a map has lost its size"))?;
    let mut file = Cursor::new(Vec::new());
    image.write_to(&mut file, ImageFormat::Png).into_diagnostic()?;
    Ok(file.into_inner())
}

/// Colours are premultiplied: over black they stay as they are.
fn colours(pixels: &[Vec4]) -> Vec<Vec3> {
    pixels.iter().map(|pixel| pixel.truncate()).collect()
}

fn code(linear: f32) -> u8 {
    (255.0 * linear_to_srgb(linear.clamp(0.0, 1.0))).round() as u8
}
