//! Colours for maps of errors, as sRGB codes.

use super::magma::MAGMA;

/// Colours of the diverging map, from -1 to 1 in even steps: dark in the middle, like the map of magma, so that what is
/// right stays quiet; cold where the picture is too dark and warm where it is too bright.
const DIVERGING: [[f32; 3]; 7] = [
    [214.0, 240.0, 255.0],
    [84.0, 164.0, 240.0],
    [32.0, 84.0, 160.0],
    [20.0, 20.0, 24.0],
    [158.0, 62.0, 22.0],
    [244.0, 138.0, 42.0],
    [255.0, 238.0, 196.0],
];

/// The colour of an error in 0..=1 in matplotlib's map "magma"; beyond, the ends of the map.
pub fn magma(error: f32) -> [u8; 3] {
    // `as` takes NaN and negative numbers to 0.
    let [_, r, g, b] = MAGMA[((255.0 * error + 0.5) as usize).min(255)].to_be_bytes();
    [r, g, b]
}

/// The colour of a signed error in -1..=1; beyond, the ends of the map.
pub fn diverging(error: f32) -> [u8; 3] {
    let last = DIVERGING.len() - 1;
    let place = (0.5 * error + 0.5).clamp(0.0, 1.0) * last as f32;
    let index = (place as usize).min(last - 1);
    let part = place - index as f32;
    let [from, to] = [DIVERGING[index], DIVERGING[index + 1]];
    [0, 1, 2].map(|c| (from[c] + (to[c] - from[c]) * part).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn magma_grows_brighter_all_the_way() {
        // Ends of the table of matplotlib: (0.001462, 0.000466, 0.013866) and (0.987053, 0.991438, 0.749504).
        assert_eq!((magma(0.0), magma(1.0)), ([0, 0, 4], [252, 253, 191]));
        assert_eq!((magma(f32::NAN), magma(-1.0), magma(9.0)), (magma(0.0), magma(0.0), magma(1.0)));
        let brightness = |i: u32| {
            let [r, g, b] = magma(i as f32 / 255.0).map(f32::from);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        // Codes are whole numbers: neighbours may be equal, never darker by more than their rounding.
        assert!((0..255).all(|i| brightness(i + 1) > brightness(i) - 0.5));
    }

    #[test]
    fn the_diverging_map_is_cold_below_and_warm_above() {
        assert_eq!(diverging(0.0), [20, 20, 24]);
        assert_eq!((diverging(-2.0), diverging(2.0)), ([214, 240, 255], [255, 238, 196]));
        for error in [0.05, 0.3, 0.7, 0.95] {
            let ([r, _, b], [cold_r, _, cold_b]) = (diverging(error), diverging(-error));
            assert!(r > b && cold_b > cold_r, "{error}");
        }
    }
}
