//! Meshes that come without an atlas get one, and say so.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{SQUARE_OBJ, shelf, write};
use cutis_scene::{AtlasChoice, Charts, Object, ReadOptions, Scene, read_scene};
use glam::Vec2;
use std::path::Path;

fn load(path: &Path, cache_folder: Option<&Path>) -> Scene {
    let options = ReadOptions {
        millimetres_per_unit: Some(1.0),
        cache_folder: cache_folder.map(Path::to_owned),
        ..ReadOptions::default()
    };
    read_scene(path, &options).unwrap()
}

fn has_an_atlas(object: &Object) -> bool {
    Charts::inside_unit_square(&object.mesh) && Charts::overlap_fraction(&object.mesh, 512) < 1e-3
}

fn png() -> Vec<u8> {
    let mut png = std::io::Cursor::new(Vec::new());
    image::RgbImage::new(2, 2).write_to(&mut png, image::ImageFormat::Png).unwrap();
    png.into_inner()
}

/// A cube of bare faces.
const CUBE_OBJ: &str = "v 0 0 0\nv 50 0 0\nv 50 50 0\nv 0 50 0\nv 0 0 50\nv 50 0 50\nv 50 50 50\nv 0 50 50\n\
    f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

#[test]
fn a_mesh_without_texture_coordinates_gets_an_atlas() {
    let folder = tempfile::tempdir().unwrap();
    let scene = load(&write(folder.path(), "cube.obj", CUBE_OBJ), None);
    let object = &scene.objects[0];
    assert_eq!(object.mesh.triangles.len(), 12);
    assert!(object.closed && has_an_atlas(object));
    let told = "the mesh has no texture coordinates; an atlas of ";
    assert!(scene.warnings.iter().any(|w| w.contains(told)), "{:?}", scene.warnings);
}

/// Maps, if there are any, lie where they lay.
#[test]
fn where_a_texture_is_used_twice_light_gets_an_atlas() {
    let folder = tempfile::tempdir().unwrap();
    // The square once more, ten centimetres above.
    let twice =
        format!("{SQUARE_OBJ}v 0 0 100\nv 100 0 100\nv 100 100 100\nv 0 100 100\nf 5/1 6/2 7/3 8/4\n");
    let path = write(folder.path(), "twice.obj", twice);
    let albedo = Some(write(folder.path(), "albedo.png", png()));
    for albedo in [None, albedo] {
        let options = ReadOptions { albedo, millimetres_per_unit: Some(1.0), ..ReadOptions::default() };
        let scene = read_scene(&path, &options).unwrap();
        let mesh = &scene.objects[0].mesh;
        assert!(has_an_atlas(&scene.objects[0]), "{:?}", scene.warnings);
        let told = "100.0 % of the used texture belongs to more than one place of the surface; an atlas of 2";
        assert!(scene.warnings.iter().any(|w| w.contains(told)), "{:?}", scene.warnings);
        for t in 0..4 {
            let of_square = mesh.corners_mm(t).map(|p| Vec2::new(p.x / 100.0, 1.0 - p.y / 100.0));
            assert_eq!(mesh.corner_map_uvs(t), of_square, "maps lie where they lay");
        }
    }
}

/// Faces without coordinates beside others that have some: they lie at the texture's corner, and light has a place everywhere.
#[test]
fn where_some_faces_have_no_texture_coordinates_light_gets_an_atlas() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!("{SQUARE_OBJ}v 0 0 100\nv 100 0 100\nv 100 100 100\nv 0 100 100\nf 5 6 7 8\n");
    let path = write(folder.path(), "half.obj", text);
    let albedo = Some(write(folder.path(), "albedo.png", png()));
    let options = ReadOptions { albedo, millimetres_per_unit: Some(1.0), ..ReadOptions::default() };
    let scene = read_scene(&path, &options).unwrap();
    let lacks = "parts of the mesh have no texture coordinates";
    for told in [format!("{lacks}; an atlas of 2 charts"), format!("{lacks}: its maps show one colour there")]
    {
        assert!(scene.warnings.iter().any(|w| w.contains(&told)), "{:?}", scene.warnings);
    }
    let mesh = &scene.objects[0].mesh;
    assert!(has_an_atlas(&scene.objects[0]));
    let [with, without] = [0, 2].map(|t| mesh.corner_map_uvs(t));
    assert_eq!((with[0], without), (Vec2::new(0.0, 1.0), [Vec2::ZERO; 3]));
}

/// Maps stay, and so does what a mesh has at its corners.
#[test]
fn a_new_atlas_is_made_for_who_asks() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "square.obj", SQUARE_OBJ);
    let scene_of = |atlas| {
        let options = ReadOptions { atlas, millimetres_per_unit: Some(1.0), ..ReadOptions::default() };
        read_scene(&path, &options).unwrap()
    };
    let (own, new) = (scene_of(None), scene_of(Some(AtlasChoice::New)));
    assert_eq!(own.objects[0].mesh.atlas_uvs, None);
    let mesh = &new.objects[0].mesh;
    assert!(mesh.atlas_uvs.is_some() && has_an_atlas(&new.objects[0]));
    assert_eq!(own.warnings, new.warnings, "who asks knows");
    for t in 0..2 {
        assert_eq!(mesh.corner_map_uvs(t), own.objects[0].mesh.corner_map_uvs(t));
        assert_eq!(mesh.corners_mm(t), own.objects[0].mesh.corners_mm(t));
    }
    // A scene file says the same, and the caller has the last word.
    let text = "[mesh]\npath = \"square.obj\"\nmillimetres_per_unit = 1\natlas = \"new\"\n";
    let file = write(folder.path(), "scene.toml", text);
    let asked = |atlas| {
        let options = ReadOptions { atlas, ..ReadOptions::default() };
        read_scene(&file, &options).unwrap().objects[0].mesh.atlas_uvs.clone()
    };
    assert_eq!(asked(None), mesh.atlas_uvs);
    assert_eq!(asked(Some(AtlasChoice::Own)), None);
}

#[test]
fn maps_need_texture_coordinates() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "cube.obj", CUBE_OBJ);
    let albedo = Some(write(folder.path(), "albedo.png", png()));
    let error = read_scene(&path, &ReadOptions { albedo, ..ReadOptions::default() }).unwrap_err().to_string();
    assert!(error.contains("cube.obj") && error.contains("which its maps need"), "{error}");
}

#[test]
fn an_atlas_is_kept_and_found_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "cube.obj", CUBE_OBJ);
    let cache = folder.path().join("cache");
    let (first, second) = (load(&path, Some(&cache)), load(&path, Some(&cache)));
    assert_eq!(std::fs::read_dir(&cache).unwrap().count(), 1, "one atlas is kept");
    assert_eq!(first.objects[0].mesh.uvs, second.objects[0].mesh.uvs);
    // What is kept is what is taken.
    let kept = std::fs::read_dir(&cache).unwrap().next().unwrap().unwrap().path();
    let mut bytes = std::fs::read(&kept).unwrap();
    let first_u = 16 + 4 * u32::from_le_bytes(bytes[8..12].try_into().unwrap()) as usize;
    bytes[first_u..first_u + 4].copy_from_slice(&0.125f32.to_le_bytes());
    std::fs::write(&kept, &bytes).unwrap();
    assert_eq!(load(&path, Some(&cache)).objects[0].mesh.uvs[0].x, 0.125);
    // What is there instead is not believed.
    std::fs::write(&kept, b"nothing of use").unwrap();
    assert_eq!(first.objects[0].mesh.uvs, load(&path, Some(&cache)).objects[0].mesh.uvs);
}

/// The scan without its own atlas.
#[test]
fn the_scanned_head_gets_an_atlas() {
    let Some(shelf) = shelf("the_scanned_head_gets_an_atlas") else { return };
    let text = std::fs::read_to_string(shelf.join("lee_perry_smith/LeePerrySmith.obj")).unwrap();
    let bare = |line: &str| match line.strip_prefix("f ") {
        Some(face) => {
            let corners = face.split_ascii_whitespace().map(|c| c.split('/').next().unwrap());
            format!("f {}", corners.collect::<Vec<_>>().join(" "))
        }
        None => line.to_owned(),
    };
    let text: Vec<String> = text.lines().map(bare).collect();
    let folder = tempfile::tempdir().unwrap();
    let scene = load(&write(folder.path(), "bare.obj", text.join("\n")), None);
    let object = &scene.objects[0];
    assert_eq!(object.mesh.triangles.len(), 17_684);
    assert!(object.closed && has_an_atlas(object), "{:?}", scene.warnings);
    assert!(object.charts.count < 200, "{} charts", object.charts.count);
}
