//! Images on surfaces. Stored as compactly as the file allows, always *read* as linear light.

use crate::TextureSource;
use glam::{Vec2, Vec4};

/// The stored texels, four channels each, row by row.
#[derive(Debug, Clone)]
pub enum Texels {
    /// 8 bit, colour channels sRGB-encoded, alpha linear.
    Srgb8(Vec<[u8; 4]>),
    /// 8 bit, linear (normals, masks, roughness).
    Linear8(Vec<[u8; 4]>),
    /// Linear 32-bit float (EXR, HDR, 16-bit files, procedural maps).
    LinearF32(Vec<[f32; 4]>),
}

/// A two-dimensional image.
#[derive(Debug, Clone)]
pub struct Texture {
    width: u32,
    height: u32,
    texels: Texels,
    source: Option<TextureSource>,
}

impl Texture {
    /// A texture from its texels.
    ///
    /// # Panics
    /// If the number of texels is not `width * height`, or zero: the reader has to check before.
    pub fn new(width: u32, height: u32, texels: Texels) -> Self {
        let count = match &texels {
            Texels::Srgb8(t) | Texels::Linear8(t) => t.len(),
            Texels::LinearF32(t) => t.len(),
        };
        assert!(width > 0 && height > 0, "a texture has at least one texel");
        assert_eq!(count, width as usize * height as usize, "texel count is width times height");
        Self { width, height, texels, source: None }
    }

    /// The same texture, known to come from somewhere.
    pub(crate) fn with_source(self, source: TextureSource) -> Self {
        Self { source: Some(source), ..self }
    }

    /// Where it came from; none if it was made by code or lies in another file.
    pub fn source(&self) -> Option<&TextureSource> {
        self.source.as_ref()
    }

    /// Width in texels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in texels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// How the texels are stored.
    pub fn texels(&self) -> &Texels {
        &self.texels
    }

    /// One texel, decoded to linear light.
    pub fn texel(&self, x: u32, y: u32) -> Vec4 {
        let index = y as usize * self.width as usize + x as usize;
        match &self.texels {
            Texels::Srgb8(t) => from_srgb8(t[index]),
            Texels::Linear8(t) => from_linear8(t[index]),
            Texels::LinearF32(t) => Vec4::from_array(t[index]),
        }
    }

    /// Bilinear read at `uv`, repeating outside [0, 1). Decodes before it interpolates.
    pub fn sample(&self, uv: Vec2) -> Vec4 {
        self.blend(uv - uv.floor(), |y| wrapped(y, self.height))
    }

    /// Bilinear read that repeats in u and holds the first and last row in v, as a latitude-longitude map needs.
    pub fn sample_latlong(&self, uv: Vec2) -> Vec4 {
        let place = Vec2::new(uv.x - uv.x.floor(), uv.y.clamp(0.0, 1.0));
        self.blend(place, |y| y.clamp(0, self.height as i32 - 1) as u32)
    }

    fn blend(&self, place: Vec2, row: impl Fn(i32) -> u32) -> Vec4 {
        let p = place * Vec2::new(self.width as f32, self.height as f32) - 0.5;
        let floor = p.floor();
        let f = p - floor;
        let (x, y) = (floor.x as i32, floor.y as i32);
        let [left, right] = [x, x + 1].map(|x| wrapped(x, self.width) as usize);
        let [top, bottom] = [y, y + 1].map(|y| row(y) as usize * self.width as usize);
        let texels = [top + left, top + right, bottom + left, bottom + right];
        let [a, b, c, d] = match &self.texels {
            Texels::Srgb8(t) => texels.map(|i| from_srgb8(t[i])),
            Texels::Linear8(t) => texels.map(|i| from_linear8(t[i])),
            Texels::LinearF32(t) => texels.map(|i| Vec4::from_array(t[i])),
        };
        let (upper, lower) = (a + (b - a) * f.x, c + (d - c) * f.x);
        upper + (lower - upper) * f.y
    }
}

/// `i` modulo `size`, for places at most one size outside.
#[inline]
fn wrapped(i: i32, size: u32) -> u32 {
    let size = size as i32;
    (if i < 0 {
        i + size
    } else if i >= size {
        i - size
    } else {
        i
    }) as u32
}

#[inline]
fn from_srgb8([r, g, b, a]: [u8; 4]) -> Vec4 {
    let linear = |code: u8| SRGB_TO_LINEAR[usize::from(code)];
    Vec4::new(linear(r), linear(g), linear(b), f32::from(a) / 255.0)
}

#[inline]
fn from_linear8(texel: [u8; 4]) -> Vec4 {
    Vec4::from_array(texel.map(f32::from)) / 255.0
}

/// The sRGB transfer function of IEC 61966-2-1, encoded to linear, for all 256 codes.
static SRGB_TO_LINEAR: std::sync::LazyLock<[f32; 256]> =
    std::sync::LazyLock::new(|| std::array::from_fn(|code| srgb_to_linear(code as f32 / 255.0)));

/// Linear value of an sRGB-encoded one in 0..=1 (IEC 61966-2-1).
pub fn srgb_to_linear(encoded: f32) -> f32 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_bytes_are_decoded_before_interpolation() {
        let texture = Texture::new(2, 1, Texels::Srgb8(vec![[0, 0, 0, 255], [255, 255, 255, 255]]));
        // Halfway between black and white in linear light is 0.5; interpolating the codes first would give 0.214.
        assert!((texture.sample(Vec2::new(0.5, 0.5)).x - 0.5).abs() < 1e-6);
    }

    #[test]
    fn srgb_matches_the_standard_at_mid_grey() {
        // IEC 61966-2-1: code 188 is 0.502886 in linear light (evaluated by hand from the formula in f64).
        assert!((SRGB_TO_LINEAR[188] - 0.502_886).abs() < 1e-6);
    }

    #[test]
    fn reads_repeat_outside_the_unit_square() {
        let texels = (0..4).map(|i| [i as f32, 0.0, 0.0, 1.0]).collect();
        let texture = Texture::new(4, 1, Texels::LinearF32(texels));
        let inside = texture.sample(Vec2::new(0.3, 0.5));
        assert!((texture.sample(Vec2::new(-1.7, 4.5)) - inside).length() < 1e-5);
    }
}
