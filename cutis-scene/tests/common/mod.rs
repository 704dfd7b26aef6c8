//! What the tests of the readers share: the shelf of assets, and small valid files to spoil.
#![allow(dead_code, reason = "each test program uses its own part")]
#![allow(clippy::unwrap_used, reason = "tests")]
#![allow(clippy::print_stderr, reason = "a skipped test must say so")]

pub mod refusal;

use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// The folder of shared assets, or `None` with a line on stderr. With `CUTIS_REQUIRE_ASSETS=1` a missing shelf fails.
pub fn shelf(test: &str) -> Option<PathBuf> {
    let given = std::env::var_os("CUTIS_ASSETS").filter(|value| !value.is_empty()).map(PathBuf::from);
    let usual = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/assets");
    let folder = given.unwrap_or_else(usual);
    if folder.is_dir() {
        return Some(folder);
    }
    let why = format!("the assets folder {} does not exist; set CUTIS_ASSETS", folder.display());
    assert!(std::env::var_os("CUTIS_REQUIRE_ASSETS").is_none_or(|v| v != "1"), "{test}: {why}");
    eprintln!("SKIPPED: {test}: {why}");
    None
}

/// A square of 100 mm as OBJ: two triangles after fanning, upright texture.
pub const SQUARE_OBJ: &str = "\
v 0 0 0\nv 100 0 0\nv 100 100 0\nv 0 100 0\n\
vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
f 1/1 2/2 3/3 4/4\n";

/// Writes a file and returns its path.
pub fn write(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

/// A GLB file under construction.
#[derive(Clone)]
pub struct Glb {
    /// The document.
    pub json: Value,
    /// The binary chunk.
    pub binary: Vec<u8>,
}

impl Glb {
    /// A square of one unit: 4 positions (view 0), 4 UVs (view 1), 6 indices of 16 bits (view 2).
    pub fn square() -> Self {
        let positions: [f32; 12] = [0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.];
        let uvs: [f32; 8] = [0., 1., 1., 1., 1., 0., 0., 0.];
        let indices: [u16; 6] = [0, 1, 2, 0, 2, 3];
        let mut binary: Vec<u8> = positions.iter().chain(&uvs).flat_map(|x| x.to_le_bytes()).collect();
        binary.extend(indices.iter().flat_map(|x| x.to_le_bytes()));
        let json = json!({
            "asset": { "version": "2.0" },
            "scene": 0,
            "scenes": [{ "nodes": [0] }],
            "nodes": [{ "mesh": 0 }],
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "indices": 2 }] }],
            "accessors": [
                { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3" },
                { "bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2" },
                { "bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR" }
            ],
            "bufferViews": [
                { "buffer": 0, "byteOffset": 0, "byteLength": 48 },
                { "buffer": 0, "byteOffset": 48, "byteLength": 32 },
                { "buffer": 0, "byteOffset": 80, "byteLength": 12 }
            ],
            "buffers": [{ "byteLength": 92 }]
        });
        Self { json, binary }
    }

    /// Adds bytes in a view of their own and returns its number.
    pub fn add_view(&mut self, bytes: &[u8]) -> usize {
        while !self.binary.len().is_multiple_of(4) {
            self.binary.push(0);
        }
        let offset = self.binary.len();
        self.binary.extend_from_slice(bytes);
        self.json["buffers"][0]["byteLength"] = json!(self.binary.len());
        let views = self.json["bufferViews"].as_array_mut().unwrap();
        views.push(json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }));
        views.len() - 1
    }

    /// Adds an accessor over bytes of its own and returns its number.
    pub fn add_accessor(&mut self, bytes: &[u8], component: u32, count: usize, kind: &str) -> usize {
        let view = self.add_view(bytes);
        let accessors = self.json["accessors"].as_array_mut().unwrap();
        accessors
            .push(json!({ "bufferView": view, "componentType": component, "count": count, "type": kind }));
        accessors.len() - 1
    }

    /// The file.
    pub fn bytes(&self) -> Vec<u8> {
        glb_from(self.json.to_string().into_bytes(), &self.binary)
    }
}

/// A GLB file from a JSON text and a binary chunk.
pub fn glb_from(mut json: Vec<u8>, binary: &[u8]) -> Vec<u8> {
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut binary = binary.to_vec();
    binary.resize(binary.len().next_multiple_of(4), 0);
    let mut bytes = b"glTF".to_vec();
    let words = |list: &[u32]| list.iter().flat_map(|w| w.to_le_bytes()).collect::<Vec<u8>>();
    bytes.extend(words(&[2, (28 + json.len() + binary.len()) as u32, json.len() as u32, 0x4e4f_534a]));
    bytes.extend(json);
    bytes.extend(words(&[binary.len() as u32, 0x004e_4942]));
    bytes.extend(binary);
    bytes
}

/// Bytes of floats.
pub fn floats(list: &[f32]) -> Vec<u8> {
    list.iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// A PNG of a few texels, all of one colour.
pub fn small_png() -> Vec<u8> {
    encode(
        image::DynamicImage::ImageRgba8(image::RgbaImage::from_pixel(4, 2, image::Rgba([200, 100, 50, 255]))),
        image::ImageFormat::Png,
    )
}

/// A JPEG of some texels that do not compress to nothing.
pub fn small_jpeg() -> Vec<u8> {
    let picture =
        image::RgbImage::from_fn(64, 64, |x, y| image::Rgb([(x * 37 % 256) as u8, (y * 91 % 256) as u8, 9]));
    encode(image::DynamicImage::ImageRgb8(picture), image::ImageFormat::Jpeg)
}

/// A picture in a file format.
pub fn encode(picture: image::DynamicImage, format: image::ImageFormat) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// Text with the alphabet and padding of RFC 4648.
pub fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for group in bytes.chunks(3) {
        let word = group.iter().fold(0u32, |w, &b| w << 8 | u32::from(b)) << (8 * (3 - group.len()));
        let digit = |i: usize| char::from(DIGITS[(word >> (18 - 6 * i) & 63) as usize]);
        (0..4).for_each(|i| text.push(if i <= group.len() { digit(i) } else { '=' }));
    }
    text
}
