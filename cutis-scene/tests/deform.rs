//! Meshes in a pose: shapes, joints and the wave, against what each must do to a surface.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{Glb, SQUARE_OBJ, floats, shelf, write};
use cutis_scene::head::{HeadDetail, built_in};
use cutis_scene::{
    Material, Mesh, MorphTarget, Object, Pose, PoseError, ReadOptions, Scene, Wave, read_scene,
};
use glam::{EulerRot, Quat, Vec3};
use serde_json::json;
use std::path::Path;

/// A small head with one shape that makes it twice as large around the origin.
fn head_that_grows() -> Object {
    let head = built_in(HeadDetail { triangles: 4000, map_size: 0 });
    let mut mesh = head.mesh;
    mesh.morph_targets = vec![MorphTarget {
        name: "grow".to_owned(),
        position_offsets_mm: mesh.positions_mm.clone(),
        ..MorphTarget::default()
    }];
    Object::new("head", mesh, Material::default())
}

fn morph(name: &str, weight: f32) -> Pose {
    Pose { morph_weights: [(name.to_owned(), weight)].into(), ..Pose::default() }
}

fn wave(wave: Wave) -> Pose {
    Pose { wave: Some(wave), ..Pose::default() }
}

/// Smallest cosine between two lists of directions.
fn worst_cosine(a: impl Iterator<Item = Vec3>, b: impl Iterator<Item = Vec3>) -> f32 {
    a.zip(b).map(|(a, b)| a.dot(b)).fold(1.0, f32::min)
}

fn tangents(mesh: &Mesh) -> impl Iterator<Item = Vec3> + '_ {
    mesh.tangents.iter().map(|t| t.truncate())
}

#[test]
fn a_shape_of_weight_0_changes_no_bit_and_of_weight_1_is_the_sum() {
    let head = head_that_grows();
    let still = head.deformed(&morph("grow", 0.0));
    assert_eq!(still.positions_mm, head.mesh.positions_mm);
    assert_eq!((&still.normals, &still.tangents), (&head.mesh.normals, &head.mesh.tangents));
    let grown = head.deformed(&morph("grow", 1.0));
    let doubled: Vec<Vec3> = head.mesh.positions_mm.iter().map(|&p| p + p).collect();
    assert_eq!(grown.positions_mm, doubled);
    // Growing turns nothing: what is left is the rounding of offsets.
    assert!(worst_cosine(grown.normals.iter().copied(), head.mesh.normals.iter().copied()) > 1.0 - 1e-6);
    assert!(worst_cosine(tangents(&grown), tangents(&head.mesh)) > 1.0 - 1e-6);
}

#[test]
fn a_shape_that_turns_the_surface_turns_its_frames_although_the_file_says_nothing_of_them() {
    let head = built_in(HeadDetail { triangles: 4000, map_size: 0 });
    let turn = Quat::from_euler(EulerRot::XYZ, 0.4, -0.7, 0.2);
    let mut mesh = head.mesh.clone();
    let offsets = mesh.positions_mm.iter().map(|&p| turn * p - p).collect();
    mesh.morph_targets =
        vec![MorphTarget { name: "turn".to_owned(), position_offsets_mm: offsets, ..MorphTarget::default() }];
    let turned = Object::new("head", mesh, Material::default()).deformed(&morph("turn", 1.0));
    let wanted = head.mesh.normals.iter().map(|&n| turn * n);
    assert!(worst_cosine(turned.normals.iter().copied(), wanted) > 1.0 - 1e-5);
    let wanted = tangents(&head.mesh).map(|t| turn * t);
    assert!(worst_cosine(tangents(&turned), wanted) > 1.0 - 1e-5);
}

#[test]
fn normals_and_tangents_of_the_wave_are_those_of_its_numeric_derivative() {
    let slanted = Vec3::new(1.0, 0.3, 0.2).normalize();
    for wave_now in [
        Wave::sideways(6.0, 80.0, 0.4),
        Wave { direction: slanted, ..Wave::sideways(8.0, 60.0, 2.0) },
        Wave { direction: Vec3::Z, travel: slanted, ..Wave::sideways(5.0, 40.0, -1.0) },
    ] {
        let head = built_in(HeadDetail { triangles: 4000, map_size: 0 });
        let waved = head.deformed(&wave(wave_now));
        let moved = |p: Vec3| (p + wave_now.direction * wave_now.at(p).0).as_dvec3();
        // 0.05 mm: coordinates of 200 mm have 2e-5 mm steps, the wave's curvature errs by the square of this.
        let step = 0.05;
        for v in (0..head.mesh.positions_mm.len()).step_by(37) {
            let (p, n, t) =
                (head.mesh.positions_mm[v], head.mesh.normals[v], head.mesh.tangents[v].truncate());
            let along = |d: Vec3| (moved(p + d * step) - moved(p - d * step)) / f64::from(2.0 * step);
            let (x, y) = (along(t), along(n.cross(t)));
            let normal = x.cross(y).normalize().as_vec3();
            assert!(normal.dot(waved.normals[v]) > 1.0 - 1e-5, "{wave_now:?}: vertex {v}");
            let tangent = x.normalize().as_vec3();
            assert!(tangent.dot(waved.tangents[v].truncate()) > 1.0 - 1e-5, "{wave_now:?}: vertex {v}");
        }
    }
}

#[test]
fn stretch_of_a_grown_surface_grows_with_it() {
    let head = head_that_grows();
    let grown = head.deformed(&morph("grow", 0.5));
    // |dX/du| of every triangle, the measure that every blur is scaled by.
    let along_u = |mesh: &Mesh, t: usize| {
        let ([a, b, c], [p, q, r]) = (mesh.corners_mm(t), mesh.corner_map_uvs(t));
        let (d1, d2) = (q - p, r - p);
        (((b - a) * d2.y - (c - a) * d1.y) / d1.perp_dot(d2)).length()
    };
    for t in (0..head.mesh.triangles.len()).step_by(11) {
        let ratio = along_u(&grown, t) / along_u(&head.mesh, t);
        assert!((ratio - 1.5).abs() < 1e-3, "{ratio}");
    }
}

fn hand(test: &str) -> Option<Scene> {
    let shelf = shelf(test)?;
    Some(read_scene(&shelf.join("webxr_hand/left.glb"), &ReadOptions::default()).unwrap())
}

fn joints(list: &[(&str, Vec3)]) -> Pose {
    let joint_degrees = list.iter().map(|&(name, degrees)| (name.to_owned(), degrees)).collect();
    Pose { joint_degrees, ..Pose::default() }
}

#[test]
fn the_hand_turned_at_the_wrist_turns_as_a_whole() {
    let Some(scene) = hand("the_hand_turned_at_the_wrist_turns_as_a_whole") else { return };
    let object = &scene.objects[0];
    let skeleton = object.rest().skeleton.as_ref().unwrap();
    assert_eq!((skeleton.joints.len(), &*skeleton.joints[0].name), (25, "wrist"));
    let roots = skeleton.joints.iter().filter(|joint| joint.parent.is_none()).count();
    assert_eq!(roots, 1, "all bones hang on the wrist");
    let posed = object.deformed(&joints(&[("wrist", Vec3::new(20.0, -70.0, 40.0))]));
    // The rigid motion about the wrist, in its own axes.
    let turn = glam::Mat4::from_quat(Quat::from_euler(
        EulerRot::ZYX,
        40f32.to_radians(),
        -70f32.to_radians(),
        20f32.to_radians(),
    ));
    let wrist = skeleton.joints[0].parent_from_joint;
    let motion = wrist * turn * wrist.inverse();
    for v in 0..posed.positions_mm.len() {
        let wanted = motion.transform_point3(object.mesh.positions_mm[v]);
        assert!((posed.positions_mm[v] - wanted).length() < 1e-3, "{v}: {} {wanted}", posed.positions_mm[v]);
        let wanted = motion.transform_vector3(object.mesh.normals[v]);
        assert!(posed.normals[v].dot(wanted) > 1.0 - 1e-5, "normal {v}");
        let wanted = motion.transform_vector3(object.mesh.tangents[v].truncate());
        assert!(posed.tangents[v].truncate().dot(wanted) > 1.0 - 1e-5, "tangent {v}");
    }
}

#[test]
fn a_bent_finger_keeps_its_length_and_leaves_the_others_alone() {
    let Some(scene) = hand("a_bent_finger_keeps_its_length_and_leaves_the_others_alone") else { return };
    let object = &scene.objects[0];
    let rest = object.rest();
    let skeleton = rest.skeleton.as_ref().unwrap();
    let number = |name: &str| skeleton.joints.iter().position(|j| j.name == name).unwrap() as u16;
    let posed = object.deformed(&joints(&[("index-finger-phalanx-proximal", Vec3::new(-60.0, 0.0, 0.0))]));
    let moved = |v: usize| (posed.positions_mm[v] - rest.positions_mm[v]).length();
    let mostly = |v: usize, joint: u16| {
        let i = skeleton.influences[v];
        i.joints.iter().zip(i.weights).any(|(&j, w)| j == joint && w > 0.99)
    };
    let all = || 0..rest.positions_mm.len();
    let tip = number("index-finger-tip");
    assert!(all().filter(|&v| mostly(v, tip)).all(|v| moved(v) > 30.0), "the tip follows");
    let pinky = number("pinky-finger-phalanx-distal");
    assert!(all().filter(|&v| mostly(v, pinky)).all(|v| moved(v) < 1e-3), "the little finger stays");
    // Bones are rigid: vertices of the same bone keep their distances.
    let bone: Vec<usize> = all().filter(|&v| mostly(v, number("index-finger-phalanx-distal"))).collect();
    for pair in bone.windows(2) {
        let distance = |mesh: &Mesh| mesh.positions_mm[pair[0]].distance(mesh.positions_mm[pair[1]]);
        assert!((distance(&posed) - distance(rest)).abs() < 1e-3);
    }
}

#[test]
fn unknown_names_are_answered_with_the_known_ones_and_nothing_moves() {
    let Some(mut scene) = hand("unknown_names_are_answered_with_the_known_ones") else { return };
    let before = scene.objects[0].mesh.positions_mm.clone();
    let error = scene.set_pose(&joints(&[("elbow", Vec3::ZERO)])).unwrap_err().to_string();
    assert!(error.contains("no joint `elbow`") && error.contains("thumb-tip"), "{error}");
    let error = scene.set_pose(&morph("smile", 1.0)).unwrap_err().to_string();
    assert!(error.contains("no morph target `smile`; the scene has none"), "{error}");
    assert_eq!(scene.objects[0].mesh.positions_mm, before);
    scene.set_pose(&joints(&[("wrist", Vec3::X * 90.0)])).unwrap();
    assert_ne!(scene.objects[0].mesh.positions_mm, before);
    scene.set_pose(&Pose::default()).unwrap();
    assert_eq!(scene.objects[0].mesh.positions_mm, before, "back at rest, to the bit");
}

#[test]
fn waves_that_fold_or_are_no_waves_are_refused() {
    let mut scene = read_square("");
    for (bad, words) in [
        (Wave { direction: Vec3::Y, ..Wave::sideways(50.0, 10.0, 0.0) }, "folds the surface"),
        (Wave::sideways(1.0, 0.0, 0.0), "wavelength_mm"),
        (Wave::sideways(f32::NAN, 1.0, 0.0), "amplitude_mm"),
        (Wave { travel: Vec3::ZERO, ..Wave::sideways(1.0, 1.0, 0.0) }, "unit vector"),
    ] {
        let error = scene.set_pose(&wave(bad)).unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
    }
    let error = scene.set_pose(&Pose { joint_degrees: [("a".into(), Vec3::NAN)].into(), ..Pose::default() });
    assert!(matches!(error, Err(PoseError::Unknown { .. })));
}

fn read_square(pose: &str) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "square.obj", SQUARE_OBJ);
    let text = format!("[mesh]\npath = \"square.obj\"\nmillimetres_per_unit = 1\n{pose}");
    read_scene(&write(folder.path(), "scene.toml", text), &ReadOptions::default()).unwrap()
}

#[test]
fn pose_keys_of_a_scene_file_arrive() {
    let wave = "wave = { amplitude_mm = 3, wavelength_mm = 50, phase_degrees = 90, direction = [0, 0, 2] }";
    let scene = read_square(&format!("[pose]\n{wave}\n"));
    let wanted = Wave { direction: Vec3::Z, ..Wave::sideways(3.0, 50.0, std::f32::consts::FRAC_PI_2) };
    assert_eq!(scene.pose().wave, Some(wanted));
    // sin(90°) at the lower edge.
    assert!((scene.objects[0].mesh.positions_mm[0] - Vec3::Z * 3.0).length() < 1e-5);
    assert_eq!(scene.objects[0].rest().positions_mm[0], Vec3::ZERO);
}

#[test]
fn errors_in_a_pose_name_the_line_and_the_known_names() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "morph.glb", square_with_a_shape().bytes());
    let toml = |pose: &str| format!("[mesh]\npath = \"morph.glb\"\n[pose]\n{pose}\n");
    let read =
        |pose: &str| read_scene(&write(folder.path(), "scene.toml", toml(pose)), &ReadOptions::default());
    let smiling = read("morph = { smile = 0.25 }").unwrap();
    assert!((smiling.objects[0].mesh.positions_mm[0].z - 2.5).abs() < 1e-4);
    for (pose, words) in [
        ("morph = { smil = 1 }", "line 3, key `pose`: there is no morph target `smil`; known here: smile"),
        ("joints = { wrist = [0, 0, 0] }", "there is no joint `wrist`; the scene has none"),
        ("joints = { wrist = 4 }", "key `pose.joints.wrist`: must be a list of three numbers"),
        ("wave = { amplitude_mm = 1 }", "key `pose.wave.wavelength_mm`: is missing"),
        ("wiggle = 1", "did you mean"),
    ] {
        let error = read(pose).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
    assert!(path.is_file());
}

/// A square of a metre with a shape that lifts it by 10 mm, half in.
fn square_with_a_shape() -> Glb {
    let mut glb = Glb::square();
    let target = glb.add_accessor(&floats(&[0., 0., 0.01].repeat(4)), 5126, 4, "VEC3");
    glb.json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": target }]);
    glb.json["meshes"][0]["weights"] = json!([0.5]);
    glb.json["meshes"][0]["extras"] = json!({ "targetNames": ["smile"] });
    glb
}

#[test]
fn a_file_starts_with_its_own_weights() {
    let folder = tempfile::tempdir().unwrap();
    let scene = read(folder.path(), &square_with_a_shape());
    assert!((scene.objects[0].mesh.positions_mm[1].z - 5.0).abs() < 1e-4);
    assert_eq!(scene.objects[0].rest().positions_mm[1].z, 0.0);
}

fn read(folder: &Path, glb: &Glb) -> Scene {
    read_scene(&write(folder, "it.glb", glb.bytes()), &ReadOptions::default()).unwrap()
}

/// A square on two joints of which the second hangs on the first, each with half of every vertex.
fn skinned_square(weights: &[f32; 4]) -> Glb {
    let mut glb = Glb::square();
    let joints = glb.add_accessor(&[0, 1, 0, 0].repeat(4), 5121, 4, "VEC4");
    let weights = glb.add_accessor(&floats(&weights.repeat(4)), 5126, 4, "VEC4");
    let attributes = &mut glb.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = json!(joints);
    attributes["WEIGHTS_0"] = json!(weights);
    glb.json["skins"] = json!([{ "joints": [2, 1] }]);
    glb.json["nodes"] = json!([
        { "mesh": 0, "skin": 0 },
        { "name": "root", "children": [2] },
        { "name": "tip", "translation": [0.001, 0, 0] }
    ]);
    glb.json["scenes"][0]["nodes"] = json!([0, 1]);
    glb
}

#[test]
fn joints_are_read_parents_first_whatever_their_order_in_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let scene = read(folder.path(), &skinned_square(&[0.5, 0.5, 0.0, 0.0]));
    let skeleton = scene.objects[0].rest().skeleton.as_ref().unwrap();
    let names: Vec<_> = skeleton.joints.iter().map(|j| (j.name.as_str(), j.parent)).collect();
    assert_eq!(names, [("root", None), ("tip", Some(0))]);
    // The file's joint 0 is the tip.
    assert_eq!(skeleton.influences[0].joints[..2], [1, 0]);
    assert!(scene.joint_names().contains("tip"));
}

#[test]
fn skins_that_no_pose_can_turn_are_told_and_drawn_at_rest() {
    let folder = tempfile::tempdir().unwrap();
    let says = |glb: &Glb, words: &str| {
        let scene = read(folder.path(), glb);
        assert!(scene.warnings.iter().any(|w| w.contains(words)), "{words}: {:?}", scene.warnings);
        scene
    };
    says(&skinned_square(&[0.0; 4]), "the weights of 4 vertices sum to 0");
    let mut flat = skinned_square(&[0.5, 0.5, 0.0, 0.0]);
    flat.json["nodes"][1]["scale"] = json!([0.0, 0.0, 0.0]);
    flat.json["nodes"][2]["scale"] = json!([1.0, 1.0, 1.0]);
    let folder_scene = read_scene(&write(folder.path(), "flat.glb", flat.bytes()), &ReadOptions::default());
    // Squashed to a point the square has no triangles left: an error in words, not a panic.
    assert!(folder_scene.unwrap_err().to_string().contains("no triangle"));
    let mut circle = skinned_square(&[0.5, 0.5, 0.0, 0.0]);
    circle.json["nodes"][2]["children"] = json!([1]);
    let error = read_scene(&write(folder.path(), "circle.glb", circle.bytes()), &ReadOptions::default());
    assert!(error.unwrap_err().to_string().contains("circle"));
    for (bad, words) in [([f32::NAN; 4], "has the weight NaN"), ([-1.0; 4], "has the weight -1")] {
        let path = write(folder.path(), "bad.glb", skinned_square(&bad).bytes());
        let error = read_scene(&path, &ReadOptions::default()).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
    let mut far = skinned_square(&[0.5, 0.5, 0.0, 0.0]);
    far.json["skins"][0]["joints"] = json!([2]);
    let error = read_scene(&write(folder.path(), "far.glb", far.bytes()), &ReadOptions::default());
    assert!(error.unwrap_err().to_string().contains("names joint 1, but the skin has 1"));
}
