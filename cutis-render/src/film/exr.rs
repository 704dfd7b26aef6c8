//! OpenEXR files: the frame as it was rendered, linear and scene-referred.
//!
//! No exposure, no bloom and no tone mapper is applied: the numbers are radiance in W/(m² sr), colour premultiplied
//! by alpha, as EXR files hold it. Layers as large as the picture become channels `layer.R` … of the same part, which
//! every reader understands; layers of another size become parts of their own, named after the layer, with the same
//! channel names. Compression is ZIP (lossless). In half-float files colours are half floats, clamped to ±65504
//! where they are finite; other quantities (normals, millimetres, chart numbers) stay 32-bit, because half floats
//! count only to 2048.

use crate::{Frame, Layer};
use ::exr::meta::attribute::Chromaticities;
use ::exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, ImageAttributes, IntegerBounds, Layer as Part,
    LayerAttributes, Text, Vec2, WritableImage, f16,
};
use glam::Vec4;
use std::io::{Seek, Write};

/// Largest finite half float.
const MAX_HALF: f32 = 65_504.0;

/// Writes a frame with its layers, and with words about it where there are some (attribute `comments` of every part).
pub(super) fn write_frame(
    to: impl Write + Seek,
    frame: &Frame,
    half: bool,
    comment: Option<&str>,
) -> Result<(), ::exr::error::Error> {
    let (same, other): (Vec<_>, Vec<_>) =
        frame.layers.iter().partition(|layer| (layer.width, layer.height) == (frame.width, frame.height));
    let mut channels = picture_channels(frame, half);
    channels.extend(same.into_iter().flat_map(|layer| layer_channels(layer, half)));
    let mut parts = vec![part("picture", frame.width, frame.height, channels)];
    for layer in other {
        parts.push(part(&layer.name, layer.width, layer.height, layer_channels(layer, half)));
    }
    for part in &mut parts {
        part.attributes.comments = comment.map(Text::from);
    }
    let window = IntegerBounds::from_dimensions(Vec2(frame.width as usize, frame.height as usize));
    let attributes = ImageAttributes { chromaticities: Some(rec709()), ..ImageAttributes::new(window) };
    Image::from_layers(attributes, parts).write().to_buffered(to)
}

fn picture_channels(frame: &Frame, half: bool) -> Vec<AnyChannel<FlatSamples>> {
    let name = |i: usize| ["R", "G", "B", "A"][i];
    (0..4).map(|i| AnyChannel::new(name(i), samples(&frame.pixels, i, half))).collect()
}

fn layer_channels(layer: &Layer, half: bool) -> Vec<AnyChannel<FlatSamples>> {
    let half = half && layer.channels == ["R", "G", "B"];
    let channel = |(i, name): (usize, &String)| {
        let name = Text::from(format!("{}.{name}", layer.name).as_str());
        AnyChannel::new(name, samples(&layer.pixels, i, half))
    };
    layer.channels.iter().take(4).enumerate().map(channel).collect()
}

fn samples(pixels: &[Vec4], component: usize, half: bool) -> FlatSamples {
    let values = pixels.iter().map(|pixel| pixel[component]);
    if half { FlatSamples::F16(values.map(to_half).collect()) } else { FlatSamples::F32(values.collect()) }
}

/// What is finite stays finite.
fn to_half(value: f32) -> f16 {
    f16::from_f32(if value.is_finite() { value.clamp(-MAX_HALF, MAX_HALF) } else { value })
}

fn part(
    name: &str,
    width: u32,
    height: u32,
    channels: Vec<AnyChannel<FlatSamples>>,
) -> Part<AnyChannels<FlatSamples>> {
    let software_name = Some(Text::from(concat!("cutis ", env!("CARGO_PKG_VERSION"))));
    let attributes = LayerAttributes { software_name, ..LayerAttributes::named(name) };
    let size = Vec2(width as usize, height as usize);
    Part::new(size, attributes, Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels.into_iter().collect()))
}

/// Primaries and white of ITU-R BT.709-6, item 1.3 and 1.4 (D65).
fn rec709() -> Chromaticities {
    Chromaticities {
        red: Vec2(0.640, 0.330),
        green: Vec2(0.300, 0.600),
        blue: Vec2(0.150, 0.060),
        white: Vec2(0.3127, 0.3290),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::exr::prelude::{ReadChannels, ReadLayers};
    use std::collections::BTreeMap;
    use std::io::Cursor;

    /// Values of each channel by name, through the general reader of the crate.
    fn read_back(frame: &Frame, half: bool) -> BTreeMap<String, Vec<f32>> {
        let mut file = Cursor::new(Vec::new());
        write_frame(&mut file, frame, half, None).expect("memory takes everything");
        file.set_position(0);
        let image = ::exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .all_layers()
            .all_attributes()
            .from_buffered(file)
            .expect("an EXR");
        let channels = image.layer_data.into_iter().flat_map(|layer| layer.channel_data.list);
        channels.map(|c| (c.name.to_string(), c.sample_data.values_as_f32().collect())).collect()
    }

    fn frame() -> Frame {
        let value =
            |i: usize| Vec4::new(i as f32 * 0.37, 1e-3 * i as f32, 300.0 * i as f32, (i % 3) as f32 / 2.0);
        let names = |list: [&str; 3]| list.map(str::to_owned).to_vec();
        let layer = |name: &str, channels, width: u32, height: u32| Layer {
            name: name.to_owned(),
            width,
            height,
            channels,
            pixels: (0..(width * height) as usize).map(value).collect(),
        };
        Frame {
            width: 40,
            height: 30,
            pixels: (0..1200).map(value).collect(),
            layers: vec![
                layer("irradiance", names(["R", "G", "B"]), 40, 30),
                layer("normal", names(["X", "Y", "Z"]), 40, 30),
                layer("charts", vec!["Y".to_owned()], 64, 64),
            ],
            ..Frame::default()
        }
    }

    #[test]
    fn floats_come_back_as_they_are_under_their_names() {
        let frame = frame();
        let channels = read_back(&frame, false);
        let names = [
            "A",
            "B",
            "G",
            "R",
            "charts.Y",
            "irradiance.B",
            "irradiance.G",
            "irradiance.R",
            "normal.X",
            "normal.Y",
            "normal.Z",
        ];
        assert!(channels.keys().eq(names), "{:?}", channels.keys());
        for (i, name) in ["R", "G", "B", "A"].iter().enumerate() {
            assert!(channels[*name].iter().eq(frame.pixels.iter().map(|p| &p[i])), "{name}");
        }
        assert!(channels["charts.Y"].iter().eq(frame.layers[2].pixels.iter().map(|p| &p.x)));
    }

    #[test]
    fn halves_come_back_within_their_rounding() {
        let frame = frame();
        let channels = read_back(&frame, true);
        for (read, pixel) in channels["irradiance.B"].iter().zip(&frame.layers[0].pixels) {
            let stored = pixel.z.min(MAX_HALF);
            // 11 significant bits: half a unit in the last place is 2^-11 of the value.
            assert!((read - stored).abs() <= stored * 0.5f32.powi(11), "{read} for {stored}");
        }
        assert!(
            channels["charts.Y"].iter().eq(frame.layers[2].pixels.iter().map(|p| &p.x)),
            "numbers stay exact"
        );
        assert!(channels.values().flatten().all(|v| v.is_finite()));
    }

    #[test]
    fn the_same_frame_makes_the_same_bytes() {
        let write = || {
            let mut file = Cursor::new(Vec::new());
            write_frame(&mut file, &frame(), true, None).expect("memory takes everything");
            file.into_inner()
        };
        assert_eq!(write(), write());
    }
}
