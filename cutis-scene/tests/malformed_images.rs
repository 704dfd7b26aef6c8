//! Spoiled PNG, JPEG, EXR and HDR files.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::refusal::refuse_all;
use common::{encode, small_jpeg, small_png};
use image::{DynamicImage, ImageFormat};

/// An empty PNG file whose header claims a size.
fn png_header(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec();
    bytes.extend(width.to_be_bytes());
    bytes.extend(height.to_be_bytes());
    bytes.extend([8, 6, 0, 0, 0]);
    let checksum = crc32(&bytes[12..]);
    bytes.extend(checksum.to_be_bytes());
    // The decoder looks for the beginning of the data.
    bytes.extend(b"\0\0\0\0IDAT");
    bytes.extend(crc32(b"IDAT").to_be_bytes());
    bytes
}

/// The checksum of PNG chunks (ISO 3309), bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
    !bytes.iter().fold(!0u32, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), |crc, _| step(crc)))
}

fn small_exr() -> Vec<u8> {
    let picture = image::Rgb32FImage::from_fn(16, 16, |x, y| image::Rgb([x as f32, y as f32, 0.3]));
    encode(DynamicImage::ImageRgb32F(picture), ImageFormat::OpenExr)
}

/// An EXR file with the value of an attribute overwritten from some byte on.
fn exr_with(attribute: &str, skip: usize, value: &[u8]) -> Vec<u8> {
    let mut bytes = small_exr();
    let name = [attribute.as_bytes(), b"\0"].concat();
    let start = bytes.windows(name.len()).position(|w| w == name).unwrap() + name.len();
    let type_end = start + bytes[start..].iter().position(|&b| b == 0).unwrap() + 1;
    let at = type_end + 4 + skip;
    bytes[at..at + value.len()].copy_from_slice(value);
    bytes
}

fn hdr(dimensions: &str) -> Vec<u8> {
    format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n{dimensions}\n").into_bytes()
}

#[test]
fn images() {
    let (png, jpeg, exr) = (small_png(), small_jpeg(), small_exr());
    let corner = |x: i32, y: i32| [x.to_le_bytes(), y.to_le_bytes()].concat();
    refuse_all(vec![
        ("empty.png", vec![], "is empty"),
        ("text.png", b"hello".to_vec(), "none of PNG, JPEG, OpenEXR and Radiance"),
        ("bmp.png", b"BM______________".to_vec(), "none of PNG"),
        ("magic.png", png[..8].to_vec(), "image"),
        ("half.png", png[..png.len() - 30].to_vec(), "image"),
        ("zero.png", png_header(0, 5), "image"),
        ("huge.png", png_header(60_000, 60_000), "60000"),
        ("largest.png", png_header(0x7fff_ffff, 0x7fff_ffff), "image"),
        ("bomb.png", png_header(16_000, 8_000), "but the file has only"),
        (
            "checksum.png",
            {
                let mut b = png.clone();
                b[20] ^= 1;
                b
            },
            "image",
        ),
        ("magic.jpg", vec![0xff, 0xd8], "is cut off"),
        ("half.jpg", jpeg[..jpeg.len() / 2].to_vec(), "is cut off"),
        ("tail.jpg", jpeg[..jpeg.len() - 2].to_vec(), "is cut off"),
        ("nothing.jpg", vec![0xff, 0xd8, 0xff, 0xd9], "image"),
        ("segment.jpg", vec![0xff, 0xd8, 0xff, 0xe0, 0, 0, 0xff, 0xd9], "without a length"),
        ("no-marker.jpg", vec![0xff, 0xd8, 0x12, 0x34], "marker is expected"),
        ("huge.jpg", jpeg_claiming(60_000, 60_000), "60000 × 60000"),
        ("zero.jpg", jpeg_claiming(0, 0), "image"),
        ("magic.exr", exr[..4].to_vec(), "image"),
        ("half.exr", exr[..exr.len() / 2].to_vec(), "image"),
        ("huge.exr", exr_with("dataWindow", 8, &corner(59_999, 59_999)), "60000 × 60000"),
        ("bomb.exr", exr_with("dataWindow", 8, &corner(9_999, 9_999)), "image"),
        ("inside-out.exr", exr_with("dataWindow", 8, &corner(-5, -5)), "image"),
        ("far.exr", exr_with("dataWindow", 0, &corner(i32::MIN, i32::MIN)), "image"),
        ("dwaa.exr", exr_with("compression", 0, &[8]), "DWAA or DWAB"),
        ("dwab.exr", exr_with("compression", 0, &[9]), "DWAA or DWAB"),
        ("no-code.exr", exr_with("compression", 0, &[99]), "image"),
        ("no-colours.exr", exr_with("channels", 0, b"A"), "has no channels R, G, B and no Y"),
        ("magic.hdr", b"#?RADIANCE".to_vec(), "image"),
        ("huge.hdr", hdr("-Y 60000 +X 60000"), "60000 × 60000"),
        ("overflow.hdr", hdr("-Y 4294967295 +X 4294967295"), "4294967295"),
        ("bomb.hdr", hdr("-Y 8000 +X 8000"), "but the file has only"),
        ("zero.hdr", hdr("-Y 0 +X 8"), "at least one"),
        ("letters.hdr", hdr("-Y four +X 8"), "image"),
        ("half.hdr", [hdr("-Y 8 +X 8"), vec![2, 2, 0, 8, 130]].concat(), "image"),
    ]);
}

/// A JPEG whose frame header claims a size.
fn jpeg_claiming(width: u16, height: u16) -> Vec<u8> {
    let mut bytes = small_jpeg();
    let frame = bytes.windows(2).position(|w| w == [0xff, 0xc0]).unwrap();
    bytes[frame + 5..frame + 7].copy_from_slice(&height.to_be_bytes());
    bytes[frame + 7..frame + 9].copy_from_slice(&width.to_be_bytes());
    bytes
}
