//! PNG files: 8 or 16 bits, marked as sRGB.
//!
//! A picture in which every pixel is covered is written as RGB. If any is not, as RGBA with *straight* alpha, as the
//! PNG specification asks (PNG 3rd edition, section 6.2), so the premultiplied colour is divided by its coverage.
//! 8-bit colours are [dithered](super::dither), and so is their coverage; data are not.

use super::dither::dither;
use super::{Picture, linear_to_srgb};
use ::png::{BitDepth, ColorType, Compression, Encoder, EncodingError, SrgbRenderingIntent};
use glam::{Vec3, Vec4};
use rayon::prelude::*;
use std::io::Write;

/// Bits per channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Depth {
    /// One byte.
    Eight,
    /// Two bytes, the more significant first.
    Sixteen,
}

/// Values ready to be counted out: 1 to 4 channels in 0..=1, rows from the top.
pub(super) struct Raster {
    pub(super) width: u32,
    pub(super) height: u32,
    /// 1 grey, 3 RGB, 4 RGBA: as many components of each pixel count.
    pub(super) channels: usize,
    /// Whether the numbers are sRGB-encoded colours; others are data that nobody should convert.
    pub(super) srgb: bool,
    pub(super) pixels: Vec<Vec4>,
}

/// Writes a developed picture.
pub(super) fn write_picture(to: impl Write, picture: &Picture, depth: Depth) -> Result<(), EncodingError> {
    let max = depth.max_code();
    // What would be written as fully covered is.
    let covered = picture.pixels.par_iter().all(|pixel| code(pixel.w, max, 0.0) as f32 >= max);
    let pixels = picture.pixels.par_iter().map(|&pixel| straight(pixel)).collect();
    let (width, height) = (picture.width, picture.height);
    let channels = if covered { 3 } else { 4 };
    write_raster(to, &Raster { width, height, channels, srgb: true, pixels }, depth)
}

/// Writes plain values.
pub(super) fn write_raster(to: impl Write, raster: &Raster, depth: Depth) -> Result<(), EncodingError> {
    let mut encoder = Encoder::new(to, raster.width, raster.height);
    // Larger files than by default, written in a fraction of the time.
    encoder.set_compression(Compression::Fast);
    encoder.set_color(match raster.channels {
        1 => ColorType::Grayscale,
        3 => ColorType::Rgb,
        _ => ColorType::Rgba,
    });
    encoder.set_depth(if depth == Depth::Eight { BitDepth::Eight } else { BitDepth::Sixteen });
    if raster.srgb {
        encoder.set_source_srgb(SrgbRenderingIntent::RelativeColorimetric);
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&bytes(raster, depth))?;
    writer.finish()
}

impl Depth {
    fn max_code(self) -> f32 {
        if self == Self::Eight { 255.0 } else { 65_535.0 }
    }
}

/// The encoded colour itself beside its coverage.
fn straight(pixel: Vec4) -> Vec4 {
    let colour = if pixel.w > 0.0 { pixel.truncate() / pixel.w } else { Vec3::ZERO };
    let encoded = colour.to_array().map(|c| linear_to_srgb(c.clamp(0.0, 1.0)));
    Vec3::from_array(encoded).extend(pixel.w)
}

fn bytes(raster: &Raster, depth: Depth) -> Vec<u8> {
    let (max, channels) = (depth.max_code(), raster.channels);
    let dithered = raster.srgb && depth == Depth::Eight;
    let codes = move |(index, pixel): (usize, &Vec4)| {
        let at = [index as u32 % raster.width, index as u32 / raster.width];
        let pixel = *pixel;
        (0..channels).map(move |channel| {
            let shift = if dithered { dither(at, channel as u32) } else { 0.0 };
            code(pixel[channel], max, shift)
        })
    };
    let all = raster.pixels.par_iter().enumerate().flat_map_iter(codes);
    match depth {
        Depth::Eight => all.map(|code| code as u8).collect(),
        Depth::Sixteen => all.flat_map_iter(|code| (code as u16).to_be_bytes()).collect(),
    }
}

/// Nearest code to a value in 0..=1, shifted by less than half a code.
fn code(value: f32, max: f32, shift: f32) -> u32 {
    // `as` takes NaN to 0.
    (value * max + 0.5 + shift).clamp(0.0, max) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(alpha: f32) -> Picture {
        let pixels = (0..256 * 16).map(|i| {
            let c = (i % 256) as f32 / 255.0;
            Vec3::new(c, c * c, 1.0 - c).extend(1.0) * alpha
        });
        Picture { width: 256, height: 16, pixels: pixels.collect(), ..Picture::default() }
    }

    fn read_back(picture: &Picture, depth: Depth) -> image::DynamicImage {
        let mut file = Vec::new();
        write_picture(&mut file, picture, depth).expect("memory takes everything");
        image::load_from_memory(&file).expect("a PNG")
    }

    #[test]
    fn eight_bits_come_back_within_one_code() {
        let picture = ramp(1.0);
        let back = read_back(&picture, Depth::Eight);
        assert_eq!(back.color(), image::ColorType::Rgb8);
        for (pixel, read) in picture.pixels.iter().zip(back.to_rgb8().pixels()) {
            for channel in 0..3 {
                let exact = 255.0 * linear_to_srgb(pixel[channel]);
                // Half a code of rounding and half a code of dither.
                assert!((f32::from(read.0[channel]) - exact).abs() <= 1.0 + 1e-4);
            }
        }
    }

    #[test]
    fn sixteen_bits_come_back_within_half_a_code() {
        let picture = ramp(1.0);
        let back = read_back(&picture, Depth::Sixteen);
        assert_eq!(back.color(), image::ColorType::Rgb16);
        for (pixel, read) in picture.pixels.iter().zip(back.to_rgb16().pixels()) {
            let exact = 65_535.0 * linear_to_srgb(pixel.y);
            // Half a code of rounding; the product itself is rounded by up to 2^-9.
            assert!((f32::from(read.0[1]) - exact).abs() <= 0.51);
        }
    }

    #[test]
    fn coverage_makes_straight_alpha() {
        let back = read_back(&ramp(0.5), Depth::Sixteen).to_rgba16();
        let whole = read_back(&ramp(1.0), Depth::Sixteen).to_rgb16();
        for (half, whole) in back.pixels().zip(whole.pixels()) {
            assert_eq!(half.0[3], 32_768);
            assert_eq!(half.0[..3], whole.0, "halving and dividing by a half are exact");
        }
    }

    #[test]
    fn colours_and_coverage_are_dithered_and_data_are_not() {
        let flat = |value: f32, srgb: bool| {
            let pixels = vec![Vec4::splat(value); 128 * 128];
            bytes(&Raster { width: 128, height: 128, channels: 4, srgb, pixels }, Depth::Eight)
        };
        for exact in [0u8, 1, 77, 255] {
            assert!(flat(f32::from(exact) / 255.0, true).iter().all(|&b| b == exact), "{exact}");
        }
        for channel in 0..4 {
            let codes: Vec<_> = flat(100.3 / 255.0, true).into_iter().skip(channel).step_by(4).collect();
            let mean = codes.iter().map(|&b| f64::from(b)).sum::<f64>() / codes.len() as f64;
            // As for the dither itself.
            assert!((mean - 100.3).abs() < 0.01, "{channel}: {mean}");
        }
        assert!(flat(100.3 / 255.0, false).iter().all(|&b| b == 100));
    }

    #[test]
    fn the_file_says_srgb() {
        let mut file = Vec::new();
        write_picture(&mut file, &ramp(1.0), Depth::Eight).expect("memory takes everything");
        assert!(file.windows(4).any(|name| name == b"sRGB"));
    }
}
