//! Khronos PBR Neutral (specification in `PBR_Neutral/README.md` of github.com/KhronosGroup/ToneMapping, 2024).
//!
//! Made to show base colours as they are: a glossy thing facing white light reflects its base colour plus 4 %, and
//! those 4 % are taken off again. Above `K_s` the peak is compressed into what is left below white, and the colour
//! fades towards white with `K_d`.

use glam::Vec3;

/// F_90 of the specification: reflectance at normal incidence for index 1.5.
const F90: f32 = 0.04;

/// K_s: peak at which compression starts.
const COMPRESSION_START: f32 = 0.8 - F90;

/// K_d: speed of the fading.
const DESATURATION: f32 = 0.15;

pub(super) fn map(light: Vec3) -> Vec3 {
    let colour = light - toe(light.min_element());
    let peak = colour.max_element();
    if peak <= COMPRESSION_START {
        return colour;
    }
    let room = 1.0 - COMPRESSION_START;
    let new_peak = 1.0 - room * room / (peak + room - COMPRESSION_START);
    let kept = 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    Vec3::splat(new_peak).lerp(colour * (new_peak / peak), kept)
}

/// f of the specification: what is taken off, by the smallest channel.
fn toe(x: f32) -> f32 {
    if x <= 2.0 * F90 { x - x * x / (4.0 * F90) } else { F90 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base_colours_come_out_less_the_reflection() {
        // First note of the specification: c_out = c_in - F90 for all channels in 0.08..=0.8.
        for colour in [Vec3::new(0.081, 0.4, 0.8), Vec3::splat(0.5), Vec3::new(0.8, 0.1, 0.09)] {
            assert_eq!(map(colour), colour - F90, "{colour}");
        }
    }

    #[test]
    fn the_toe_is_the_printed_parabola() {
        // By hand: x = 0.04 takes 0.04 - 0.04²/0.16 = 0.03 off. At 0.08 it meets F90 with slope 0.
        assert!((map(Vec3::splat(0.04)).x - 0.01).abs() < f32::EPSILON);
        assert!((toe(0.08) - F90).abs() < f32::EPSILON);
        assert!((toe(0.0799) - F90).abs() < 1e-7);
    }

    #[test]
    fn highlights_are_compressed_by_the_printed_formula() {
        // By hand for (2, 1, 1): f = 0.04, p = 1.96, p_n = 1 - 0.0576/1.44 = 0.96, g = 1/(0.15 + 1).
        let g = 1.0 / 1.15;
        let expected = Vec3::new(1.96, 0.96, 0.96) * (0.96 / 1.96) * g + Vec3::splat(0.96 * (1.0 - g));
        assert!((map(Vec3::new(2.0, 1.0, 1.0)) - expected).abs().max_element() < 4.0 * f32::EPSILON);
    }

    #[test]
    fn hue_stays() {
        // Second note of the specification: c_out lies in the plane of c_in and white, so the place of the middle
        // channel between the smallest and the largest stays.
        let place = |c: Vec3| (c.y - c.z) / (c.x - c.z);
        let light = Vec3::new(9.0, 4.0, 0.5);
        assert!((place(map(light)) - place(light)).abs() < 1e-5);
    }
}
