//! Spoiled OBJ, GLB and glTF files.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::refusal::refuse_all;
use common::{Glb, SQUARE_OBJ, base64, floats, glb_from, small_png};
use serde_json::{Value, json};

/// OBJ text with something after the valid square.
fn obj(extra: &str) -> Vec<u8> {
    format!("{SQUARE_OBJ}{extra}\n").into_bytes()
}

#[test]
fn obj_files() {
    refuse_all(vec![
        ("empty.obj", vec![], "holds no faces"),
        ("noise.obj", vec![0, 255, 7, 10, 200], "holds no faces"),
        ("zero.obj", obj("f 0/1 1/1 2/1"), "line 10: `v` 0 does not exist"),
        ("past-end.obj", obj("f 1/1 2/2 5/1"), "line 10: `v` 5 does not exist: 4 are defined"),
        ("uv-past-end.obj", obj("f 1/1 2/2 3/9"), "`vt` 9 does not exist"),
        ("normal-past-end.obj", obj("f 1/1/1 2/2/1 3/3/1"), "`vn` 1 does not exist: 0 are defined"),
        ("negative.obj", obj("f -5/1 2/2 3/3"), "`v` -5 does not exist"),
        ("huge-number.obj", obj("f 99999999999999999999/1 2/2 3/3"), "not the number of a `v`"),
        ("least-number.obj", obj("f -9223372036854775808/1 2/2 3/3"), "does not exist"),
        ("two-corners.obj", obj("f 1/1 2/2"), "this one has 2"),
        ("empty-face.obj", obj("f"), "this one has 0"),
        ("letters.obj", obj("v 1 two 3"), "line 10: `two` is not a finite number"),
        ("nan.obj", obj("v nan 0 0"), "`nan` is not a finite number"),
        ("infinite.obj", obj("v 1 2 1e99"), "`1e99` is not a finite number"),
        ("short.obj", obj("v 1 2"), "3 numbers are needed, found 2"),
        ("short-uv.obj", obj("vt"), "1 numbers are needed, found 0"),
        ("latin.obj", [b"v 0 0 \xe9\n".as_slice(), &obj("")].concat(), "line 1: is not text in UTF-8"),
        ("flat.obj", b"v 0 0 0\nvt 0 0\nf 1/1 1/1 1/1\n".to_vec(), "no triangle of the mesh has an area"),
        ("far.obj", SQUARE_OBJ.replace("v 0 0 0\n", "v 3e38 0 0\n").into_bytes(), "no triangle"),
        ("wild-uv.obj", SQUARE_OBJ.replace("vt 0 0\n", "vt 1e30 0\n").into_bytes(), "texture coordinates"),
        ("slashes.obj", obj("f / / /"), "not the number of a `v`"),
        ("unknown.fbx", b"Kaydara".to_vec(), "`.fbx` is not known"),
    ]);
}

/// The square as GLB after a change of its document.
fn glb(change: impl FnOnce(&mut Glb)) -> Vec<u8> {
    let mut glb = Glb::square();
    change(&mut glb);
    glb.bytes()
}

/// The square as GLB with one value of the document replaced.
fn with(pointer: &str, value: Value) -> Vec<u8> {
    glb(|glb| {
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        let parent = glb.json.pointer_mut(parent).unwrap();
        match parent {
            Value::Array(list) => list[key.parse::<usize>().unwrap()] = value,
            parent => parent[key] = value,
        }
    })
}

/// Bytes with a little-endian word replaced.
fn with_word(mut bytes: Vec<u8>, at: usize, word: u32) -> Vec<u8> {
    bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
    bytes
}

#[test]
fn glb_containers() {
    let good = Glb::square().bytes();
    let json_length = u32::from_le_bytes(good[12..16].try_into().unwrap()) as usize;
    refuse_all(vec![
        ("empty.glb", vec![], "is empty"),
        ("magic.glb", b"gltf____________".to_vec(), "byte 0: begins neither"),
        ("only-magic.glb", b"glTF".to_vec(), "byte 4: the file ends here"),
        ("version.glb", with_word(good.clone(), 4, 1), "GLB version 1"),
        ("half.glb", good[..good.len() / 2].to_vec(), "byte 8: the header claims"),
        ("four-gigabytes.glb", with_word(good.clone(), 8, u32::MAX), "claims 4294967295 bytes"),
        ("json-chunk.glb", with_word(good.clone(), 12, u32::MAX), "byte 12: a chunk claims 4294967295"),
        ("binary-chunk.glb", with_word(good.clone(), 20 + json_length, 0x7fff_ffff), "a chunk claims"),
        ("no-json.glb", with_word(good.clone(), 16, 0x004e_4942), "no JSON chunk"),
        ("cut-chunk.glb", with_word(good.clone(), 8, 16), "byte 12: a chunk claims"),
        ("bad-json.glb", glb_from(b"{\"asset\": nonsense".to_vec(), &[]), "JSON line 1, column"),
        ("nested.glb", glb_from([vec![b'['; 100_000], b"{".to_vec()].concat(), &[]), "JSON line 1"),
        ("deep-extension.glb", glb_from(deep_extension(), &[]), "recursion limit"),
        ("noise.gltf", b"{\x00\x01\xff".to_vec(), "JSON line 1"),
        (
            "other-version.gltf",
            json!({ "asset": { "version": "1.0" } }).to_string().into_bytes(),
            "asset.version",
        ),
        ("nothing.gltf", json!({ "asset": { "version": "2.0" } }).to_string().into_bytes(), "shows no mesh"),
    ]);
}

/// A document with an unknown extension that is nested a hundred thousand deep.
fn deep_extension() -> Vec<u8> {
    let depth = 100_000;
    format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"extensions\":{{\"x\":{}{}}}}}",
        "[".repeat(depth),
        "]".repeat(depth)
    )
    .into_bytes()
}

#[test]
fn gltf_numbers_and_ranges() {
    refuse_all(vec![
        ("count.glb", with("/accessors/0/count", json!(5)), "accessors[0]: 5 elements from byte 0 lie past"),
        ("huge-count.glb", with("/accessors/0/count", json!(4_000_000_000u64)), "4000000000 vertices"),
        ("index-count.glb", with("/accessors/2/count", json!(u64::MAX)), "accessors[2]"),
        ("zero-count.glb", with("/accessors/0/count", json!(0)), "0 vertices"),
        ("negative-count.glb", with("/accessors/0/count", json!(-4)), "invalid value"),
        ("offset.glb", with("/accessors/1/byteOffset", json!(16)), "lie past the end of their bufferView"),
        ("overflow.glb", with("/accessors/1/byteOffset", json!(u64::MAX)), "lie past the end"),
        ("stride.glb", with("/bufferViews/0/byteStride", json!(4)), "byteStride 4"),
        ("huge-stride.glb", with("/bufferViews/0/byteStride", json!(100_000)), "byteStride 100000"),
        ("view.glb", with("/bufferViews/2/byteLength", json!(1000)), "bufferViews[2]: 1000 bytes from 80"),
        ("view-overflow.glb", with("/bufferViews/2/byteOffset", json!(u64::MAX)), "bufferViews[2]"),
        ("no-view.glb", with("/accessors/0/bufferView", json!(9)), "names bufferViews[9]"),
        ("no-buffer.glb", with("/bufferViews/0/buffer", json!(3)), "names buffers[3]"),
        ("buffer.glb", with("/buffers/0/byteLength", json!(4_000_000_000u64)), "claims 4000000000 bytes"),
        ("component.glb", with("/accessors/0/componentType", json!(5123)), "componentType U16 does not fit"),
        ("unknown-component.glb", with("/accessors/0/componentType", json!(1)), "unknown componentType"),
        ("float-indices.glb", with("/accessors/2/componentType", json!(5126)), "componentType F32"),
        ("type.glb", with("/accessors/0/type", json!("VEC2")), "has 2 components, 3 are needed"),
        ("unknown-type.glb", with("/accessors/0/type", json!("VEC9")), "type that is not used"),
        ("nan.glb", glb(|g| g.binary[0..4].copy_from_slice(&f32::NAN.to_le_bytes())), "vertex 0 lies at"),
        (
            "infinite.glb",
            glb(|g| g.binary[4..8].copy_from_slice(&f32::INFINITY.to_le_bytes())),
            "vertex 0 lies at",
        ),
        (
            "nan-uv.glb",
            glb(|g| g.binary[48..52].copy_from_slice(&f32::NAN.to_le_bytes())),
            "texture coordinates",
        ),
        ("index.glb", glb(|g| g.binary[80] = 200), "an index names vertex 200"),
        ("no-accessor.glb", with("/meshes/0/primitives/0/indices", json!(77)), "names accessors[77]"),
        (
            "no-positions.glb",
            with("/meshes/0/primitives/0/attributes", json!({ "TEXCOORD_0": 1 })),
            "no POSITION",
        ),
        (
            "far-positions.glb",
            with("/meshes/0/primitives/0/attributes/POSITION", json!(99)),
            "names number 99",
        ),
        ("few-uvs.glb", with("/accessors/1/count", json!(3)), "3 elements for 4 vertices"),
        ("mode.glb", with("/meshes/0/primitives/0/mode", json!(99)), "unknown mode"),
        ("points.glb", with("/meshes/0/primitives/0/mode", json!(0)), "shows no mesh"),
        ("thirds.glb", with("/accessors/2/count", json!(5)), "whole triangles"),
        ("sparse-index.glb", sparse(4, 1), "replaces element 4 of 4"),
        ("sparse-count.glb", sparse(0, 5), "has 5 of 4 elements"),
        ("sparse-huge.glb", sparse(0, u64::MAX), "sparse"),
        (
            "no-views-at-all.glb",
            glb(|g| drop(g.json["accessors"][0].as_object_mut().unwrap().remove("bufferView"))),
            "bufferView",
        ),
    ]);
}

/// The square with a sparse accessor that replaces `count` elements beginning at `index`.
fn sparse(index: u8, count: u64) -> Vec<u8> {
    glb(|glb| {
        let at = glb.add_view(&[index]);
        let to = glb.add_view(&floats(&[1.0; 3]));
        glb.json["accessors"][0]["sparse"] = json!({
            "count": count,
            "indices": { "bufferView": at, "componentType": 5121 },
            "values": { "bufferView": to }
        });
    })
}

#[test]
fn gltf_hierarchies() {
    let node = |i: usize| json!({ "children": [i + 1] });
    let deep: Vec<Value> = (0..50_000).map(node).chain([json!({ "mesh": 0 })]).collect();
    let ring = json!([{ "mesh": 0 }, { "children": [2] }, { "children": [3] }, { "children": [1] }]);
    let many: Vec<Value> = vec![json!({}); 200_001];
    let diamond = json!([{ "children": [1, 2] }, { "children": [3] }, { "children": [3] }, { "mesh": 0 }]);
    refuse_all(vec![
        ("self.glb", with("/nodes/0/children", json!([0])), "circle"),
        ("ring.glb", with("/nodes", ring), "circle"),
        ("two-parents.glb", with("/nodes", diamond), "nodes[3]: has two parents"),
        ("deep.glb", with("/nodes", Value::Array(deep)), "nested deeper than 1000"),
        ("many.glb", with("/nodes", Value::Array(many)), "there are 200001"),
        ("no-child.glb", with("/nodes/0/children", json!([5])), "names node 5, but there are 1"),
        ("no-node.glb", with("/scenes/0/nodes", json!([5])), "names node 5"),
        ("no-scene.glb", with("/scene", json!(5)), "scene: names number 5"),
        ("no-mesh.glb", with("/nodes/0/mesh", json!(5)), "nodes[0].mesh: names number 5"),
        ("nan-matrix.glb", with("/nodes/0/scale", json!([3e38, 1, 1])), "transform is not finite"),
        ("far-away.glb", with("/nodes/0/translation", json!([1e30, 0, 0])), "below 1e9 mm"),
        ("no-skin.glb", with("/nodes/0/skin", json!(0)), "nodes[0].skin"),
        ("no-joints.glb", skinned(json!([{ "joints": [] }]), 0, 1.0), "skins[0]: has 0 joints"),
        ("far-joint.glb", skinned(json!([{ "joints": [9] }]), 0, 1.0), "names node 9"),
        (
            "vertex-joint.glb",
            skinned(json!([{ "joints": [0] }]), 7, 1.0),
            "names joint 7, but the skin has 1",
        ),
        ("weight.glb", skinned(json!([{ "joints": [0] }]), 0, f32::NAN), "has the weight NaN"),
        (
            "few-matrices.glb",
            skinned(json!([{ "joints": [0], "inverseBindMatrices": 0 }]), 0, 1.0),
            "16 are needed",
        ),
        ("bomb.glb", instances(), "more than 10000000 vertices"),
    ]);
}

/// The square with a skin, all vertices at one joint.
fn skinned(skins: Value, joint: u8, weight: f32) -> Vec<u8> {
    glb(|glb| {
        let joints = glb.add_accessor(&[joint, 0, 0, 0].repeat(4), 5121, 4, "VEC4");
        let weights = glb.add_accessor(&floats(&[weight, 0., 0., 0.].repeat(4)), 5126, 4, "VEC4");
        let attributes = &mut glb.json["meshes"][0]["primitives"][0]["attributes"];
        attributes["JOINTS_0"] = json!(joints);
        attributes["WEIGHTS_0"] = json!(weights);
        glb.json["nodes"][0]["skin"] = json!(0);
        glb.json["skins"] = skins;
    })
}

/// A hundred nodes that each show the same mesh of 120,000 vertices: small to store, large to build.
fn instances() -> Vec<u8> {
    glb(|glb| {
        let corners: Vec<f32> =
            (0..120_000).flat_map(|i| [i as f32, (i % 7) as f32, (i % 3) as f32]).collect();
        let positions = glb.add_accessor(&floats(&corners), 5126, 120_000, "VEC3");
        let uvs = glb.add_accessor(&floats(&vec![0.5; 240_000]), 5126, 120_000, "VEC2");
        glb.json["meshes"][0]["primitives"] =
            json!([{ "attributes": { "POSITION": positions, "TEXCOORD_0": uvs } }]);
        glb.json["nodes"] = json!(vec![json!({ "mesh": 0 }); 100]);
        glb.json["scenes"][0]["nodes"] = json!((0..100).collect::<Vec<_>>());
    })
}

#[test]
fn gltf_references() {
    let textured = |image: Value| {
        glb(|glb| {
            glb.json["images"] = json!([image]);
            glb.json["textures"] = json!([{ "source": 0 }]);
            glb.json["materials"] =
                json!([{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }]);
            glb.json["meshes"][0]["primitives"][0]["material"] = json!(0);
        })
    };
    let light = |light: Value| {
        glb(|glb| {
            glb.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [light] } });
            glb.json["nodes"][0]["extensions"] = json!({ "KHR_lights_punctual": { "light": 0 } });
        })
    };
    let camera = |yfov: f32| {
        glb(|glb| {
            glb.json["cameras"] =
                json!([{ "type": "perspective", "perspective": { "yfov": yfov, "znear": 1.0 } }]);
            glb.json["nodes"][0]["camera"] = json!(0);
        })
    };
    let uri = |uri: &str| with("/buffers/0/uri", json!(uri));
    let broken_png = format!("data:image/png;base64,{}", base64(&small_png()[..40]));
    refuse_all(vec![
        ("garbage-uri.glb", uri("data:garbage"), "buffers[0].uri: the data URI has no comma"),
        ("not-base64.glb", uri("data:;base64,@@@@"), "not base64 at character 0"),
        ("short-data.glb", uri("data:;base64,AAAA"), "claims 92 bytes, but 3 are there"),
        ("http.glb", uri("https://example.org/a.bin"), "`https:` is not supported"),
        ("climb.glb", uri("../../etc/passwd"), "leads out of"),
        ("encoded-climb.glb", uri("%2e%2e/%2e%2e/etc/passwd"), "leads out of"),
        ("absolute.glb", uri("/etc/passwd"), "leads out of"),
        ("missing.glb", uri("missing.bin"), "cannot be opened"),
        ("percent.glb", uri("%zz"), "not a valid URI"),
        ("material.glb", with("/meshes/0/primitives/0/material", json!(4)), "materials[4]: names number 4"),
        (
            "missing-image.glb",
            textured(json!({ "uri": "missing.png" })),
            "images[0]: `missing.png` cannot be opened",
        ),
        (
            "image-view.glb",
            textured(json!({ "bufferView": 44, "mimeType": "image/png" })),
            "names bufferViews[44]",
        ),
        (
            "image-bytes.glb",
            textured(json!({ "bufferView": 0, "mimeType": "image/png" })),
            "none of PNG, JPEG",
        ),
        ("image-nothing.glb", textured(json!({})), "neither a uri nor a bufferView"),
        ("broken-image.glb", textured(json!({ "uri": broken_png })), "images[0]"),
        ("light.glb", light(json!({ "type": "neon" })), "unknown type"),
        ("dark-light.glb", light(json!({ "type": "point", "intensity": -1.0 })), "not negative"),
        ("spot.glb", light(json!({ "type": "spot" })), "spot without"),
        ("cones.glb", light(json!({ "type": "spot", "spot": { "innerConeAngle": 2.0 } })), "cone angles"),
        (
            "far-light.glb",
            with("/nodes/0/extensions", json!({ "KHR_lights_punctual": { "light": 3 } })),
            "names number 3",
        ),
        ("flat-camera.glb", camera(0.0), "cameras[0].perspective.yfov"),
        ("wide-camera.glb", camera(std::f32::consts::PI), "yfov"),
        ("far-camera.glb", with("/nodes/0/camera", json!(3)), "nodes[0].camera: names number 3"),
        ("draco.glb", with("/extensionsRequired", json!(["KHR_draco_mesh_compression"])), "not supported"),
    ]);
}
