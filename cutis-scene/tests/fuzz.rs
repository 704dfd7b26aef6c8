//! Random and randomly spoiled files: any answer will do, but no panic and no hang.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{Glb, SQUARE_OBJ, encode, small_jpeg, small_png, write};
use cutis_scene::{ColourSpace, ReadOptions, read_image, read_scene};
use image::{DynamicImage, ImageFormat};
use proptest::prelude::*;
use serde_json::json;

/// Bytes to put at places of a file; places are fractions of its length.
fn spoilings() -> impl Strategy<Value = Vec<(f64, u8)>> {
    prop::collection::vec((0.0..1.0f64, any::<u8>()), 1..8)
}

fn spoiled(mut bytes: Vec<u8>, spoilings: &[(f64, u8)], keep: f64) -> Vec<u8> {
    for (place, byte) in spoilings {
        let at = (place * bytes.len() as f64) as usize;
        bytes[at] = *byte;
    }
    // Now and then the end is cut off.
    bytes.truncate((bytes.len() as f64 * keep.max(0.5) * 1.25) as usize);
    bytes
}

/// Reads bytes under a name; whatever comes back is fine if its message is one line.
fn survive(name: &str, bytes: &[u8]) {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), name, bytes);
    write(folder.path(), "square.obj", SQUARE_OBJ);
    let error = if ["obj", "glb", "gltf", "toml"].iter().any(|e| name.ends_with(e)) {
        read_scene(&path, &ReadOptions::default()).err()
    } else {
        read_image(&path, ColourSpace::Colour, &mut Vec::new()).err()
    };
    assert!(error.is_none_or(|error| !error.to_string().contains('\n')));
}

fn rich_glb() -> Glb {
    let mut glb = Glb::square();
    let view = glb.add_view(&small_png());
    glb.json["images"] = json!([{ "bufferView": view, "mimeType": "image/png" }]);
    glb.json["textures"] = json!([{ "source": 0 }]);
    glb.json["materials"] = json!([{ "normalTexture": { "index": 0 } }]);
    glb.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    let joints = glb.add_accessor(&[0, 0, 0, 0].repeat(4), 5121, 4, "VEC4");
    glb.json["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] = json!(joints);
    glb.json["skins"] = json!([{ "joints": [0] }]);
    glb.json["nodes"][0]["rotation"] = json!([0.0, 0.0, 0.0, 1.0]);
    glb
}

fn float_picture(format: ImageFormat) -> Vec<u8> {
    let picture = image::Rgb32FImage::from_fn(24, 9, |x, y| image::Rgb([x as f32, y as f32, 0.3]));
    encode(DynamicImage::ImageRgb32F(picture), format)
}

const SCENE: &str = "[mesh]\npath = \"square.obj\"\n[material]\nroughness = 0.3\nalbedo = [1, 1, 0.5]\n\
    [[light]]\nkind = \"point\"\nposition_mm = [1, 2, 3]\n[camera]\nyaw_degrees = 20\n";

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn noise_is_survived(bytes in prop::collection::vec(any::<u8>(), 0..300), name in 0..8usize) {
        let names = ["a.obj", "a.glb", "a.gltf", "a.toml", "a.png", "a.jpg", "a.exr", "a.hdr"];
        survive(names[name], &bytes);
        // With the right first bytes the decoders see it too.
        let magics: [&[u8]; 8] =
            [b"f ", b"glTF\x02\0\0\0", b"{", b"[mesh]", b"\x89PNG\r\n\x1a\n", b"\xff\xd8", b"v/1\x01\x02\0\0\0", b"#?RADIANCE\n"];
        survive(names[name], &[magics[name], &bytes].concat());
    }

    #[test]
    fn spoiled_meshes_are_survived(spoilings in spoilings(), keep in 0.0..1.0f64) {
        survive("a.obj", &spoiled(SQUARE_OBJ.as_bytes().to_vec(), &spoilings, keep));
        survive("a.glb", &spoiled(rich_glb().bytes(), &spoilings, keep));
        survive("a.gltf", &spoiled(rich_glb().json.to_string().into_bytes(), &spoilings, keep));
    }

    #[test]
    fn spoiled_numbers_in_a_valid_document_are_survived(numbers in prop::collection::vec((any::<u16>(), 0..400i64), 1..4)) {
        let mut glb = rich_glb();
        for (place, value) in numbers {
            let mut slots = Vec::new();
            collect_numbers(&mut glb.json, &mut slots);
            let slot = usize::from(place) % slots.len();
            *slots[slot] = json!(value - 5);
        }
        survive("a.glb", &glb.bytes());
    }

    #[test]
    fn spoiled_vertices_are_survived(floats in prop::collection::vec((0..20usize, any::<f32>()), 1..6)) {
        let mut glb = Glb::square();
        for (i, value) in floats {
            glb.binary[4 * i..4 * i + 4].copy_from_slice(&value.to_le_bytes());
        }
        survive("a.glb", &glb.bytes());
    }

    #[test]
    fn spoiled_images_are_survived(spoilings in spoilings(), keep in 0.0..1.0f64) {
        survive("a.png", &spoiled(small_png(), &spoilings, keep));
        survive("a.jpg", &spoiled(small_jpeg(), &spoilings, keep));
        survive("a.exr", &spoiled(float_picture(ImageFormat::OpenExr), &spoilings, keep));
        survive("a.hdr", &spoiled(float_picture(ImageFormat::Hdr), &spoilings, keep));
    }

    #[test]
    fn spoiled_scene_files_are_survived(spoilings in spoilings(), keep in 0.0..1.0f64) {
        survive("a.toml", &spoiled(SCENE.as_bytes().to_vec(), &spoilings, keep));
    }
}

/// Every number of a document.
fn collect_numbers<'a>(value: &'a mut serde_json::Value, found: &mut Vec<&'a mut serde_json::Value>) {
    match value {
        serde_json::Value::Array(list) => list.iter_mut().for_each(|item| collect_numbers(item, found)),
        serde_json::Value::Object(map) => map.values_mut().for_each(|item| collect_numbers(item, found)),
        serde_json::Value::Number(_) => found.push(value),
        _ => {}
    }
}
