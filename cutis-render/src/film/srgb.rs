//! The transfer function of sRGB screens.

/// sRGB-encoded value of a linear one in 0..=1 (IEC 61966-2-1); the inverse of
/// [`cutis_scene::texture::srgb_to_linear`].
pub fn linear_to_srgb(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cutis_scene::texture::srgb_to_linear;

    #[test]
    fn it_is_the_inverse_of_decoding() {
        for i in 0..=1000 {
            let encoded = i as f32 / 1000.0;
            let error = (linear_to_srgb(srgb_to_linear(encoded)) - encoded).abs();
            // Two powers of a few roundings each; where the branches meet the standard's own constants leave 3e-8.
            assert!(error < 8.0 * f32::EPSILON, "{encoded}: {error}");
        }
    }

    #[test]
    fn middle_grey_has_its_known_code() {
        // 18 % reflectance is sRGB code 118 of 255 in every table of photographic greys (117.65 before rounding).
        assert_eq!((255.0 * linear_to_srgb(0.18)).round(), 118.0);
    }
}
