//! The shared assets load, and are what their description says.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{shelf, write};
use cutis_scene::{ColourSpace, Object, ReadOptions, Scene, read_image, read_scene};
use glam::Vec3;
use std::path::Path;

fn load(shelf: &Path, name: &str, mm: Option<f32>, flip_v: bool) -> Scene {
    let options = ReadOptions { millimetres_per_unit: mm, flip_v, ..ReadOptions::default() };
    read_scene(&shelf.join(name), &options).unwrap()
}

fn points(object: &Object) -> u32 {
    object.point_of_vertex.iter().max().unwrap() + 1
}

fn extent_mm(scene: &Scene) -> Vec3 {
    let [lo, hi] = scene.bounds_mm().unwrap();
    hi - lo
}

#[test]
fn the_scanned_head() {
    let Some(shelf) = shelf("the_scanned_head") else { return };
    let scene = load(&shelf, "lee_perry_smith/LeePerrySmith.obj", Some(950.0), false);
    let [object] = &scene.objects[..] else { panic!("one object") };
    assert_eq!((points(object), object.mesh.triangles.len()), (8844, 17_684));
    assert_eq!((object.charts.count, object.closed), (11, true));
    // 43 cm across the shoulders.
    assert!((extent_mm(&scene).x - 430.0).abs() < 5.0, "{}", extent_mm(&scene));
    assert!(scene.warnings.iter().all(|w| !w.contains("mix")), "no overlap: {:?}", scene.warnings);
}

#[test]
fn the_scanned_head_as_glb_is_the_same_head() {
    let Some(shelf) = shelf("the_scanned_head_as_glb_is_the_same_head") else { return };
    let obj = load(&shelf, "lee_perry_smith/LeePerrySmith.obj", Some(950.0), false);
    let glb = load(&shelf, "lee_perry_smith/LeePerrySmith.glb", Some(50.4), true);
    let object = &glb.objects[0];
    assert_eq!((points(object), object.mesh.triangles.len(), object.charts.count), (8844, 17_684, 11));
    assert!((extent_mm(&glb) - extent_mm(&obj)).abs().max_element() < 5.0);
    // The same texture fits both: the middle of each used texture is at the same place.
    let mean = |o: &Object| o.mesh.uvs.iter().sum::<glam::Vec2>() / o.mesh.uvs.len() as f32;
    let (a, b) = (mean(&obj.objects[0]), mean(object));
    assert!((a - b).length() < 0.02, "{a} {b}");
}

#[test]
fn the_tessellated_head_of_the_game_engine() {
    let Some(shelf) = shelf("the_tessellated_head_of_the_game_engine") else { return };
    let scene = load(&shelf, "lee_perry_smith/away3d_2k/head.obj", None, false);
    assert_eq!(scene.objects[0].mesh.triangles.len(), 17_684);
    assert!(scene.warnings.iter().any(|w| w.contains("assumed 250 mm")), "{:?}", scene.warnings);
}

#[test]
fn the_monkey() {
    let Some(shelf) = shelf("the_monkey") else { return };
    let scene = load(&shelf, "gltf_samples/Suzanne/Suzanne.gltf", None, false);
    let [object] = &scene.objects[..] else { panic!("one object") };
    assert_eq!((object.charts.count, object.closed), (3, false));
    assert!(object.material.albedo.texture.is_some() && object.material.roughness.texture.is_some());
}

#[test]
fn the_skinned_hands() {
    let Some(shelf) = shelf("the_skinned_hands") else { return };
    for name in ["webxr_hand/left.glb", "webxr_hand/right.glb"] {
        let scene = load(&shelf, name, None, false);
        let [object] = &scene.objects[..] else { panic!("one object") };
        assert_eq!(object.charts.count, 3, "{name}");
        let length_mm = extent_mm(&scene).max_element();
        assert!((length_mm - 210.0).abs() < 15.0, "{name}: {length_mm} mm");
        // A surface turned inside out would have a negative volume.
        let volume = |t: usize| {
            let [a, b, c] = object.mesh.corners_mm(t);
            a.dot(b.cross(c)) / 6.0
        };
        let volume_mm3: f32 = (0..object.mesh.triangles.len()).map(volume).sum();
        assert!((100_000.0..600_000.0).contains(&volume_mm3), "{name}: {volume_mm3} mm³");
    }
}

#[test]
fn the_environments() {
    let Some(shelf) = shelf("the_environments") else { return };
    for (name, size) in [
        ("hdri/royal_esplanade_1k.hdr", (1024, 512)),
        ("hdri/venice_sunset_1k.hdr", (1024, 512)),
        ("hdri/pmndrs_studio.exr", (512, 256)),
    ] {
        let mut warnings = Vec::new();
        let texture = read_image(&shelf.join(name), ColourSpace::Colour, &mut warnings).unwrap();
        assert_eq!((texture.width(), texture.height()), size, "{name}");
        let brightest =
            (0..size.0 * size.1).map(|i| texture.texel(i % size.0, i / size.0).y).fold(0.0, f32::max);
        assert!(brightest > 1.0, "{name}: {brightest}");
        assert!(warnings.is_empty(), "{name}: {warnings:?}");
    }
}

#[test]
fn the_textures() {
    let Some(shelf) = shelf("the_textures") else { return };
    for (name, side) in [
        ("away3d_2k/head_diffuse.jpg", 2048),
        ("away3d_2k/head_AO.jpg", 1024),
        ("Map-SPEC.jpg", 1024),
        ("bump_1024.png", 1024),
        ("Infinite-Level_02_Disp_NoSmoothUV-4096.jpg", 4096),
    ] {
        let path = shelf.join("lee_perry_smith").join(name);
        let texture = read_image(&path, ColourSpace::Data, &mut Vec::new()).unwrap();
        assert_eq!((texture.width(), texture.height()), (side, side), "{name}");
    }
}

#[test]
fn a_scene_file_with_everything_from_the_shelf() {
    let Some(shelf) = shelf("a_scene_file_with_everything_from_the_shelf") else { return };
    let folder = tempfile::tempdir().unwrap();
    let text = r#"
        [mesh]
        path = "assets:lee_perry_smith/LeePerrySmith.obj"
        millimetres_per_unit = 950.0
        [material]
        preset = "three-layer-skin"
        albedo = "assets:lee_perry_smith/away3d_2k/head_diffuse.jpg"
        normal = "assets:lee_perry_smith/away3d_2k/head_normals.jpg"
        specular = "assets:lee_perry_smith/away3d_2k/head_specular.jpg"
        roughness = { path = "assets:lee_perry_smith/away3d_2k/head_specular.jpg", offset = 0.23, gain = 0.09 }
        [[light]]
        kind = "environment"
        path = "assets:hdri/pmndrs_studio.exr"
        rotation_degrees = 90
    "#;
    let path = write(folder.path(), "head.toml", text);
    let options = ReadOptions { assets_folder: Some(shelf), ..ReadOptions::default() };
    let scene = read_scene(&path, &options).unwrap();
    let material = &scene.objects[0].material;
    assert!(material.albedo.texture.is_some() && material.normal.is_some());
    // Read once for the two maps.
    let textures = [&material.rho_s, &material.roughness].map(|map| map.texture.as_ref().unwrap().0.clone());
    assert!(std::sync::Arc::ptr_eq(&textures[0], &textures[1]));
    assert!(scene.lights.is_empty() && scene.environment.is_some());
}
