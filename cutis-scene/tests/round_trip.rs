//! Small files written here come back as they were.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{Glb, SQUARE_OBJ, base64, encode, floats, small_png, write};
use cutis_scene::{ColourSpace, Light, ReadOptions, Scene, Texels, read_image, read_scene};
use glam::{Vec2, Vec3};
use image::{DynamicImage, ImageFormat};
use serde_json::json;
use std::path::Path;

fn read(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) -> Scene {
    read_scene(&write(folder, name, bytes), &in_mm(1.0)).unwrap()
}

fn in_mm(mm: f32) -> ReadOptions {
    ReadOptions { millimetres_per_unit: Some(mm), ..ReadOptions::default() }
}

fn says(scene: &Scene, words: &str) -> bool {
    scene.warnings.iter().any(|warning| warning.contains(words))
}

#[test]
fn an_obj_square_comes_back_with_its_image_upright() {
    let folder = tempfile::tempdir().unwrap();
    let scene = read(folder.path(), "square.obj", SQUARE_OBJ);
    let mesh = &scene.objects[0].mesh;
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(mesh.positions_mm[2], Vec3::new(100.0, 100.0, 0.0));
    // The upper edge of the square shows the first row of the image.
    assert_eq!(mesh.uvs, [Vec2::new(0., 1.), Vec2::ONE, Vec2::new(1., 0.), Vec2::ZERO]);
    assert!(mesh.normals.iter().all(|n| (*n - Vec3::Z).length() < 1e-6));
    assert!(!scene.objects[0].closed && scene.objects[0].charts.count == 1);
}

#[test]
fn flip_v_leaves_the_obj_coordinates_as_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "square.obj", SQUARE_OBJ);
    let scene = read_scene(&path, &ReadOptions { flip_v: true, ..in_mm(1.0) }).unwrap();
    assert_eq!(scene.objects[0].mesh.uvs[0], Vec2::ZERO);
}

#[test]
fn obj_details_negative_numbers_comments_joined_lines_normals_and_materials() {
    let folder = tempfile::tempdir().unwrap();
    let text = "# caf\u{e9}\r\nmtllib nothing.mtl\r\nv 0 0 0 1.0\r\nv 1 0 0\r\nv 0 1 0 # corner\r\nv 0 0 1\r\n\
        vt 0 0\r\nvt .5 0\r\nvt 0 .5\r\nvn 0 0 2\r\nusemtl front\r\nf -4/-3/1 -3/-2/1 \\\r\n-2/-1/1\r\n\
        usemtl side\r\nf 1/1/1 3/3/1 4/2/1\r\nusemtl front\r\n";
    let scene = read(folder.path(), "two.obj", text);
    let names: Vec<_> = scene.objects.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["front", "side"]);
    assert_eq!(scene.objects[0].mesh.normals, [Vec3::Z; 3]);
    assert_eq!(scene.objects[1].mesh.positions_mm[2], Vec3::Z);
}

#[test]
fn an_obj_without_a_size_becomes_a_head_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "square.obj", SQUARE_OBJ);
    let scene = read_scene(&path, &ReadOptions::default()).unwrap();
    let [lo, hi] = scene.bounds_mm().unwrap();
    assert!(((hi - lo).max_element() - 250.0).abs() < 1e-3);
    assert!(says(&scene, "assumed 250 mm"), "{:?}", scene.warnings);
}

#[test]
fn a_bare_mesh_gets_light_and_a_camera_that_sees_it() {
    let folder = tempfile::tempdir().unwrap();
    let scene = read(folder.path(), "square.obj", SQUARE_OBJ);
    assert!(scene.lights.len() == 2 && scene.environment.is_some());
    assert!(says(&scene, "no lights were given"), "{:?}", scene.warnings);
    assert_eq!(scene.camera.look_at_mm, Vec3::new(50.0, 50.0, 0.0));
    assert!(scene.camera.position_mm.z > 100.0);
}

#[test]
fn degenerate_triangles_are_left_out_with_their_number() {
    let folder = tempfile::tempdir().unwrap();
    let scene = read(folder.path(), "flat.obj", format!("{SQUARE_OBJ}f 1/1 1/1 2/2\nf 1/1 2/2 1/1\n"));
    assert_eq!(scene.objects[0].mesh.triangles.len(), 2);
    assert!(says(&scene, "2 of 4 triangles"), "{:?}", scene.warnings);
}

#[test]
fn overlap_and_coordinates_outside_the_square_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let twice = SQUARE_OBJ.replace("f 1", "v 0 0 9\nv 100 0 9\nv 100 100 9\nf 5/1 6/2 7/3\nf 1");
    assert!(says(&read(folder.path(), "twice.obj", twice), "more than one place"));
    let tiled = SQUARE_OBJ.replace("vt 1 1", "vt 3 3");
    assert!(says(&read(folder.path(), "tiled.obj", tiled), "leave the unit square"));
    let udim = SQUARE_OBJ.replace("vt 0 ", "vt 2 ").replace("vt 1 ", "vt 3 ");
    let scene = read(folder.path(), "udim.obj", udim);
    assert!(says(&scene, "moved back"), "{:?}", scene.warnings);
    assert_eq!(scene.objects[0].mesh.in_atlas()[0], Vec2::new(0.0, 1.0));
}

#[test]
fn a_glb_square_comes_back_in_millimetres() {
    let folder = tempfile::tempdir().unwrap();
    let mut glb = Glb::square();
    glb.json["nodes"][0]["translation"] = json!([0.0, 0.0, 2.0]);
    glb.json["nodes"][0]["scale"] = json!([0.1, 0.1, 0.1]);
    let path = write(folder.path(), "square.glb", glb.bytes());
    let scene = read_scene(&path, &ReadOptions::default()).unwrap();
    let mesh = &scene.objects[0].mesh;
    let corner = mesh.positions_mm[2];
    // Two products and a sum of numbers near 2000: 4 roundings.
    assert!((corner - Vec3::new(100.0, 100.0, 2000.0)).length() < 4.0 * 2000.0 * f32::EPSILON, "{corner}");
    assert_eq!(mesh.uvs[2], Vec2::new(1.0, 0.0));
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn the_same_document_with_data_uri_or_external_buffer_is_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let mut glb = Glb::square();
    glb.json["buffers"][0]["uri"] = json!("my%20buffer.bin");
    write(folder.path(), "my buffer.bin", &glb.binary);
    let external = read(folder.path(), "external.gltf", glb.json.to_string());
    let uri = format!("data:application/octet-stream;base64,{}", base64(&glb.binary));
    glb.json["buffers"][0]["uri"] = json!(uri);
    let embedded = read(folder.path(), "embedded.gltf", glb.json.to_string());
    for scene in [&external, &embedded] {
        assert_eq!(scene.objects[0].mesh.positions_mm[2], Vec3::new(1.0, 1.0, 0.0));
    }
}

#[test]
fn a_mirrored_node_is_turned_outside_out() {
    let folder = tempfile::tempdir().unwrap();
    let mut glb = Glb::square();
    glb.json["nodes"][0]["scale"] = json!([-1.0, 1.0, 1.0]);
    let normals = glb.add_accessor(&floats(&[0., 0., 1.].repeat(4)), 5126, 4, "VEC3");
    glb.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(normals);
    let scene = read(folder.path(), "mirror.glb", glb.bytes());
    let object = &scene.objects[0];
    let [a, b, c] = object.mesh.corners_mm(0);
    assert!((b - a).cross(c - a).normalize().dot(object.mesh.normals[0]) > 0.99);
    assert_eq!(object.mesh.normals[0], Vec3::Z);
}

#[test]
fn a_sparse_accessor_moves_one_vertex() {
    let folder = tempfile::tempdir().unwrap();
    let mut glb = Glb::square();
    let at = glb.add_view(&[2, 0]);
    let to = glb.add_view(&floats(&[1.0, 1.0, 0.5]));
    glb.json["accessors"][0]["sparse"] = json!({
        "count": 1,
        "indices": { "bufferView": at, "componentType": 5123 },
        "values": { "bufferView": to }
    });
    let scene = read(folder.path(), "sparse.glb", glb.bytes());
    assert_eq!(scene.objects[0].mesh.positions_mm[2], Vec3::new(1.0, 1.0, 0.5));
    assert_eq!(scene.objects[0].mesh.positions_mm[1], Vec3::X);
}

#[test]
fn a_skin_puts_vertices_where_their_joints_rest() {
    let folder = tempfile::tempdir().unwrap();
    let mut glb = Glb::square();
    let joints = glb.add_accessor(&[0, 1, 0, 0].repeat(4), 5121, 4, "VEC4");
    let weights = glb.add_accessor(&floats(&[0.25, 0.75, 0.0, 0.0].repeat(4)), 5126, 4, "VEC4");
    let attributes = &mut glb.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = json!(joints);
    attributes["WEIGHTS_0"] = json!(weights);
    glb.json["skins"] = json!([{ "joints": [1, 2] }]);
    // The node's own place does not count for a skinned mesh.
    glb.json["nodes"] = json!([
        { "mesh": 0, "skin": 0, "translation": [50, 50, 50] },
        { "translation": [0, 0, 4] },
        { "translation": [0, 8, 0] }
    ]);
    glb.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    let scene = read(folder.path(), "skin.glb", glb.bytes());
    let corner = scene.objects[0].mesh.positions_mm[2];
    assert!((corner - Vec3::new(1.0, 7.0, 1.0)).length() < 1e-5, "{corner}");
}

#[test]
fn morph_targets_come_in_millimetres_with_their_names() {
    let folder = tempfile::tempdir().unwrap();
    let mut glb = Glb::square();
    let target = glb.add_accessor(&floats(&[0., 0., 0.01].repeat(4)), 5126, 4, "VEC3");
    glb.json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": target }]);
    glb.json["meshes"][0]["weights"] = json!([0.5]);
    glb.json["meshes"][0]["extras"] = json!({ "targetNames": ["smile"] });
    let path = write(folder.path(), "morph.glb", glb.bytes());
    let scene = read_scene(&path, &ReadOptions::default()).unwrap();
    let morph = &scene.objects[0].rest().morph_targets[0];
    assert_eq!((morph.name.as_str(), morph.weight), ("smile", 0.5));
    assert_eq!(morph.position_offsets_mm.len(), 4);
    assert!((morph.position_offsets_mm[3] - Vec3::Z * 10.0).length() < 1e-4);
}

#[test]
fn extras_may_be_anything() {
    let folder = tempfile::tempdir().unwrap();
    for extras in [json!(7), json!([1, [2]]), json!("text"), json!({ "a": { "extras": 1 } })] {
        let mut glb = Glb::square();
        glb.json["extras"] = extras.clone();
        glb.json["nodes"][0]["extras"] = extras;
        assert_eq!(read(folder.path(), "extras.glb", glb.bytes()).objects.len(), 1);
    }
}

#[test]
fn primitives_of_one_material_become_one_object() {
    let folder = tempfile::tempdir().unwrap();
    let mut glb = Glb::square();
    glb.json["materials"] = json!([{ "name": "a" }, { "name": "b" }]);
    let attributes = json!({ "POSITION": 0, "TEXCOORD_0": 1 });
    glb.json["meshes"][0]["primitives"] = json!([
        { "attributes": attributes, "indices": 2, "material": 0 },
        { "attributes": attributes, "mode": 6, "material": 0 },
        { "attributes": attributes, "mode": 5, "material": 1 }
    ]);
    let scene = read(folder.path(), "three.glb", glb.bytes());
    let counts: Vec<_> = scene.objects.iter().map(|o| o.mesh.triangles.len()).collect();
    assert_eq!(counts, [4, 2]);
    assert_eq!(scene.objects[1].material.name, "b");
}

#[test]
fn gltf_materials_become_skin() {
    let folder = tempfile::tempdir().unwrap();
    let mut glb = Glb::square();
    let view = glb.add_view(&small_png());
    glb.json["images"] = json!([{ "bufferView": view, "mimeType": "image/png" }]);
    glb.json["textures"] = json!([{ "source": 0 }]);
    glb.json["materials"] = json!([{
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.5, 0.25, 1.0, 1.0],
            "baseColorTexture": { "index": 0, "extensions": { "KHR_texture_transform": { "scale": [0.5, 0.5] } } },
            "roughnessFactor": 0.5
        },
        "normalTexture": { "index": 0, "scale": 0.7 },
        "extensions": { "KHR_materials_ior": { "ior": 1.5 }, "KHR_materials_specular": { "specularFactor": 0.3 } }
    }]);
    glb.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    let scene = read(folder.path(), "material.glb", glb.bytes());
    let material = &scene.objects[0].material;
    assert_eq!(material.albedo.factor, Vec3::new(0.5, 0.25, 1.0));
    // sRGB code 200 is 0.577580 in linear light (evaluated by hand from IEC 61966-2-1).
    assert!((material.albedo.at(Vec2::ZERO).x - 0.5 * 0.577_580).abs() < 1e-5);
    assert_eq!(material.roughness.at(Vec2::ZERO), 0.25);
    assert_eq!(material.rho_s.at(Vec2::ZERO), 0.3);
    assert!((material.f0 - 0.04).abs() < 1e-6);
    let normal = material.normal.as_ref().unwrap();
    assert_eq!(normal.strength, 0.7);
    // As data the same image is not decoded.
    assert_eq!(normal.texture.texel(0, 0).x, 200.0 / 255.0);
    assert_eq!(scene.objects[0].mesh.uvs[1], Vec2::splat(0.5));
}

#[test]
fn gltf_cameras_and_lights_are_placed_by_their_nodes() {
    let folder = tempfile::tempdir().unwrap();
    let mut glb = Glb::square();
    glb.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    glb.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "point", "intensity": 2.0, "color": [1.0, 0.5, 0.25] },
        { "type": "spot", "spot": { "innerConeAngle": 0.1, "outerConeAngle": 0.3 } },
        { "type": "directional" }
    ] } });
    let light = |i: usize| json!({ "KHR_lights_punctual": { "light": i } });
    glb.json["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 0.5, "znear": 0.01 } }]);
    glb.json["nodes"] = json!([
        { "mesh": 0, "children": [1, 2, 3, 4] },
        { "translation": [0, 0, 3], "camera": 0 },
        { "translation": [1, 2, 3], "extensions": light(0) },
        { "translation": [0, 0, 1], "extensions": light(1) },
        { "extensions": light(2) }
    ]);
    let scene = read(folder.path(), "lit.glb", glb.bytes());
    assert_eq!(scene.camera.position_mm, Vec3::Z * 3.0);
    assert_eq!((scene.camera.look_at_mm, scene.camera.vertical_fov_rad), (Vec3::ZERO, 0.5));
    assert!(scene.environment.is_none(), "the file has its own light");
    let Light::Point { position_mm, intensity_w_per_sr, .. } = scene.lights[0] else { panic!("a point") };
    assert_eq!((position_mm, intensity_w_per_sr), (Vec3::new(1., 2., 3.), Vec3::new(2.0, 1.0, 0.5)));
    assert!(matches!(scene.lights[1], Light::Spot { dir_travel, .. } if dir_travel == -Vec3::Z));
    assert!(matches!(scene.lights[2], Light::Directional { dir_to_light, .. } if dir_to_light == Vec3::Z));
}

#[test]
fn a_png_comes_back_code_by_code() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "a.png", small_png());
    let texture = read_image(&path, ColourSpace::Colour, &mut Vec::new()).unwrap();
    assert_eq!((texture.width(), texture.height()), (4, 2));
    assert!(matches!(texture.texels(), Texels::Srgb8(t) if t[7] == [200, 100, 50, 255]));
    let texture = read_image(&path, ColourSpace::Data, &mut Vec::new()).unwrap();
    assert!(matches!(texture.texels(), Texels::Linear8(t) if t[0] == [200, 100, 50, 255]));
}

#[test]
fn a_16_bit_png_keeps_its_digits() {
    let folder = tempfile::tempdir().unwrap();
    let picture = image::ImageBuffer::from_pixel(2, 2, image::Luma([12_345u16]));
    let path = write(folder.path(), "a.png", encode(DynamicImage::ImageLuma16(picture), ImageFormat::Png));
    let texture = read_image(&path, ColourSpace::Data, &mut Vec::new()).unwrap();
    assert_eq!(texture.texel(1, 1).y, 12_345.0 / 65_535.0);
    let texture = read_image(&path, ColourSpace::Colour, &mut Vec::new()).unwrap();
    // ((12345/65535 + 0.055) / 1.055)^2.4 = 0.029597, by hand in f64.
    assert!((texture.texel(1, 1).y - 0.029_597).abs() < 1e-5, "{}", texture.texel(1, 1).y);
}

#[test]
fn a_jpeg_comes_back_within_its_loss() {
    let folder = tempfile::tempdir().unwrap();
    let picture = image::RgbImage::from_pixel(16, 16, image::Rgb([180, 120, 90]));
    let path = write(folder.path(), "a.jpg", encode(DynamicImage::ImageRgb8(picture), ImageFormat::Jpeg));
    let texture = read_image(&path, ColourSpace::Data, &mut Vec::new()).unwrap();
    // One colour is one coefficient per block: two roundings, of the coefficient (step 3 at quality 75) and of the
    // colour transform.
    let error = (texture.texel(5, 5).truncate() * 255.0 - Vec3::new(180.0, 120.0, 90.0)).abs();
    assert!(error.max_element() <= 3.0, "{error}");
}

#[test]
fn float_images_come_back_exactly_and_hdr_within_its_mantissa() {
    let folder = tempfile::tempdir().unwrap();
    let value = |x: u32, y: u32, c: u32| 0.01 + (x * 3 + y * 7 + c) as f32 * 1.37;
    let picture = image::Rgb32FImage::from_fn(5, 3, |x, y| image::Rgb([0, 1, 2].map(|c| value(x, y, c))));
    let picture = DynamicImage::ImageRgb32F(picture);
    let exr = write(folder.path(), "a.exr", encode(picture.clone(), ImageFormat::OpenExr));
    let hdr = write(folder.path(), "a.hdr", encode(picture, ImageFormat::Hdr));
    let exr = read_image(&exr, ColourSpace::Colour, &mut Vec::new()).unwrap();
    let hdr = read_image(&hdr, ColourSpace::Colour, &mut Vec::new()).unwrap();
    for (x, y) in (0..5).flat_map(|x| (0..3).map(move |y| (x, y))) {
        let there = Vec3::new(value(x, y, 0), value(x, y, 1), value(x, y, 2));
        assert_eq!(exr.texel(x, y).truncate(), there);
        // Eight bits below the largest channel, whose top bit may be the lowest of its octave: 2^-7.
        let error = (hdr.texel(x, y).truncate() - there).abs().max_element();
        assert!(error <= there.max_element() / 128.0, "{error} of {there}");
    }
}

#[test]
fn infinities_in_an_exr_are_mended_with_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let picture = image::Rgb32FImage::from_pixel(2, 2, image::Rgb([f32::INFINITY, f32::NAN, 1.0]));
    let path =
        write(folder.path(), "a.exr", encode(DynamicImage::ImageRgb32F(picture), ImageFormat::OpenExr));
    let mut warnings = Vec::new();
    let texture = read_image(&path, ColourSpace::Colour, &mut warnings).unwrap();
    assert_eq!(texture.texel(0, 0).truncate(), Vec3::new(65_504.0, 0.0, 1.0));
    assert!(warnings[0].contains("4 texels"), "{warnings:?}");
}
