//! Images on surfaces. Stored as compactly as the file allows, always *read* as linear light.

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
        Self { width, height, texels }
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
            Texels::Srgb8(t) => {
                let [r, g, b, a] = t[index].map(usize::from);
                Vec4::new(SRGB_TO_LINEAR[r], SRGB_TO_LINEAR[g], SRGB_TO_LINEAR[b], a as f32 / 255.0)
            }
            Texels::Linear8(t) => Vec4::from_array(t[index].map(|byte| f32::from(byte) / 255.0)),
            Texels::LinearF32(t) => Vec4::from_array(t[index]),
        }
    }

    /// Bilinear read at `uv`, repeating outside [0, 1). Decodes before it interpolates.
    pub fn sample(&self, uv: Vec2) -> Vec4 {
        let x = uv.x.rem_euclid(1.0) * self.width as f32 - 0.5;
        let y = uv.y.rem_euclid(1.0) * self.height as f32 - 0.5;
        self.blend(x, y, |i| i.rem_euclid(i64::from(self.height)) as u32)
    }

    /// Bilinear read that repeats in u and holds the first and last row in v, as a latitude-longitude map needs.
    pub fn sample_latlong(&self, uv: Vec2) -> Vec4 {
        let x = uv.x.rem_euclid(1.0) * self.width as f32 - 0.5;
        let y = uv.y.clamp(0.0, 1.0) * self.height as f32 - 0.5;
        self.blend(x, y, |i| i.clamp(0, i64::from(self.height) - 1) as u32)
    }

    fn blend(&self, x: f32, y: f32, row: impl Fn(i64) -> u32) -> Vec4 {
        let (x0, y0) = (x.floor(), y.floor());
        let (fx, fy) = (x - x0, y - y0);
        let column = |i: i64| i.rem_euclid(i64::from(self.width)) as u32;
        let (left, right) = (column(x0 as i64), column(x0 as i64 + 1));
        let (top, bottom) = (row(y0 as i64), row(y0 as i64 + 1));
        let upper = self.texel(left, top).lerp(self.texel(right, top), fx);
        let lower = self.texel(left, bottom).lerp(self.texel(right, bottom), fx);
        upper.lerp(lower, fy)
    }
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
