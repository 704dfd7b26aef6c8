//! Layers as pictures to look at: which value becomes black and which white.
//!
//! PNG files hold 0..=1, layers hold anything. Normals are written as 0.5 + 0.5 n, colours of surfaces as they are,
//! light from 0 to its brightest channel, everything else from its smallest to its largest value. Colours are
//! sRGB-encoded, data are not. For the numbers themselves there is EXR.

use super::linear_to_srgb;
use super::png::Raster;
use crate::Layer;
use glam::Vec4;

/// The values that become black and white.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scale {
    pub(super) low: f32,
    pub(super) high: f32,
    /// Whether the values are colours.
    pub(super) colour: bool,
}

impl Scale {
    /// The scale that shows all of a layer.
    pub(super) fn of(layer: &Layer) -> Self {
        let colour = layer.channels == ["R", "G", "B"];
        match layer.name.as_str() {
            "normal" => Self { low: -1.0, high: 1.0, colour: false },
            "albedo" => Self { low: 0.0, high: 1.0, colour: true },
            _ => {
                let [min, max] = range(layer);
                let low = if colour { 0.0 } else { min };
                // A layer with one value everywhere is shown black.
                let high = if max > low { max } else { low + 1.0 };
                Self { low, high, colour }
            }
        }
    }

    fn shown(self, value: f32) -> f32 {
        // In two halves: the whole width of f32 would overflow. NaN is black.
        let part = (0.5 * value - 0.5 * self.low) / (0.5 * self.high - 0.5 * self.low);
        let part = part.clamp(0.0, 1.0).max(0.0); // clamp keeps NaN, max does not
        if self.colour { linear_to_srgb(part) } else { part }
    }
}

/// A layer ready to be written: grey for one channel, RGB otherwise (a fourth channel is left to EXR).
pub(super) fn raster(layer: &Layer, scale: Scale) -> Raster {
    let count = counting(layer);
    let shown = |pixel: &Vec4| {
        let mut values = [0.0; 4];
        for (value, component) in values.iter_mut().zip(pixel.to_array()).take(count) {
            *value = scale.shown(component);
        }
        Vec4::from_array(values)
    };
    let pixels = layer.pixels.iter().map(shown).collect();
    let channels = if count == 1 { 1 } else { 3 };
    Raster { width: layer.width, height: layer.height, channels, srgb: scale.colour, pixels }
}

/// Channels that are shown.
fn counting(layer: &Layer) -> usize {
    layer.channels.len().clamp(1, 3)
}

/// Smallest and largest finite value of the channels that are shown; 0 if there is none.
fn range(layer: &Layer) -> [f32; 2] {
    let count = counting(layer);
    let values = layer.pixels.iter().flat_map(|pixel| pixel.to_array().into_iter().take(count));
    let grow = |[min, max]: [f32; 2], v: f32| [min.min(v), max.max(v)];
    let [min, max] = values.filter(|v| v.is_finite()).fold([f32::INFINITY, f32::NEG_INFINITY], grow);
    if min <= max { [min, max] } else { [0.0, 0.0] }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layer(name: &str, channels: &[&str], values: &[f32]) -> Layer {
        let channels = channels.iter().map(|&c| c.to_owned()).collect();
        let pixels = values.iter().map(|&v| Vec4::splat(v)).collect();
        Layer { name: name.to_owned(), width: values.len() as u32, height: 1, channels, pixels }
    }

    fn shown(layer: &Layer) -> Vec<f32> {
        raster(layer, Scale::of(layer)).pixels.iter().map(|p| p.x).collect()
    }

    #[test]
    fn normals_are_halved_and_lifted() {
        assert_eq!(shown(&layer("normal", &["X", "Y", "Z"], &[-1.0, 0.0, 1.0])), [0.0, 0.5, 1.0]);
    }

    #[test]
    fn scalars_span_their_range_and_the_range_is_told() {
        let thickness = layer("thickness", &["Y"], &[f32::NAN, 2.0, 4.0, 10.0, f32::INFINITY]);
        let scale = Scale::of(&thickness);
        assert_eq!((scale.low, scale.high), (2.0, 10.0));
        assert_eq!(shown(&thickness), [0.0, 0.0, 0.25, 1.0, 1.0]);
        assert_eq!(raster(&thickness, scale).channels, 1);
    }

    #[test]
    fn light_is_scaled_from_zero_and_encoded() {
        let light = layer("irradiance", &["R", "G", "B"], &[1.0, 2.0]);
        assert_eq!(shown(&light), [linear_to_srgb(0.5), linear_to_srgb(1.0)]);
    }

    #[test]
    fn layers_without_contrast_or_numbers_are_black() {
        assert_eq!(shown(&layer("charts", &["Y"], &[3.0, 3.0])), [0.0, 0.0]);
        assert_eq!(shown(&layer("charts", &["Y"], &[f32::NAN])), [0.0]);
        assert_eq!(shown(&layer("stretch", &["Y"], &[f32::MIN, f32::MAX])), [0.0, 1.0]);
    }
}
