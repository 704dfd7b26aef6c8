//! OpenEXR: one layer of R, G, B (and A), or of Y alone; half, float or unsigned samples; every compression of the
//! `exr` crate, which has no DWAA and DWAB.

use super::{check_size, mend};
use crate::{Texels, Texture};
use ::exr::image::{AnyChannels, FlatSamples, Layer};
use ::exr::meta::MetaData;
use ::exr::meta::header::Header;
use ::exr::prelude::{Compression, ReadChannels, ReadLayers, Vec2};
use std::io::Cursor;

/// Most channels per layer: spectral files have tens.
const MAX_CHANNELS: usize = 256;

/// Decodes the first layer; also the number of texels that were mended.
pub(super) fn decode(bytes: &[u8]) -> Result<(Texture, usize), String> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(|e| e.to_string())?;
    for header in &meta.headers {
        check_header(header, bytes.len())?;
    }
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
    to_texture(&image.layer_data)
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

fn to_texture(layer: &Layer<AnyChannels<FlatSamples>>) -> Result<(Texture, usize), String> {
    let Vec2(width, height) = layer.size;
    let find = |name: &str| layer.channel_data.list.iter().find(|channel| channel.name == *name);
    let sources = match (find("R"), find("G"), find("B"), find("Y")) {
        (Some(r), Some(g), Some(b), _) => [r, g, b],
        (_, _, _, Some(y)) => [y, y, y],
        _ => {
            let names: Vec<_> = layer.channel_data.list.iter().map(|c| c.name.to_string()).collect();
            return Err(format!("has no channels R, G, B and no Y; it has {}", names.join(", ")));
        }
    };
    let mut texels = vec![[0.0, 0.0, 0.0, 1.0]; width * height];
    let alpha = find("A").map(|channel| (3, channel));
    for (slot, channel) in sources.into_iter().enumerate().chain(alpha) {
        for (texel, value) in texels.iter_mut().zip(channel.sample_data.values_as_f32()) {
            texel[slot] = value;
        }
    }
    let mended = mend(&mut texels);
    // Within u32: the header was checked.
    Ok((Texture::new(width as u32, height as u32, Texels::LinearF32(texels)), mended))
}
