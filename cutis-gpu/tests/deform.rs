//! Poses on both backends: every vertex, the stretch that follows, and whole frames.

mod common;

use common::tolerances;
use common::{assets, difference, head_in_the_studio, renderer, small_frame};
use cutis_gpu::readback::mapped;
use cutis_gpu::scene::geometry::Vertex;
use cutis_gpu::{Gpu, GpuRenderer, GpuScene};
use cutis_render::lit_scene::LitScene;
use cutis_render::passes::atlas::NO_CHART;
use cutis_render::{Aov, AovSpace, CpuRenderer, Renderer, Settings, Silent};
use cutis_scene::studio::studio_lights;
use cutis_scene::{Camera, MorphTarget, Object, Pose, ReadOptions, Scene, Wave, read_scene};
use glam::{Vec3, Vec4};

/// The built-in head with a shape that swells one side of it.
fn head() -> Scene {
    let mut scene = head_in_the_studio();
    let object = scene.objects.remove(0);
    let mut mesh = object.mesh;
    let swell = |p: &Vec3| Vec3::X * (0.15 * p.x.max(0.0)) + Vec3::Z * (0.05 * p.x.max(0.0));
    mesh.morph_targets = vec![MorphTarget {
        name: "swell".to_owned(),
        position_offsets_mm: mesh.positions_mm.iter().map(swell).collect(),
        ..MorphTarget::default()
    }];
    scene.objects.push(Object::new("head", mesh, object.material));
    scene
}

/// The shelf's left hand under the studio's lamps. Without the environment, whose openness stays that of the hand at rest.
fn hand(test: &str) -> Option<Scene> {
    let mut scene = read_scene(&assets(test)?.join("webxr_hand/left.glb"), &ReadOptions::default())
        .expect("the hand is valid");
    scene.environment = None;
    let bounds_mm = scene.bounds_mm().expect("has points");
    scene.lights = studio_lights(bounds_mm);
    scene.camera = Camera::framing(bounds_mm, Vec3::new(0.2, 1.0, 0.2), 0.5);
    scene.background = Some(Vec3::splat(0.02));
    Some(scene)
}

fn waved() -> Pose {
    Pose {
        morph_weights: [("swell".to_owned(), 0.8)].into(),
        wave: Some(Wave::sideways(10.0, 120.0, 0.6)),
        ..Pose::default()
    }
}

/// A hand that points with its index finger.
fn bent() -> Pose {
    let fingers = ["middle", "ring", "pinky"];
    let bones = ["proximal", "intermediate", "distal"];
    let names = fingers.iter().flat_map(|f| bones.map(|bone| format!("{f}-finger-phalanx-{bone}")));
    Pose { joint_degrees: names.map(|name| (name, Vec3::X * -55.0)).collect(), ..Pose::default() }
}

/// A scene on the device, uploaded at rest and then put into a pose.
fn posed_on_gpu(renderer: &GpuRenderer, scene: &Scene, pose: &Pose, settings: &Settings) -> GpuScene {
    let ready = renderer.scene(scene, settings, &Silent).expect("is uploaded");
    ready.draw(&renderer.gpu).expect("is drawn");
    ready.set_pose(&renderer.gpu, scene, pose).expect("is a pose of the scene");
    ready.draw(&renderer.gpu).expect("is drawn");
    ready
}

fn posed_on_cpu(scene: &Scene, pose: &Pose) -> Scene {
    let mut posed = scene.clone();
    posed.set_pose(pose).expect("is a pose of the scene");
    posed
}

fn vertices(gpu: &Gpu, buffer: &wgpu::Buffer) -> Vec<Vertex> {
    let copy = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("vertices to read"),
        size: buffer.size(),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &copy, 0, buffer.size());
    gpu.queue.submit([encoder.finish()]);
    bytemuck::cast_slice(&mapped(gpu, &copy).expect("the device is there")).to_vec()
}

/// Fails where a vertex differs from the processor's.
fn check_vertices(test: &str, scene: &Scene, pose: &Pose) {
    let Some(renderer) = renderer(test) else { return };
    let small = Settings { width: 16, height: 16, irradiance_size: 128, ..small_frame() };
    let ready = posed_on_gpu(renderer, scene, pose, &small);
    let wanted = scene.objects[0].deformed(pose);
    let got = vertices(&renderer.gpu, &ready.objects[0].geometry.vertices);
    let mut worst = [0f32; 3];
    for (v, got) in got.iter().enumerate() {
        let place = (Vec3::from_array(got.position_mm) - wanted.positions_mm[v]).length();
        let normal = (Vec3::from_array(got.normal) - wanted.normals[v]).length();
        let tangent = (Vec4::from_array(got.tangent) - wanted.tangents[v]).length();
        worst = [worst[0].max(place), worst[1].max(normal), worst[2].max(tangent)];
        assert_eq!([got.map_u, got.map_v], wanted.uvs[v].to_array());
        assert_eq!(got.atlas_uv, wanted.in_atlas()[v].to_array());
    }
    eprintln!("{test}: places {} mm, normals {}, tangents {}", worst[0], worst[1], worst[2]);
    assert!(worst[0] <= tolerances::DEFORMED_MM, "{test}: {worst:?}");
    assert!(worst[1].max(worst[2]) <= tolerances::DEFORMED_DIRECTIONS, "{test}: {worst:?}");
}

#[test]
fn every_vertex_of_a_waved_and_swollen_head_is_that_of_the_processor() {
    let test = "every_vertex_of_a_waved_and_swollen_head_is_that_of_the_processor";
    let mut scene = head();
    // Light may lie elsewhere than maps.
    let mesh = &mut scene.objects[0].mesh;
    mesh.atlas_uvs = Some(mesh.uvs.iter().map(|uv| 0.5 * *uv).collect());
    check_vertices(test, &scene, &waved());
}

#[test]
fn every_vertex_of_a_bent_hand_is_that_of_the_processor() {
    let test = "every_vertex_of_a_bent_hand_is_that_of_the_processor";
    let Some(scene) = hand(test) else { return };
    check_vertices(test, &scene, &bent());
    check_vertices(test, &scene, &Pose { wave: Some(Wave::sideways(4.0, 60.0, 1.0)), ..bent() });
}

#[test]
fn stretch_follows_the_pose() {
    let Some(renderer) = renderer("stretch_follows_the_pose") else { return };
    let (scene, settings) = (head(), Settings { width: 32, height: 32, ..small_frame() });
    let ready = posed_on_gpu(renderer, &scene, &waved(), &settings);
    let GpuRenderer { gpu, passes, .. } = renderer;
    let got =
        ready.layers(gpu, passes, &[Aov::Stretch], AovSpace::Texture).expect("is read").remove(0).pixels;
    let posed = posed_on_cpu(&scene, &waved());
    let lit = LitScene::new(&posed, &settings, &Silent).expect("draws");
    let maps = &lit.maps()[0];
    let wanted: Vec<_> = maps.stretch_mm.iter().map(|s| s.extend(0.0).extend(0.0)).collect();
    let inside = |t: usize| maps.atlas.charts.chart[t] != NO_CHART;
    difference(&got, &wanted, inside).check("stretch in a pose", tolerances::STRETCH);
    let resting = LitScene::new(&scene, &settings, &Silent).expect("draws");
    let still: Vec<_> = resting.maps()[0].stretch_mm.iter().map(|s| s.extend(0.0).extend(0.0)).collect();
    assert!(difference(&got, &still, inside).mean > 0.02, "the pose stretches at all");
}

/// Draws a pose on both and compares what is covered in both.
fn same_frame(test: &str, scene: &Scene, pose: &Pose, allowed: tolerances::Tolerance) {
    let Some(renderer) = renderer(test) else { return };
    let cpu = CpuRenderer.render(&posed_on_cpu(scene, pose), &small_frame(), &Silent).expect("draws");
    let ready = posed_on_gpu(renderer, scene, pose, &small_frame());
    let gpu = ready.picture(&renderer.gpu).expect("is drawn");
    difference(&gpu, &cpu.pixels, |_| true).check(test, allowed);
}

#[test]
fn a_waved_head() {
    // Under lamps alone: openness to the environment stays that of the head at rest.
    let scene = Scene { environment: None, ..head() };
    same_frame("a_waved_head", &scene, &waved(), tolerances::WAVED_HEAD);
}

#[test]
fn a_waved_head_in_the_studio_that_was_uploaded_in_its_pose() {
    let test = "a_waved_head_in_the_studio_that_was_uploaded_in_its_pose";
    let Some(renderer) = renderer(test) else { return };
    let posed = posed_on_cpu(&head(), &waved());
    let [cpu, gpu]: [&dyn Renderer; 2] = [&CpuRenderer, renderer];
    let [cpu, gpu] = [cpu, gpu].map(|r| r.render(&posed, &small_frame(), &Silent).expect("draws").pixels);
    difference(&gpu, &cpu, |_| true).check(test, tolerances::WAVED_HEAD);
}

#[test]
fn a_bent_hand() {
    let Some(scene) = hand("a_bent_hand") else { return };
    same_frame("a_bent_hand", &scene, &bent(), tolerances::BENT_HAND);
}

#[test]
fn back_at_rest_the_picture_is_as_it_was() {
    let Some(renderer) = renderer("back_at_rest_the_picture_is_as_it_was") else { return };
    let scene = head();
    let small = Settings { width: 48, height: 48, irradiance_size: 128, ..small_frame() };
    let ready = renderer.scene(&scene, &small, &Silent).expect("is uploaded");
    let picture = |pose: &Pose| {
        ready.set_pose(&renderer.gpu, &scene, pose).expect("is a pose of the scene");
        ready.draw(&renderer.gpu).expect("is drawn");
        ready.picture(&renderer.gpu).expect("is drawn")
    };
    let first = picture(&Pose::default());
    assert_ne!(first, picture(&waved()));
    assert_eq!(first, picture(&Pose::default()));
    let unknown = Pose { morph_weights: [("smile".to_owned(), 1.0)].into(), ..Pose::default() };
    let error = ready.set_pose(&renderer.gpu, &scene, &unknown).expect_err("no such shape").to_string();
    assert!(error.contains("known here: swell"), "{error}");
}

#[test]
fn a_scene_uploaded_in_a_pose_starts_in_it() {
    let Some(renderer) = renderer("a_scene_uploaded_in_a_pose_starts_in_it") else { return };
    let posed = posed_on_cpu(&head(), &waved());
    let small = Settings { width: 16, height: 16, irradiance_size: 128, ..small_frame() };
    let ready = renderer.scene(&posed, &small, &Silent).expect("is uploaded");
    ready.draw(&renderer.gpu).expect("is drawn");
    let got = vertices(&renderer.gpu, &ready.objects[0].geometry.vertices);
    let off =
        |v: usize| (Vec3::from_array(got[v].position_mm) - posed.objects[0].mesh.positions_mm[v]).length();
    assert!((0..got.len()).all(|v| off(v) <= tolerances::DEFORMED_MM));
}
