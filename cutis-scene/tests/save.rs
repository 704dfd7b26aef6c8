//! Saved scenes are read back as they were.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{Glb, SQUARE_OBJ, shelf, small_png, write};
use cutis_optics::{Medium, RgbGaussianSum, TissueLayer};
use cutis_scene::head::{HeadDetail, built_in};
use cutis_scene::studio::{STUDIO_BACKGROUND, studio_environment, studio_lights};
use cutis_scene::{
    AtlasChoice, Camera, ColourMap, ColourSpace, Environment, Light, Material, NormalMap, NormalSpace,
    Object, Pose, Projector, ReadOptions, ScalarMap, Scattering, Scene, SecondMedium, Texels, Texture, Wave,
    read_image, read_scene, write_scene,
};
use glam::{Vec2, Vec3};
use proptest::prelude::*;
use serde_json::json;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

fn read(path: &Path) -> Scene {
    read_scene(path, &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// Writes and reads again.
fn there_and_back(scene: &Scene, path: &Path) -> Scene {
    write_scene(scene, path).unwrap_or_else(|error| panic!("{error}"));
    read(path)
}

fn assert_same_image(a: &Texture, b: &Texture, what: &str) {
    assert_eq!((a.width(), a.height()), (b.width(), b.height()), "{what}");
    let texels = |t: &Texture| {
        (0..t.height())
            .flat_map(|y| (0..t.width()).map(move |x| (x, y)))
            .map(|(x, y)| t.texel(x, y))
            .collect()
    };
    let (a, b): (Vec<_>, Vec<_>) = (texels(a), texels(b));
    assert!(a == b, "{what}: the texels differ");
}

fn assert_same_map(a: Option<&Arc<Texture>>, b: Option<&Arc<Texture>>, what: &str) {
    match (a, b) {
        (Some(a), Some(b)) => assert_same_image(a, b, what),
        (a, b) => assert_eq!(a.is_some(), b.is_some(), "{what}"),
    }
}

fn assert_same_material(a: &Material, b: &Material) {
    let numbers = |m: &Material| {
        let Material {
            name,
            scattering,
            albedo,
            albedo_mix,
            normal,
            rho_s,
            roughness,
            f0,
            thickness_scale,
            mean_free_path_scale,
            under,
            mixed_with,
        } = m;
        let scalar = |map: &ScalarMap| match &map.texture {
            Some((_, channel)) => format!("{} {} {channel}", map.offset, map.gain),
            None => format!("{}", map.offset),
        };
        let relief = normal.as_ref().map(|map| (map.space, map.strength));
        let scalars = [rho_s, roughness, mean_free_path_scale].map(scalar);
        let second = mixed_with.as_ref().map(|m| format!("{:?} {}", m.scattering, scalar(&m.share)));
        format!(
            "{name} {scattering:?} {} {albedo_mix} {relief:?} {scalars:?} {f0} {thickness_scale} {:?} {second:?}",
            albedo.factor,
            under.iter().map(|layer| layer.factor).collect::<Vec<_>>()
        )
    };
    assert_eq!(numbers(a), numbers(b));
    for ((place, a), (_, b)) in a.maps().into_iter().zip(b.maps()) {
        assert_same_map(a, b, place);
    }
    let share = |m: &Material| Some(m.mixed_with.as_ref()?.share.texture.as_ref()?.0.clone());
    assert_same_map(share(a).as_ref(), share(b).as_ref(), "share");
    for (a, b) in a.under.iter().zip(&b.under) {
        assert_same_map(a.texture.as_ref(), b.texture.as_ref(), "under");
    }
}

/// Directions of a projector's axes are made from two of them, which costs some rounding; everything else is the same to
/// the bit.
fn assert_same_light(a: &Light, b: &Light) {
    let (Light::Projector(a), Light::Projector(b)) = (a, b) else {
        return assert_eq!(format!("{a:?}"), format!("{b:?}"));
    };
    for (a, b) in a.axes.iter().zip(b.axes) {
        assert!((*a - b).length() < 8.0 * f32::EPSILON, "{a} {b}");
    }
    let rest = |p: &Projector| {
        (p.position_mm, p.tan_half_height, p.intensity_w_per_sr, p.radius_mm, p.shift, p.drift_per_s)
    };
    assert_eq!(rest(a), rest(b));
    assert_same_image(&a.image, &b.image, "projector");
}

fn assert_same(a: &Scene, b: &Scene) {
    assert_eq!(a.objects.len(), b.objects.len());
    for (a, b) in a.objects.iter().zip(&b.objects) {
        assert_eq!(a.name, b.name);
        for (a, b) in [(&a.mesh, &b.mesh), (a.rest(), b.rest())] {
            assert_eq!((&a.positions_mm, &a.normals), (&b.positions_mm, &b.normals));
            assert_eq!((&a.tangents, &a.triangles, &a.skeleton), (&b.tangents, &b.triangles, &b.skeleton));
            assert_eq!((&a.uvs, &a.atlas_uvs), (&b.uvs, &b.atlas_uvs));
        }
        assert_same_material(&a.material, &b.material);
    }
    assert_eq!(a.lights.len(), b.lights.len());
    a.lights.iter().zip(&b.lights).for_each(|(a, b)| assert_same_light(a, b));
    assert_eq!(a.environment.is_some(), b.environment.is_some());
    if let (Some(a), Some(b)) = (&a.environment, &b.environment) {
        let numbers = |e: &Environment| (e.rotation_rad, e.radiance_scale, e.visible);
        assert_eq!(numbers(a), numbers(b));
        assert_same_image(&a.map, &b.map, "environment");
    }
    assert_eq!((a.camera, a.background), (b.camera, b.background));
    assert_eq!(a.pose(), b.pose());
}

#[test]
fn every_scene_of_the_project() {
    let Some(shelf) = shelf("every_scene_of_the_project") else { return };
    let folder = tempfile::tempdir().unwrap();
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let options = ReadOptions { assets_folder: Some(shelf), ..ReadOptions::default() };
    let files = std::fs::read_dir(scenes).unwrap().map(|entry| entry.unwrap().path());
    let mut count = 0;
    for file in files.filter(|path| path.extension().is_some_and(|end| end == "toml")) {
        let scene = read_scene(&file, &options).unwrap();
        let saved = folder.path().join(file.file_name().unwrap());
        write_scene(&scene, &saved).unwrap();
        assert_same(&scene, &read_scene(&saved, &options).unwrap());
        count += 1;
    }
    assert!(count > 0, "there are scenes");
}

fn head_scene() -> Scene {
    let object = built_in(HeadDetail { triangles: 3000, map_size: 64 });
    let bounds_mm = object.mesh.bounds_mm().unwrap();
    Scene {
        objects: vec![object],
        lights: studio_lights(bounds_mm),
        environment: Some(studio_environment()),
        camera: Camera::framing(bounds_mm, Vec3::new(0.5, 0.1, 0.9), 0.436_332_3),
        background: Some(STUDIO_BACKGROUND),
        warnings: Vec::new(),
    }
}

#[test]
fn the_built_in_head_is_a_word_and_its_maps_are_too() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("head.toml");
    let mut scene = head_scene();
    scene.set_pose(&Pose { wave: Some(Wave::sideways(5.0, 90.0, 0.7)), ..Pose::default() }).unwrap();
    assert_same(&scene, &there_and_back(&scene, &path));
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("builtin = \"head\"\ntriangles = 3000\nmap_size = 64"), "{text}");
    assert!(text.contains("albedo = \"mesh:albedo\""), "{text}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no copies, nothing left behind");
}

#[test]
fn saving_again_writes_the_same_text() {
    let folder = tempfile::tempdir().unwrap();
    let [first, second] = ["a.toml", "b.toml"].map(|name| folder.path().join(name));
    let back = there_and_back(&head_scene(), &first);
    write_scene(&back, &second).unwrap();
    assert_eq!(std::fs::read_to_string(first).unwrap(), std::fs::read_to_string(second).unwrap());
}

#[test]
fn files_from_elsewhere_are_copied_and_files_below_are_named() {
    let [elsewhere, here] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let mesh = write(elsewhere.path(), "square.obj", SQUARE_OBJ);
    let options = ReadOptions {
        millimetres_per_unit: Some(2.0),
        flip_v: true,
        atlas: Some(AtlasChoice::New),
        albedo: Some(write(elsewhere.path(), "a \"b\".png", small_png())),
        ..ReadOptions::default()
    };
    let mut scene = read_scene(&mesh, &options).unwrap();
    let near = write(here.path(), "n.png", small_png());
    let texture = Arc::new(read_image(&near, ColourSpace::Data, &mut Vec::new()).unwrap());
    scene.objects[0].material.normal = Some(NormalMap { texture, space: NormalSpace::Object, strength: 0.5 });
    let path = here.path().join("scene.toml");
    assert_same(&scene, &there_and_back(&scene, &path));
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("path = \"scene_files/square.obj\""), "{text}");
    assert!(text.contains("normal = \"n.png\"") && text.contains("atlas = \"new\""), "{text}");
    let names = || {
        let entries = std::fs::read_dir(here.path().join("scene_files")).unwrap();
        let names = entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned());
        names.collect::<BTreeSet<_>>().into_iter().collect::<Vec<_>>()
    };
    assert_eq!(names(), ["a \"b\".png", "square.obj"]);
    // A second time nothing is copied, and another file of that name is left alone.
    there_and_back(&scene, &path);
    assert_eq!(names(), ["a \"b\".png", "square.obj"]);
    let other = SQUARE_OBJ.replace("100", "90");
    write(&here.path().join("scene_files"), "square.obj", &other);
    there_and_back(&scene, &path);
    assert_eq!(names(), ["a \"b\".png", "square-2.obj", "square.obj"]);
    assert_eq!(std::fs::read_to_string(here.path().join("scene_files/square.obj")).unwrap(), other);
}

#[test]
fn a_gltf_takes_its_neighbours_along_and_its_images_are_those_of_the_mesh() {
    let [elsewhere, here] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let mut glb = Glb::square();
    std::fs::create_dir(elsewhere.path().join("parts")).unwrap();
    write(elsewhere.path(), "parts/my buffer.bin", &glb.binary);
    write(elsewhere.path(), "skin.png", small_png());
    glb.json["buffers"][0]["uri"] = json!("parts/my%20buffer.bin");
    glb.json["images"] = json!([{ "uri": "skin.png" }]);
    glb.json["textures"] = json!([{ "source": 0 }]);
    glb.json["materials"] = json!([{ "name": "a", "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }, { "name": "b" }]);
    let attributes = json!({ "POSITION": 0, "TEXCOORD_0": 1 });
    glb.json["meshes"][0]["primitives"] = json!([
        { "attributes": attributes, "indices": 2, "material": 0 },
        { "attributes": attributes, "indices": 2, "material": 1 }
    ]);
    let mesh = write(elsewhere.path(), "two.gltf", glb.json.to_string());
    let mut scene = read(&mesh);
    scene.objects[1].material.f0 = 0.05;
    let path = here.path().join("scene.toml");
    assert_same(&scene, &there_and_back(&scene, &path));
    let text = std::fs::read_to_string(&path).unwrap();
    assert_eq!(text.matches("[[material]]").count(), 2, "{text}");
    assert!(text.contains("mesh:albedo") && text.contains("scene_files/two/two.gltf"), "{text}");
    assert!(here.path().join("scene_files/two/parts/my buffer.bin").is_file());
}

#[test]
fn images_made_by_code_become_files() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = write(folder.path(), "square.obj", SQUARE_OBJ);
    let mut scene = read(&mesh);
    let texture = |texels| Arc::new(Texture::new(2, 1, texels));
    let material = &mut scene.objects[0].material;
    material.albedo.texture = Some(texture(Texels::Srgb8(vec![[1, 200, 3, 255], [9, 8, 7, 255]])));
    let data = texture(Texels::Linear8(vec![[1, 2, 3, 255], [4, 5, 6, 255]]));
    let veins = texture(Texels::Srgb8(vec![[250, 90, 80, 255], [255; 4]]));
    material.under = vec![
        ColourMap { factor: Vec3::new(0.9, 0.8, 0.7), texture: None },
        ColourMap { factor: Vec3::new(1.0, 0.5, 0.25), texture: Some(veins) },
    ];
    material.rho_s = ScalarMap { offset: 0.25, gain: 0.5, texture: Some((data.clone(), 2)) };
    let share = ScalarMap { offset: 1.0, gain: -1.0, texture: Some((data.clone(), 1)) };
    material.scattering = Scattering::Preset("skin1".to_owned());
    material.mixed_with = Some(SecondMedium { scattering: Scattering::Preset("marble".to_owned()), share });
    material.roughness = ScalarMap { offset: 0.1, gain: 0.3, texture: Some((data, 1)) };
    let map = texture(Texels::LinearF32(vec![[0.1, 20.0, 3.0, 1.0], [0.0, 0.5, 1e-3, 1.0]]));
    scene.environment = Some(Environment {
        map,
        rotation_rad: 1.25,
        radiance_scale: Vec3::new(0.1, 0.2, 0.3),
        visible: true,
    });
    assert_same(&scene, &there_and_back(&scene, &folder.path().join("scene.toml")));
    assert_eq!(std::fs::read_dir(folder.path().join("scene_files")).unwrap().count(), 4, "shared maps once");
}

#[test]
fn a_dark_scene_stays_dark() {
    let folder = tempfile::tempdir().unwrap();
    let mut scene = read(&write(folder.path(), "square.obj", SQUARE_OBJ));
    (scene.lights, scene.environment, scene.background) = (Vec::new(), None, None);
    assert_same(&scene, &there_and_back(&scene, &folder.path().join("dark.toml")));
}

#[test]
fn what_cannot_be_saved_is_refused_in_words_and_the_old_file_stays() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "scene.toml", "old");
    let refused = |scene: &Scene, path: &Path, words: &str| {
        let error = write_scene(scene, path).unwrap_err().to_string();
        assert!(error.contains(words) && !error.contains('\n'), "{error}");
    };
    let mut scene = read(&write(folder.path(), "square.obj", SQUARE_OBJ));
    refused(&scene, &folder.path().join("no/scene.toml"), "its folder cannot be used");
    refused(&scene, &folder.path().join("scene.json"), "ends in .toml");
    scene.objects.push(scene.objects[0].clone());
    refused(&scene, &path, "stands at another place");
    let mesh = scene.objects[0].mesh.clone();
    scene.objects = vec![Object::new("made", mesh, Material::default())];
    refused(&scene, &path, "`made` was not read from a file");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "nothing is left behind");
}

#[test]
fn names_of_joints_may_be_anything() {
    let folder = tempfile::tempdir().unwrap();
    let mut glb = Glb::square();
    let name = "a \"joint\" = [1] \\ \u{7}é";
    let joints = glb.add_accessor(&[0; 16], 5121, 4, "VEC4");
    let weights = glb.add_accessor(&common::floats(&[1., 0., 0., 0.].repeat(4)), 5126, 4, "VEC4");
    let attributes = &mut glb.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = json!(joints);
    attributes["WEIGHTS_0"] = json!(weights);
    glb.json["skins"] = json!([{ "joints": [1] }]);
    glb.json["nodes"] = json!([{ "mesh": 0, "skin": 0 }, { "name": name }]);
    glb.json["scenes"][0]["nodes"] = json!([0, 1]);
    let mut scene = read(&write(folder.path(), "it.glb", glb.bytes()));
    let joint_degrees = [(name.to_owned(), Vec3::new(0.1, -20.0, 1e-7))].into();
    scene.set_pose(&Pose { joint_degrees, ..Pose::default() }).unwrap();
    assert_same(&scene, &there_and_back(&scene, &folder.path().join("scene.toml")));
}

fn vectors(limits: std::ops::Range<f32>) -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(limits).prop_map(Vec3::from_array)
}

fn pairs() -> impl Strategy<Value = Vec2> {
    prop::array::uniform2(-1.0..1.0f32).prop_map(Vec2::from_array)
}

fn directions() -> impl Strategy<Value = Vec3> {
    vectors(-1.0..1.0).prop_filter_map("has a direction", |v| v.try_normalize())
}

fn media() -> impl Strategy<Value = Scattering> {
    let medium = (0.0..10.0f64, 1e-3..100.0f64, 1.0..2.0f64).prop_map(|(a, s, n)| Medium {
        sigma_a_per_mm: a,
        sigma_s_reduced_per_mm: s,
        refractive_index: n,
    });
    prop::array::uniform3(medium).prop_map(Scattering::Medium)
}

/// Absorption, scattering, index and thickness of a layer in each channel, and whether it may be endless.
type LayerRow = ([(f64, f64, f64, f64); 3], bool);

/// Two to four layers, the last one endless or not.
fn layers() -> impl Strategy<Value = Scattering> {
    let layer = (0.0..10.0f64, 1e-3..100.0f64, 1.0..2.0f64, 1e-3..50.0f64);
    let rows = prop::collection::vec((prop::array::uniform3(layer), any::<bool>()), 2..5);
    rows.prop_map(|rows| {
        let last = rows.len() - 1;
        Scattering::Layers([0, 1, 2].map(|channel| {
            let layer = |(i, (row, endless)): (usize, &LayerRow)| {
                let (sigma_a_per_mm, sigma_s_reduced_per_mm, refractive_index, _) = row[channel];
                let medium = Medium { sigma_a_per_mm, sigma_s_reduced_per_mm, refractive_index };
                let thickness_mm = if i == last && *endless { f64::INFINITY } else { row[0].3 };
                TissueLayer { medium, thickness_mm }
            };
            rows.iter().enumerate().map(layer).collect()
        }))
    })
}

fn scatterings() -> impl Strategy<Value = Scattering> {
    let rows = prop::collection::vec((1e-6..10.0f64, prop::array::uniform3(-0.5..1.0f64)), 1..7);
    prop_oneof![
        prop::sample::select(vec!["three-layer-skin", "skin1", "ketchup"])
            .prop_map(|name| Scattering::Preset(name.to_owned())),
        media(),
        layers(),
        rows.prop_map(|rows| Scattering::Kernel(RgbGaussianSum::from_rows(rows))),
    ]
}

fn materials() -> impl Strategy<Value = Material> {
    let shares = prop::array::uniform3(0.0..1.0f32);
    let layers = prop::collection::vec(vectors(0.0..1.0), 0..3);
    let second = prop::option::of((media(), 0.0..1.0f32));
    let numbers = (scatterings(), vectors(0.0..1.0), shares, 0.0..10.0f32, 0.0..1e6f32, (layers, second));
    numbers.prop_map(
        |(scattering, albedo, [albedo_mix, roughness, f0], rho_s, thickness_scale, (under, second))| {
            let is_medium = matches!(&scattering, Scattering::Medium(_));
            Material {
                scattering,
                albedo: ColourMap { factor: albedo, texture: None },
                albedo_mix,
                rho_s: ScalarMap::constant(rho_s),
                roughness: ScalarMap::constant(roughness),
                f0,
                thickness_scale,
                mean_free_path_scale: ScalarMap::constant(0.1 + 9.9 * roughness),
                under: under.into_iter().map(|factor| ColourMap { factor, texture: None }).collect(),
                mixed_with: second.filter(|_| is_medium).map(|(scattering, share)| SecondMedium {
                    scattering,
                    share: ScalarMap::constant(share),
                }),
                ..Material::default()
            }
        },
    )
}

fn lights() -> impl Strategy<Value = Light> {
    let places = || vectors(-1e5..1e5);
    let strengths = || prop_oneof![vectors(0.0..1e5), (0.0..1e5f32).prop_map(Vec3::splat)];
    prop_oneof![
        (directions(), strengths(), 0.0..0.78f32).prop_map(|(dir_to_light, irradiance_w_per_m2, angle)| {
            Light::Directional { dir_to_light, irradiance_w_per_m2, angular_radius_rad: angle }
        }),
        (places(), strengths(), 0.0..1e4f32).prop_map(|(position_mm, intensity_w_per_sr, radius_mm)| {
            Light::Point { position_mm, intensity_w_per_sr, radius_mm }
        }),
        (places(), directions(), strengths(), 0.0..0.7f32, 0.71..1.57f32, 0.0..1e4f32).prop_map(
            |(position_mm, dir_travel, intensity_w_per_sr, inner_cone_rad, outer_cone_rad, radius_mm)| {
                Light::Spot {
                    position_mm,
                    dir_travel,
                    intensity_w_per_sr,
                    inner_cone_rad,
                    outer_cone_rad,
                    radius_mm,
                }
            }
        ),
        (places(), directions(), directions(), strengths(), 0.01..10.0f32, 0.0..1e4f32, (pairs(), pairs()))
            .prop_map(|(position_mm, dir, up, intensity_w_per_sr, tan_half_height, radius_mm, moved)| {
                let (shift, drift_per_s) = moved;
                let image = Arc::new(Texture::new(1, 1, Texels::Srgb8(vec![[10, 20, 30, 255]])));
                let axes = Projector::axes(dir, up);
                Light::Projector(Projector {
                    position_mm,
                    axes,
                    tan_half_height,
                    image,
                    intensity_w_per_sr,
                    radius_mm,
                    shift,
                    drift_per_s,
                })
            }),
    ]
}

fn cameras() -> impl Strategy<Value = Camera> {
    (vectors(-1e6..1e6), vectors(-1e6..1e6), directions(), 0.002..2.96f32, -32.0..32.0f32).prop_map(
        |(position_mm, look_at_mm, up, vertical_fov_rad, exposure_ev)| Camera {
            position_mm,
            look_at_mm,
            up,
            vertical_fov_rad,
            exposure_ev,
        },
    )
}

fn waves() -> impl Strategy<Value = Option<Wave>> {
    prop::option::of((0.0..50.0f32, 1.0..500.0f32, -100.0..100.0f32, directions()).prop_map(
        |(amplitude_mm, wavelength_mm, phase_rad, travel)| Wave {
            direction: travel.any_orthonormal_vector(),
            travel,
            ..Wave::sideways(amplitude_mm, wavelength_mm, phase_rad)
        },
    ))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_scene_of_numbers(
        material in materials(),
        lights in prop::collection::vec(lights(), 0..5),
        sky in prop::option::of((-6.0..6.0f32, vectors(0.0..100.0), any::<bool>())),
        camera in cameras(),
        background in prop::option::of(vectors(0.0..1e6)),
        wave in waves(),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let mut scene = read(&write(folder.path(), "square.obj", SQUARE_OBJ));
        scene.objects[0].material = material;
        (scene.lights, scene.camera, scene.background) = (lights, camera, background);
        scene.environment = sky.map(|(rotation_rad, radiance_scale, visible)| {
            Environment { rotation_rad, radiance_scale, visible, ..studio_environment() }
        });
        scene.set_pose(&Pose { wave, ..Pose::default() }).unwrap();
        assert_same(&scene, &there_and_back(&scene, &folder.path().join("scene.toml")));
    }
}

#[test]
fn the_same_place_of_a_texture_is_read_after_saving() {
    let folder = tempfile::tempdir().unwrap();
    let mut scene = read(&write(folder.path(), "square.obj", SQUARE_OBJ));
    let texels = (0..64u8).map(|i| [i, 255 - i, 7, 255]).collect();
    scene.objects[0].material.albedo.texture = Some(Arc::new(Texture::new(8, 8, Texels::Srgb8(texels))));
    let back = there_and_back(&scene, &folder.path().join("scene.toml"));
    let at = |scene: &Scene| scene.objects[0].material.albedo.at(Vec2::new(0.3, 0.8));
    assert_eq!(at(&scene), at(&back));
}
