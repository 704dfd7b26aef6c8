//! Dither: even noise of less than a code of 8 bits, so that soft shading and the halos of bloom do not fall into bands,
//! or into coloured rings where the channels round at different places.
//!
//! Interleaved gradient noise (Jimenez 2014, "Next Generation Post Processing in Call of Duty: Advanced Warfare", slide 123
//! (number not checked)): u = fract(52.9829189 fract(0.06711056 x + 0.00583715 y)), which has little of low frequencies. Here
//! it is computed in whole numbers, so that the pattern has the same bits on every machine. Channels are 5.588238 pixels
//! apart along both axes, the shift its author uses between independent patterns.

/// 0.06711056 turns of 2³² for every column.
pub const TURN_OF_COLUMN: u32 = 288_237_660;
/// 0.00583715 turns for every row.
pub const TURN_OF_ROW: u32 = 25_070_368;
/// 5.588238 columns and rows for every channel.
pub const TURN_OF_CHANNEL: u32 = 1_750_839_832;
/// 52.9829189 in units of 1/1024: times 16 bits of a turn it has room in 32.
pub const STEEPNESS: u32 = 54_255;
/// Width of the noise, codes. What is left out lets values that lie on a code stay there through the rounding of the sRGB
/// curve; means are off by half of it at most.
pub const WIDTH: f32 = 0.998;

/// What is added to a value of a channel (0 red, 1 green, 2 blue, 3 coverage) at a place before it is rounded, codes.
pub fn dither(at: [u32; 2], channel: u32) -> f32 {
    let across = at[0].wrapping_mul(TURN_OF_COLUMN).wrapping_add(at[1].wrapping_mul(TURN_OF_ROW));
    let turn = across.wrapping_add(channel.wrapping_mul(TURN_OF_CHANNEL));
    let noise = ((turn >> 16) * STEEPNESS) << 6;
    // 24 bits are a whole f32.
    ((noise >> 8) as f32 / 16_777_216.0 - 0.5) * WIDTH
}

/// The 8-bit code of a value in 0..=1.
pub fn dithered(value: f32, at: [u32; 2], channel: u32) -> u8 {
    // `as` takes NaN to 0.
    (value * 255.0 + 0.5 + dither(at, channel)).clamp(0.0, 255.0) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All codes of one value over a patch.
    fn patch(value: f32, channel: u32) -> Vec<u8> {
        (0..128 * 128).map(|i| dithered(value, [1000 + i % 128, 2000 + i / 128], channel)).collect()
    }

    #[test]
    fn the_mean_over_a_patch_is_the_value() {
        for channel in 0..4 {
            for part in [0.1f32, 0.3, 0.5, 0.9] {
                let codes = patch((100.0 + part) / 255.0, channel);
                let mean = codes.iter().map(|&code| f64::from(code)).sum::<f64>() / codes.len() as f64;
                // White noise of 16384 samples would have a standard error of up to 0.004, this one has less; the width
                // of the noise adds 0.001.
                assert!((mean - f64::from(100.0 + part)).abs() < 0.01, "{channel}, {part}: {mean}");
            }
        }
    }

    #[test]
    fn codes_stay_through_the_curve_there_and_back() {
        for code in 0..=255u8 {
            let linear = cutis_scene::texture::srgb_to_linear(f32::from(code) / 255.0);
            let shown = patch(crate::film::linear_to_srgb(linear), u32::from(code) % 3);
            assert!(shown.iter().all(|&s| s == code), "{code}");
        }
    }

    #[test]
    fn neighbours_and_channels_differ() {
        let places = (0..64u32).map(|i| [i % 8, i / 8]);
        assert!(places.clone().all(|at| (dither(at, 0) - dither([at[0] + 1, at[1]], 0)).abs() > 0.05));
        assert!(places.clone().all(|at| (dither(at, 0) - dither(at, 1)).abs() > 0.05));
        // No pattern repeats from one row to the next.
        assert!(places.clone().all(|at| (dither(at, 0) - dither([at[0], at[1] + 1], 0)).abs() > 0.05));
    }
}
