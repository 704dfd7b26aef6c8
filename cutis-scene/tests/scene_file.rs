//! Scene files: every key arrives where it belongs.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{SQUARE_OBJ, small_png, write};
use cutis_scene::{Light, NormalSpace, ReadOptions, Scattering, Scene, read_scene};
use glam::{Vec2, Vec3};
use std::path::Path;

fn scene_in(folder: &Path, text: &str) -> Scene {
    write(folder, "square.obj", SQUARE_OBJ);
    write(folder, "map.png", small_png());
    let path = write(folder, "scene.toml", text);
    read_scene(&path, &ReadOptions::default()).unwrap()
}

const MESH: &str = "[mesh]\npath = \"square.obj\"\nmillimetres_per_unit = 2\n";

#[test]
fn mesh_keys_arrive() {
    let folder = tempfile::tempdir().unwrap();
    let scene = scene_in(folder.path(), &format!("{MESH}flip_v = true\n"));
    assert_eq!(scene.bounds_mm().unwrap()[1], Vec3::new(200.0, 200.0, 0.0));
    assert_eq!(scene.objects[0].mesh.uvs[0], Vec2::ZERO);
}

#[test]
fn the_callers_unit_and_textures_go_before_those_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    scene_in(folder.path(), MESH);
    let elsewhere = tempfile::tempdir().unwrap();
    let options = ReadOptions {
        millimetres_per_unit: Some(3.0),
        albedo: Some(write(elsewhere.path(), "a.png", small_png())),
        normal: Some(write(elsewhere.path(), "n.png", small_png())),
        specular: Some(write(elsewhere.path(), "s.png", small_png())),
        ..ReadOptions::default()
    };
    let scene = read_scene(&folder.path().join("scene.toml"), &options).unwrap();
    assert_eq!(scene.bounds_mm().unwrap()[1].x, 300.0);
    let material = &scene.objects[0].material;
    assert!(material.albedo.texture.is_some() && material.normal.is_some());
    assert!(
        (material.rho_s.at(Vec2::ZERO) - std::f32::consts::PI * (0.18 + 0.16 * 200.0 / 255.0)).abs() < 1e-6
    );
}

#[test]
fn material_keys_arrive() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "{MESH}[material]\nmedium = {{ sigma_a_per_mm = [0.032, 0.17, 0.48], sigma_s_reduced_per_mm = [0.74, 0.88, \
         1.01], refractive_index = 1.3 }}\nalbedo = \"map.png\"\nalbedo_colour = [0.5, 1, 1]\nalbedo_mix = 1\n\
         normal = \"map.png\"\nnormal_space = \"object\"\nnormal_strength = 0.5\nf0 = 0.04\nroughness = 0.4\n\
         thickness_scale = 2.5\n\
         under = [{{ colour = [1, 0.5, 0.25] }}, {{ path = \"map.png\", colour = [0.5, 1, 1] }}]\n\
         mixed_with = {{ preset = \"ketchup\", share = {{ path = \"map.png\", channel = \"red\", gain = 2 }} }}\n\
         specular = {{ path = \"map.png\", channel = \"green\", offset = 0.1, gain = 2 }}\n"
    );
    let material = scene_in(folder.path(), &text).objects.remove(0).material;
    let Scattering::Medium(medium) = &material.scattering else { panic!("a medium") };
    assert_eq!(medium[1].sigma_a_per_mm, 0.17);
    assert_eq!((medium[2].sigma_s_reduced_per_mm, medium[0].refractive_index), (1.01, 1.3));
    assert_eq!((material.albedo.factor, material.albedo_mix), (Vec3::new(0.5, 1.0, 1.0), 1.0));
    let normal = material.normal.as_ref().unwrap();
    assert_eq!((normal.space, normal.strength), (NormalSpace::Object, 0.5));
    assert!((material.rho_s.at(Vec2::ZERO) - (0.1 + 200.0 / 255.0)).abs() < 1e-6);
    assert_eq!((material.roughness.at(Vec2::ZERO), material.f0), (0.4, 0.04));
    assert_eq!(material.thickness_scale, 2.5);
    assert_eq!(material.share_at(Vec2::ZERO), 1.0, "no share is above 1");
    let second = material.mixed_with.as_ref().unwrap();
    assert!((second.share.at(Vec2::ZERO) - 400.0 / 255.0).abs() < 1e-6);
    assert!(matches!(&second.scattering, Scattering::Preset(name) if name == "ketchup"));
    let [near, deep] = &material.under[..] else { panic!("two layers") };
    assert_eq!(near.at(Vec2::ZERO), Vec3::new(1.0, 0.5, 0.25));
    assert_eq!(deep.at(Vec2::ZERO), material.albedo.at(Vec2::ZERO), "the same map, the same colour");
}

#[test]
fn layers_arrive() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "{MESH}[material]\nlayers = [\n\
         {{ sigma_a_per_mm = [0.2, 0.5, 1], sigma_s_reduced_per_mm = [4, 5, 6], thickness_mm = 0.25 }},\n\
         {{ sigma_a_per_mm = [0.01, 0.1, 0.3], sigma_s_reduced_per_mm = [2, 2.5, 3], refractive_index = 1.38 }}]\n"
    );
    let material = scene_in(folder.path(), &text).objects.remove(0).material;
    let Scattering::Layers([_, green, blue]) = &material.scattering else { panic!("layers") };
    assert_eq!((green.len(), green[0].thickness_mm, green[1].thickness_mm), (2, 0.25, f64::INFINITY));
    assert_eq!((blue[0].medium.sigma_s_reduced_per_mm, blue[1].medium.sigma_a_per_mm), (6.0, 0.3));
    assert_eq!((green[0].medium.refractive_index, green[1].medium.refractive_index), (1.4, 1.38));
    assert_eq!(material.albedo.factor, Vec3::ONE, "layers show their own colour");
}

#[test]
fn light_keys_arrive() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "{MESH}[[light]]\nkind = \"point\"\nposition_mm = [1, 2, 3]\ncolour = [1, 0.5, 0]\nintensity = 2\n\
         radius_mm = 4\n[[light]]\nkind = \"spot\"\nposition_mm = [0, 0, 9]\ndirection = [0, 0, -5]\n\
         inner_cone_degrees = 10\nouter_cone_degrees = 20\n[[light]]\nkind = \"directional\"\n\
         direction = [0, -2, 0]\nangular_radius_degrees = 0.5\n[[light]]\nkind = \"projector\"\n\
         path = \"map.png\"\nposition_mm = [0, 0, 9]\ndirection = [0, 0, -5]\nup = [0, -1, 0]\n\
         vertical_fov_degrees = 90\nintensity = 3\nradius_mm = 2\n\
         shift = [0.25, -0.5]\ndrift_per_s = [0, 2]\n[[light]]\nkind = \"environment\"\nvisible = true\n\
         rotation_degrees = 180\nintensity = 0.5\n"
    );
    let scene = scene_in(folder.path(), &text);
    let Light::Point { position_mm, intensity_w_per_sr, radius_mm } = scene.lights[0] else {
        panic!("{:?}", scene.lights[0])
    };
    assert_eq!((position_mm, radius_mm), (Vec3::new(1.0, 2.0, 3.0), 4.0));
    assert_eq!(intensity_w_per_sr, Vec3::new(2.0, 1.0, 0.0));
    assert!(matches!(scene.lights[1], Light::Spot { dir_travel, .. } if dir_travel == -Vec3::Z));
    assert!(matches!(scene.lights[2], Light::Directional { dir_to_light, .. } if dir_to_light == Vec3::Y));
    let Light::Projector(projector) = &scene.lights[3] else { panic!("{:?}", scene.lights[3]) };
    assert_eq!(projector.axes, [-Vec3::X, -Vec3::Y, -Vec3::Z]);
    assert!((projector.tan_half_height - 1.0).abs() < 1e-6 && projector.image.width() > 0);
    assert_eq!(
        (projector.position_mm.z, projector.intensity_w_per_sr.x, projector.radius_mm),
        (9.0, 3.0, 2.0)
    );
    assert_eq!((projector.shift, projector.drift_per_s), (Vec2::new(0.25, -0.5), Vec2::new(0.0, 2.0)));
    let environment = scene.environment.unwrap();
    assert!(environment.visible && (environment.rotation_rad - std::f32::consts::PI).abs() < 1e-6);
    assert_eq!(environment.radiance_scale, Vec3::splat(0.5));
}

#[test]
fn camera_keys_arrive_and_the_rest_follows_from_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "{MESH}[camera]\nlook_at_mm = [1, 2, 3]\ndistance_mm = 900\nyaw_degrees = 90\nvertical_fov_degrees = 30\n\
         exposure_ev = 1.5\n"
    );
    let camera = scene_in(folder.path(), &text).camera;
    assert!((camera.position_mm - Vec3::new(901.0, 2.0, 3.0)).length() < 1e-3, "{}", camera.position_mm);
    assert!((camera.vertical_fov_rad - 30f32.to_radians()).abs() < 1e-6 && camera.exposure_ev == 1.5);
    let camera = scene_in(folder.path(), &format!("{MESH}[camera]\nposition_mm = [0, 0, 700]\n")).camera;
    assert_eq!((camera.position_mm, camera.look_at_mm), (Vec3::Z * 700.0, Vec3::new(100.0, 100.0, 0.0)));
}

#[test]
fn a_folder_below_the_scene_may_be_used_and_dots_that_stay_inside_too() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("maps")).unwrap();
    write(folder.path(), "maps/a.png", small_png());
    let text = format!("{MESH}[material]\nalbedo = \"./maps/../maps/a.png\"\n");
    assert!(scene_in(folder.path(), &text).objects[0].material.albedo.texture.is_some());
}
