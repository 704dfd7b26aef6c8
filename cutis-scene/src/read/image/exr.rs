//! OpenEXR: one layer of R, G, B (and A), or of Y alone, or any layer by its name; half, float or unsigned samples; every compression of the
//! `exr` crate, which has no DWAA and DWAB.

use super::{MAX_BYTES, check_size, mend};
use crate::{Texels, Texture};
use ::exr::image::{AnyChannel, AnyChannels, FlatSamples, Layer};
use ::exr::meta::MetaData;
use ::exr::meta::header::Header;
use ::exr::prelude::{Compression, ReadChannels, ReadLayers, Vec2};
use std::collections::BTreeSet;
use std::io::Cursor;

/// Most channels per layer: spectral files have tens.
const MAX_CHANNELS: usize = 256;

/// The first bytes of every file.
pub(super) const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// The channels of one part.
type Part = Layer<AnyChannels<FlatSamples>>;

/// Decodes the first layer; also the number of texels that were mended.
pub(super) fn decode(bytes: &[u8]) -> Result<(Texture, usize), String> {
    check_headers(bytes)?;
    let image = ::exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        // In this thread, so that a panic inside the decoder reaches the guard around us.
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(|e| e.to_string())?;
    let part = &image.layer_data;
    let find = |name: &str| part.channel_data.list.iter().find(|channel| channel.name == *name);
    let sources = match (find("R"), find("G"), find("B"), find("Y")) {
        (Some(r), Some(g), Some(b), _) => [Some(r), Some(g), Some(b), find("A")],
        (_, _, _, Some(y)) => [Some(y), Some(y), Some(y), find("A")],
        _ => {
            let names: Vec<_> = part.channel_data.list.iter().map(|c| c.name.to_string()).collect();
            return Err(format!("has no channels R, G, B and no Y; it has {}", names.join(", ")));
        }
    };
    Ok(to_texture(part, sources))
}

/// Decodes a layer by its name: channels `name.R` … of any part, or all channels of a part of that name.
pub(super) fn decode_layer(bytes: &[u8], name: &str) -> Result<(Texture, usize), String> {
    let all_bytes = check_headers(bytes)?;
    if all_bytes > MAX_BYTES {
        return Err(format!("its parts need {all_bytes} bytes; at most {MAX_BYTES} bytes are used"));
    }
    let image = ::exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(|e| e.to_string())?;
    let parts = &image.layer_data;
    let found = parts.iter().find_map(|part| Some(to_texture(part, layer_channels(part, name)?)));
    found.ok_or_else(|| {
        let names: BTreeSet<String> = parts.iter().flat_map(layer_names).collect();
        let names: Vec<_> = names.into_iter().collect();
        let has = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
        format!("has no layer '{name}'; it has {has}")
    })
}

/// Names of the layers among the channels of a part.
fn layer_names(part: &Part) -> Vec<String> {
    let names = part.channel_data.list.iter().map(|channel| channel.name.to_string());
    names.filter_map(|name| Some(name.rsplit_once('.')?.0.to_owned())).collect()
}

/// Up to three channels of a layer: by their usual names, or as they come; one alone is grey.
fn layer_channels<'a>(part: &'a Part, name: &str) -> Option<[Option<&'a AnyChannel<FlatSamples>>; 4]> {
    let is_whole_part = part.attributes.layer_name.as_ref().is_some_and(|own| *own == *name);
    let list = &part.channel_data.list;
    let within = |channel: &'a AnyChannel<FlatSamples>| {
        let full = channel.name.to_string();
        let short = full.strip_prefix(name).and_then(|rest| rest.strip_prefix('.')).map(str::to_owned);
        let short = short.or_else(|| (is_whole_part && !full.contains('.')).then_some(full));
        short.map(|short| (short, channel))
    };
    let channels: Vec<_> = list.iter().filter_map(within).collect();
    let find = |wanted: &str| channels.iter().find(|(short, _)| short == wanted).map(|(_, channel)| *channel);
    if let (Some(r), Some(g), Some(b)) = (find("R"), find("G"), find("B")) {
        return Some([Some(r), Some(g), Some(b), None]);
    }
    let nth = |i: usize| channels.get(i).map(|(_, channel)| *channel);
    match channels.len() {
        0 => None,
        1 => Some([nth(0), nth(0), nth(0), None]),
        _ => Some([nth(0), nth(1), nth(2), None]),
    }
}

/// Checks what the headers claim of each part; the bytes that all of them together need.
fn check_headers(bytes: &[u8]) -> Result<u64, String> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(|e| e.to_string())?;
    let mut all_bytes = 0;
    for header in &meta.headers {
        check_header(header, bytes.len())?;
        let Vec2(width, height) = header.layer_size;
        all_bytes += width as u64 * height as u64 * (16 + 4 * header.channels.list.len() as u64);
    }
    Ok(all_bytes)
}

fn check_header(header: &Header, file_bytes: usize) -> Result<(), String> {
    if matches!(header.compression, Compression::DWAA(_) | Compression::DWAB(_)) {
        return Err(
            "is compressed with DWAA or DWAB, which is not supported; save it with ZIP or PIZ".to_owned()
        );
    }
    if header.deep {
        return Err("holds deep data; flatten it first".to_owned());
    }
    let channels = &header.channels.list;
    if channels.len() > MAX_CHANNELS {
        return Err(format!("has {} channels; at most {MAX_CHANNELS} are read", channels.len()));
    }
    if channels.iter().any(|channel| channel.sampling != Vec2(1, 1)) {
        return Err("has subsampled channels (luminance and chroma); save it as RGB".to_owned());
    }
    let Vec2(width, height) = header.layer_size;
    // 16 bytes for the texture beside the channels themselves.
    let bytes_per_texel = 16 + 4 * channels.len() as u64;
    check_size(width as u64, height as u64, bytes_per_texel, file_bytes)
}

/// The texture of red, green, blue and alpha; what is missing is 0, alpha 1. Also the number of texels that were mended.
fn to_texture(part: &Part, sources: [Option<&AnyChannel<FlatSamples>>; 4]) -> (Texture, usize) {
    let Vec2(width, height) = part.size;
    let mut texels = vec![[0.0, 0.0, 0.0, 1.0]; width * height];
    for (slot, channel) in sources.into_iter().enumerate() {
        let values = channel.into_iter().flat_map(|channel| channel.sample_data.values_as_f32());
        for (texel, value) in texels.iter_mut().zip(values) {
            texel[slot] = value;
        }
    }
    let mended = mend(&mut texels);
    // Within u32: the header was checked.
    (Texture::new(width as u32, height as u32, Texels::LinearF32(texels)), mended)
}
