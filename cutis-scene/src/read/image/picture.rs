//! Pictures to be measured: every pixel as the file holds it. What is not a number is refused here, where a texture
//! would be mended.

use super::{ColourSpace, decode_by_magic, exr, guarded};
use crate::read::file::read_bytes;
use crate::{SceneError, Texture};
use glam::Vec4;
use std::path::Path;

/// A picture from a file.
#[derive(Debug, Clone)]
pub struct PictureFile {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Linear Rec. 709, premultiplied by alpha, rows from the top.
    pub pixels: Vec<Vec4>,
    /// Whether the file holds light without limit (EXR, HDR). Otherwise it holds what a screen shows (PNG, JPEG), and
    /// 1 is the screen's white.
    pub scene_referred: bool,
}

/// Reads a picture; of an EXR file the named layer, or without a name the picture itself.
///
/// # Errors
/// If the file cannot be read, has no such layer, or holds a pixel that is not a finite number.
pub fn read_picture(path: &Path, layer: Option<&str>) -> Result<PictureFile, SceneError> {
    let failed = |reason| SceneError::new(path, "picture", reason);
    decode(&read_bytes(path, "picture")?, layer).map_err(failed)
}

fn decode(bytes: &[u8], layer: Option<&str>) -> Result<PictureFile, String> {
    let is_exr = bytes.starts_with(&exr::MAGIC);
    let (texture, mended) = match layer {
        Some(name) if is_exr => guarded(|| exr::decode_layer(bytes, name))?,
        Some(name) => return Err(format!("is no EXR file, and only those have layers such as '{name}'")),
        None => guarded(|| decode_by_magic(bytes, ColourSpace::Colour))?,
    };
    if mended > 0 {
        return Err(format!(
            "{mended} of its pixels are not finite numbers; such a picture cannot be measured"
        ));
    }
    let scene_referred = is_exr || bytes.starts_with(b"#?");
    // Colours of EXR files are premultiplied already, PNG files hold them straight.
    let pixels = pixels(&texture, !scene_referred);
    Ok(PictureFile { width: texture.width(), height: texture.height(), pixels, scene_referred })
}

fn pixels(texture: &Texture, straight: bool) -> Vec<Vec4> {
    let rows = 0..texture.height();
    let texels = rows.flat_map(|y| (0..texture.width()).map(move |x| texture.texel(x, y)));
    texels.map(|p| if straight { (p.truncate() * p.w).extend(p.w) } else { p }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::exr::prelude::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, ImageAttributes, Layer};
    use ::exr::prelude::{IntegerBounds, LayerAttributes, Vec2, WritableImage};
    use ::image::{ImageFormat, Rgba, RgbaImage};
    use std::io::Cursor;

    /// An EXR of 2 × 1 pixels: a first part with the given channels, and a second one, `extra`, with its own.
    fn exr_file(channels: &[(&str, [f32; 2])]) -> Vec<u8> {
        let part = |name: &str, list: &[(&str, [f32; 2])]| {
            let list = list.iter().map(|(n, v)| AnyChannel::new(*n, FlatSamples::F32(v.to_vec())));
            let channels = AnyChannels::sort(list.collect());
            Layer::new(Vec2(2, 1), LayerAttributes::named(name), Encoding::UNCOMPRESSED, channels)
        };
        let attributes = ImageAttributes::new(IntegerBounds::from_dimensions(Vec2(2, 1)));
        let parts =
            vec![part("picture", channels), part("extra", &[("extra.U", [8.0; 2]), ("extra.V", [9.0; 2])])];
        let mut file = Cursor::new(Vec::new());
        Image::from_layers(attributes, parts)
            .write()
            .to_buffered(&mut file)
            .expect("memory takes everything");
        file.into_inner()
    }

    const PICTURE: [(&str, [f32; 2]); 8] = [
        ("R", [1.0, 100.0]),
        ("G", [2.0, 200.0]),
        ("B", [3.0, 300.0]),
        ("A", [0.5, 1.0]),
        ("normal.X", [-1.0, 0.0]),
        ("normal.Y", [0.0, 1.0]),
        ("normal.Z", [0.0, 0.0]),
        ("charts.chart", [4.0, 5.0]),
    ];

    #[test]
    fn pictures_and_layers_of_an_exr_are_told_apart() {
        let bytes = exr_file(&PICTURE);
        let picture = decode(&bytes, None).expect("a picture");
        assert_eq!((picture.width, picture.height, picture.scene_referred), (2, 1, true));
        assert_eq!(picture.pixels, [Vec4::new(1.0, 2.0, 3.0, 0.5), Vec4::new(100.0, 200.0, 300.0, 1.0)]);
        let layer = |name| decode(&bytes, Some(name)).expect("a layer").pixels;
        assert_eq!(layer("normal"), [Vec4::new(-1.0, 0.0, 0.0, 1.0), Vec4::new(0.0, 1.0, 0.0, 1.0)]);
        assert_eq!(layer("charts"), [Vec4::new(4.0, 4.0, 4.0, 1.0), Vec4::new(5.0, 5.0, 5.0, 1.0)]);
        assert_eq!(layer("extra")[0], Vec4::new(8.0, 9.0, 0.0, 1.0));
        let missing = decode(&bytes, Some("depth")).expect_err("not there");
        assert_eq!(missing, "has no layer 'depth'; it has charts, extra, normal");
    }

    #[test]
    fn display_pictures_are_premultiplied_and_have_no_layers() {
        let mut bytes = Cursor::new(Vec::new());
        let image = RgbaImage::from_pixel(1, 1, Rgba([255, 255, 0, 51]));
        image.write_to(&mut bytes, ImageFormat::Png).expect("memory takes everything");
        let picture = decode(bytes.get_ref(), None).expect("a picture");
        assert_eq!((picture.pixels[0], picture.scene_referred), (Vec4::new(0.2, 0.2, 0.0, 0.2), false));
        assert!(
            decode(bytes.get_ref(), Some("normal")).expect_err("no EXR").contains("only those have layers")
        );
    }

    #[test]
    fn what_is_not_a_number_is_refused() {
        let mut channels = PICTURE;
        channels[1].1[1] = f32::NAN;
        let refused = decode(&exr_file(&channels), None).expect_err("refused");
        assert!(refused.starts_with("1 of its pixels are not finite"), "{refused}");
        assert!(decode(&exr_file(&channels), Some("normal")).is_ok(), "another layer is sound");
    }
}
