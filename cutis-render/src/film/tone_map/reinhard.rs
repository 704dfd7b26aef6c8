//! The global operator of Reinhard, Stark, Shirley & Ferwerda 2002, "Photographic Tone Reproduction for Digital
//! Images", doi:10.1145/566654.566575, eq. 4 (equation number from memory of the paper, not checked):
//!
//! L_d = L (1 + L / L_white²) / (1 + L), with L the luminance.
//!
//! The colour is scaled by L_d / L, so its hue and saturation stay; what then lies above white is cut off. The paper
//! takes L_white from the picture's brightest luminance; here it is fixed, so that a picture does not change its
//! tone when a highlight comes into view.

use glam::Vec3;

/// Luminance that becomes white: two stops above the white of a plain clamp.
const L_WHITE: f32 = 4.0;

/// Luminance of linear Rec. 709 (ITU-R BT.709-6, item 3.2).
const LUMINANCE: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);

pub(super) fn map(light: Vec3) -> Vec3 {
    let luminance = light.dot(LUMINANCE);
    // L_d / L: no division by a luminance that may be zero.
    light * ((1.0 + luminance / (L_WHITE * L_WHITE)) / (1.0 + luminance))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_white_luminance_becomes_white() {
        // The paper: "L_white is the smallest luminance that will be mapped to pure white".
        assert!((map(Vec3::splat(L_WHITE)) - Vec3::ONE).abs().max_element() < 4.0 * f32::EPSILON);
    }

    #[test]
    fn dark_light_follows_the_simple_operator() {
        // Eq. 3 of the paper, L / (1 + L), is the limit of a white far away: they differ by L / L_white² relative.
        for luminance in [1e-4f32, 1e-3, 1e-2] {
            let simple = luminance / (1.0 + luminance);
            let difference = map(Vec3::splat(luminance)).x / simple - 1.0;
            assert!((difference - luminance / 16.0).abs() < 8.0 * f32::EPSILON, "{luminance}: {difference}");
        }
    }

    #[test]
    fn ratios_between_channels_are_kept() {
        let shown = map(Vec3::new(3.0, 1.5, 0.75));
        assert!((shown.x / shown.y - 2.0).abs() < 1e-6 && (shown.y / shown.z - 2.0).abs() < 1e-6);
    }
}
