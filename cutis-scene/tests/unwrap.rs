//! Meshes that come without an atlas get one, and say so.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{SQUARE_OBJ, shelf, write};
use cutis_scene::{Charts, Object, ReadOptions, Scene, read_scene};
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

#[test]
fn a_texture_that_is_used_twice_is_replaced_where_nothing_lies_on_it() {
    let folder = tempfile::tempdir().unwrap();
    // The square once more, ten centimetres above.
    let twice =
        format!("{SQUARE_OBJ}v 0 0 100\nv 100 0 100\nv 100 100 100\nv 0 100 100\nf 5/1 6/2 7/3 8/4\n");
    let scene = load(&write(folder.path(), "twice.obj", twice), None);
    assert!(has_an_atlas(&scene.objects[0]), "{:?}", scene.warnings);
    assert!(
        scene.warnings.iter().any(|w| w.contains("belongs to more than one place")),
        "{:?}",
        scene.warnings
    );
}

#[test]
fn maps_need_texture_coordinates() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "cube.obj", CUBE_OBJ);
    let mut png = Vec::new();
    image::RgbImage::new(2, 2)
        .write_to(&mut std::io::Cursor::new(&mut png), image::ImageFormat::Png)
        .unwrap();
    let albedo = Some(write(folder.path(), "albedo.png", png));
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
