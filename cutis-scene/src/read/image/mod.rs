//! Images: PNG (8 and 16 bit), JPEG, OpenEXR and Radiance HDR, told apart by their first bytes.
//!
//! The header is read first; a picture that is too large, empty, or larger than its bytes could ever hold is refused
//! before memory is asked for.

mod exr;
mod jpeg;
mod picture;

pub use picture::{PictureFile, read_picture};

use super::file::read_bytes;
use crate::texture::srgb_to_linear;
use crate::{SceneError, Texels, Texture, TextureSource};
use ::image::codecs::hdr::HdrDecoder;
use ::image::codecs::jpeg::JpegDecoder;
use ::image::codecs::png::PngDecoder;
use ::image::{ColorType, DynamicImage, ImageDecoder, Limits};
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

/// Largest width and height in texels.
const MAX_SIDE: u32 = 16_384;

/// Most memory that one decoded image may take.
const MAX_BYTES: u64 = 2 << 30;

/// Most texels that one byte of a file can honestly stand for: deflate packs at most 1032 bytes into one, and a byte
/// holds up to eight one-bit texels.
const MAX_TEXELS_PER_BYTE: u64 = 8 * 1032;

/// What the numbers in an image mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ColourSpace {
    /// A colour: 8 and 16 bit files are sRGB-encoded, float files linear.
    Colour,
    /// Normals, masks, roughness: numbers as they stand.
    Data,
}

/// Reads an image file. Things that were mended end up in `warnings`.
pub fn read_image(
    path: &Path,
    space: ColourSpace,
    warnings: &mut Vec<String>,
) -> Result<Texture, SceneError> {
    decode(&read_bytes(path, "image")?, space, warnings)
        .map(|texture| texture.with_source(TextureSource::File(path.to_owned())))
        .map_err(|reason| SceneError::new(path, "image", reason))
}

/// Decodes an image, or says why not.
pub(crate) fn decode(
    bytes: &[u8],
    space: ColourSpace,
    warnings: &mut Vec<String>,
) -> Result<Texture, String> {
    let (texture, mended) = guarded(|| decode_by_magic(bytes, space))?;
    if mended > 0 {
        warnings.push(format!(
            "{mended} texels of a {} × {} image are not finite numbers; NaN became 0, infinity 65504",
            texture.width(),
            texture.height()
        ));
    }
    Ok(texture)
}

/// Runs a decoder. They are other people's code that meets hostile bytes here. None is known to panic, but a picture
/// program must not die of a texture, so a panic becomes an error as the last resort.
fn guarded<T>(decode: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(decode)).unwrap_or_else(|_| Err("the decoder gave up on it".to_owned()))
}

/// Decodes by the first bytes; also the number of texels that were mended.
fn decode_by_magic(bytes: &[u8], space: ColourSpace) -> Result<(Texture, usize), String> {
    let text = |e: ::image::ImageError| e.to_string();
    match bytes {
        [] => Err("the file is empty".to_owned()),
        [0x76, 0x2f, 0x31, 0x01, ..] => exr::decode(bytes),
        [0x89, b'P', b'N', b'G', ..] => {
            check_png_header(bytes)?;
            to_texture(PngDecoder::with_limits(Cursor::new(bytes), limits()).map_err(text)?, bytes, space)
        }
        [0xff, 0xd8, ..] => {
            jpeg::check_complete(bytes)?;
            to_texture(JpegDecoder::new(Cursor::new(bytes)).map_err(text)?, bytes, space)
        }
        [b'#', b'?', ..] => {
            // Not strict: some programs write `#?RGBE` in the first line.
            to_texture(HdrDecoder::new_nonstrict(Cursor::new(bytes)).map_err(text)?, bytes, space)
        }
        _ => Err("is none of PNG, JPEG, OpenEXR and Radiance HDR by its first bytes".to_owned()),
    }
}

/// Checks the size in a PNG header before the decoder makes room for it.
fn check_png_header(bytes: &[u8]) -> Result<(), String> {
    let word = |at: usize| match bytes.get(at..at + 4) {
        Some(&[a, b, c, d]) => Ok(u64::from(u32::from_be_bytes([a, b, c, d]))),
        _ => Err(format!("is cut off after {} bytes, within its header", bytes.len())),
    };
    // Signature, length and name of the first chunk come before.
    check_size(word(16)?, word(20)?, 4, bytes.len())
}

fn limits() -> Limits {
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_BYTES);
    limits
}

/// Refuses sizes that are empty, too large, or cannot come out of so few bytes.
fn check_size(width: u64, height: u64, bytes_per_texel: u64, file_bytes: usize) -> Result<(), String> {
    let size = format!("the header claims {width} × {height} texels");
    if width == 0 || height == 0 {
        return Err(format!("{size}: an image has at least one"));
    }
    if width > u64::from(MAX_SIDE) || height > u64::from(MAX_SIDE) {
        return Err(format!("{size}; at most {MAX_SIDE} × {MAX_SIDE} are read"));
    }
    if width * height * bytes_per_texel > MAX_BYTES {
        return Err(format!("{size} of {bytes_per_texel} bytes; at most {MAX_BYTES} bytes are used"));
    }
    if width * height > MAX_TEXELS_PER_BYTE * file_bytes as u64 {
        return Err(format!("{size}, but the file has only {file_bytes} bytes"));
    }
    Ok(())
}

fn to_texture<D: ImageDecoder>(
    mut decoder: D,
    bytes: &[u8],
    space: ColourSpace,
) -> Result<(Texture, usize), String> {
    let (width, height) = decoder.dimensions();
    let stored = match decoder.color_type() {
        ColorType::L8 | ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8 => 4,
        _ => 16,
    };
    check_size(u64::from(width), u64::from(height), stored, bytes.len())?;
    decoder.set_limits(limits()).map_err(|e| e.to_string())?;
    let image = DynamicImage::from_decoder(decoder).map_err(|e| e.to_string())?;
    let (texels, mended) = texels(image, space);
    Ok((Texture::new(width, height, texels), mended))
}

/// Texels as compact as the file allows; the second number counts those that were mended.
fn texels(image: DynamicImage, space: ColourSpace) -> (Texels, usize) {
    use DynamicImage::{ImageLuma8, ImageLuma16, ImageLumaA8, ImageLumaA16};
    use DynamicImage::{ImageRgb8, ImageRgb16, ImageRgba8, ImageRgba16};
    match image {
        ImageLuma8(_) | ImageLumaA8(_) | ImageRgb8(_) | ImageRgba8(_) => {
            let texels = image.into_rgba8().into_raw().as_chunks::<4>().0.to_vec();
            match space {
                ColourSpace::Colour => (Texels::Srgb8(texels), 0),
                ColourSpace::Data => (Texels::Linear8(texels), 0),
            }
        }
        ImageLuma16(_) | ImageLumaA16(_) | ImageRgb16(_) | ImageRgba16(_) => {
            let raw = image.into_rgba16().into_raw();
            (Texels::LinearF32(raw.as_chunks::<4>().0.iter().map(|t| from_16_bit(*t, space)).collect()), 0)
        }
        image => {
            let mut texels = image.into_rgba32f().into_raw().as_chunks::<4>().0.to_vec();
            let mended = mend(&mut texels);
            (Texels::LinearF32(texels), mended)
        }
    }
}

fn from_16_bit(texel: [u16; 4], space: ColourSpace) -> [f32; 4] {
    let [r, g, b, a] = texel.map(|code| f32::from(code) / 65535.0);
    match space {
        ColourSpace::Colour => [srgb_to_linear(r), srgb_to_linear(g), srgb_to_linear(b), a],
        ColourSpace::Data => [r, g, b, a],
    }
}

/// Replaces numbers that are not finite, and counts the texels that had any. Renderers write infinities for the sun.
fn mend(texels: &mut [[f32; 4]]) -> usize {
    // The largest half float: far brighter than any white, and sums of many stay finite.
    let finite = |x: f32| match x {
        x if x.is_finite() => x,
        x if x.is_nan() => 0.0,
        x => 65_504.0 * x.signum(),
    };
    let mut mended = 0;
    for texel in texels.iter_mut().filter(|texel| !texel.iter().all(|x| x.is_finite())) {
        *texel = texel.map(finite);
        mended += 1;
    }
    mended
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_believed_only_within_reason() {
        assert!(check_size(1024, 1024, 4, 10_000).is_ok());
        assert!(check_size(0, 5, 4, 100).is_err());
        assert!(check_size(60_000, 60_000, 4, usize::MAX >> 20).is_err());
        assert!(check_size(16_384, 16_384, 16, usize::MAX >> 20).is_err(), "4 GiB of floats");
        assert!(check_size(4096, 4096, 4, 60).is_err(), "16 million texels from 60 bytes");
    }

    #[test]
    fn infinities_and_nans_are_mended_and_counted() {
        let mut texels = [[f32::NAN, 1.0, f32::INFINITY, 1.0], [0.5; 4]];
        assert_eq!(mend(&mut texels), 1);
        assert_eq!(texels, [[0.0, 1.0, 65_504.0, 1.0], [0.5; 4]]);
    }
}
