//! Every view, every key, every preset: what is asked for is what is drawn.

use super::drive::{backends, drag, drop_file, key_of, message, press, settle, window};
use crate::backend::Backend;
use crate::view::look::Look;
use crate::view::screen::picture;
use crate::view::shown::View;
use cutis_render::{Aov, TechniqueName};
use cutis_scene::Wave;
use eframe::egui::{Key, Modifiers, PointerButton, Vec2, pos2, vec2};
use egui_kittest::kittest::Queryable;

const SIZE: [f32; 2] = [640.0, 420.0];
/// A scene that is read and drawn at once.
const TRIANGLE: &str = "v 0 0 0\nv 10 0 0\nv 0 10 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";

/// The picture on the screen, as bytes.
fn pixels(window: &super::drive::Window) -> Vec<u8> {
    let painted = window.state().sides[0].painted.as_ref().expect("something is drawn");
    painted.image.pixels.iter().flat_map(|p| p.to_array()).collect()
}

/// Fails without a flood of bytes.
fn assert_same(got: &[u8], expected: &[u8], what: &str) {
    assert_eq!(got.len(), expected.len(), "{what}: another size");
    let off = got.iter().zip(expected).filter(|(a, b)| a != b).count();
    assert_eq!(off, 0, "{what}: bytes differ");
}

#[test]
fn the_head_is_drawn_and_turns_with_the_mouse() {
    let mut window = window(SIZE, Backend::Cpu);
    settle(&mut window);
    let before = pixels(&window);
    assert!(before.chunks(4).any(|p| p[0] > 100), "a head is seen");
    let camera = window.state().looks[0].camera;
    for (button, modifiers) in [
        (PointerButton::Primary, Modifiers::NONE),
        (PointerButton::Primary, Modifiers::ALT),
        (PointerButton::Secondary, Modifiers::ALT),
        (PointerButton::Middle, Modifiers::ALT),
    ] {
        let camera = window.state().looks[0].camera;
        drag(&mut window, pos2(100.0, 150.0), vec2(40.0, 15.0), button, modifiers);
        assert_ne!(window.state().looks[0].camera, camera, "{button:?} {modifiers:?}");
    }
    settle(&mut window);
    assert!(pixels(&window) != before, "nothing has changed");
    window.state_mut().looks[0].camera = camera;
    settle(&mut window);
    assert_same(&pixels(&window), &before, "back where it was");
}

#[test]
fn shift_moves_the_light_and_not_the_camera() {
    let mut window = window(SIZE, Backend::Cpu);
    settle(&mut window);
    let (before, look) = (pixels(&window), window.state().looks[0].clone());
    drag(&mut window, pos2(100.0, 150.0), vec2(60.0, 30.0), PointerButton::Primary, Modifiers::SHIFT);
    assert_eq!(window.state().looks[0].camera, look.camera);
    assert_ne!(window.state().looks[0].lights, look.lights);
    settle(&mut window);
    assert!(pixels(&window) != before, "nothing has changed");
}

#[test]
fn every_view_is_drawn_and_tells_its_values() {
    backends("every_view_is_drawn_and_tells_its_values").into_iter().for_each(every_view_is_drawn);
}

fn every_view_is_drawn(backend: Backend) {
    let mut window = window(SIZE, backend);
    let views = window.state().views();
    let mut pictures = Vec::new();
    for view in views {
        settle(&mut window);
        assert_eq!(window.state().shown.view, view);
        let side = &window.state().sides[0];
        let failure = window.state().failure(0);
        assert!(failure.is_none(), "{view:?}: {failure:?}");
        match view {
            View::Maps => {
                let what = "irradiance, stretch, six levels, thickness, charts, seams, shadow samples";
                assert_eq!(side.maps.len(), 12, "{what}")
            }
            // Gaussians narrower than the few texels here are wide change nothing.
            View::Layer(Aov::Blur(0..=3)) => {}
            View::Layer(aov) => {
                let value = side.value([0.5, 0.5]).expect("the middle has a value");
                assert!(value.starts_with(&aov.to_string()), "{value}");
                pictures.push((pixels(&window), aov));
            }
            _ => assert!(side.value([0.5, 0.5]).expect("a value").contains("W/(m² sr)")),
        }
        press(&mut window, Key::D);
    }
    assert_eq!(window.state().shown.view, View::Picture, "round and round");
    for (i, (picture, aov)) in pictures.iter().enumerate() {
        let twin = pictures[..i].iter().find(|(other, _)| other == picture);
        assert!(twin.is_none(), "{aov} looks like {}", twin.map_or(*aov, |(_, other)| *other));
    }
}

#[test]
fn a_map_is_seen_in_full_and_a_gaussian_can_be_left_out() {
    let mut window = window(SIZE, Backend::Cpu);
    settle(&mut window);
    let before = pixels(&window);
    window.state_mut().looks[0].drawing.muted_gaussians = vec![0, 1];
    settle(&mut window);
    let without = pixels(&window);
    let sum = |bytes: &[u8]| bytes.iter().map(|&b| u64::from(b)).sum::<u64>();
    assert!(sum(&without) < sum(&before), "less light comes out");
    for aov in crate::view::shown::texture_maps() {
        window.state_mut().shown.view = View::Map(aov);
        settle(&mut window);
        assert!(window.state().sides[0].map(aov).is_some(), "{aov}");
    }
}

#[test]
fn every_preset_is_drawn_and_the_panel_resets() {
    let mut window = window(SIZE, Backend::Cpu);
    settle(&mut window);
    let before = pixels(&window);
    for preset in ["marble", "ketchup"] {
        window.state_mut().looks[0].skin.preset = Some(preset.to_owned());
        window.state_mut().looks[0].skin.free_path = [2.0, 1.0, 0.5];
        settle(&mut window);
        assert!(window.state().failure(0).is_none());
        assert!(pixels(&window) != before, "{preset}");
    }
    let original = window.state().original.clone();
    window.state_mut().looks[0] = original;
    settle(&mut window);
    assert_same(&pixels(&window), &before, "the picture");
}

#[test]
fn a_quality_is_chosen_in_the_panel_and_drawn() {
    for backend in backends("a_quality_is_chosen_in_the_panel_and_drawn") {
        let mut window = window([900.0, 1400.0], backend);
        settle(&mut window);
        let before = pixels(&window);
        for label in ["quality", "low"] {
            window.get_by_label(label).click();
            window.run_steps(4);
        }
        let drawing = &window.state().looks[0].drawing;
        assert_eq!((drawing.quality.to_string().as_str(), drawing.irradiance_size), ("low", 1024));
        window.state_mut().looks[0].drawing.irradiance_size = 128;
        settle(&mut window);
        assert!(window.state().failure(0).is_none(), "{:?}", window.state().failure(0));
        assert!(pixels(&window) != before, "{backend}: one sample a pixel is not sixteen");
    }
}

#[test]
fn a_thinner_body_lets_more_light_through() {
    for backend in backends("a_thinner_body_lets_more_light_through") {
        let mut window = window(SIZE, backend);
        let sum = |window: &super::drive::Window| pixels(window).iter().map(|&b| u64::from(b)).sum::<u64>();
        settle(&mut window);
        let as_it_is = sum(&window);
        window.state_mut().looks[0].skin.thickness = 0.2;
        settle(&mut window);
        assert!(sum(&window) > as_it_is, "{backend}");
    }
}

#[test]
fn two_looks_are_compared_and_the_truth_refines() {
    let mut window = window([420.0, 320.0], Backend::Cpu);
    press(&mut window, Key::M);
    press(&mut window, Key::S);
    window.state_mut().edited = 1;
    press(&mut window, key_of(TechniqueName::Truth));
    assert_eq!(window.state().looks[1].drawing.technique, TechniqueName::Truth);
    assert_eq!(window.state().looks[0].drawing.technique, TechniqueName::TextureSpace);
    let refined = |window: &super::drive::Window| {
        window.state().sides[1].painted.as_ref().is_some_and(|p| p.quality.ends_with("of 4096 samples"))
    };
    let start = std::time::Instant::now();
    while !refined(&window) {
        assert!(start.elapsed().as_secs() < 120, "the truth gets no better");
        std::thread::sleep(std::time::Duration::from_millis(20));
        window.step();
    }
    // While it refines, another wish is fulfilled without waiting for its end.
    press(&mut window, Key::S);
    settle(&mut window);
}

#[test]
fn what_is_dropped_is_opened_or_refused_in_words() {
    let mut window = window(SIZE, Backend::Cpu);
    settle(&mut window);
    let before = pixels(&window);
    let folder = tempfile::tempdir().expect("a folder");
    for (name, bytes) in [
        ("broken.glb", &b"glTF, but not really"[..]),
        ("broken.obj", b"v 1 2 nonsense"),
        ("broken.hdr", b"#?RADIANCE"),
        ("broken.toml", b"[mesh"),
        ("picture.xyz", b""),
    ] {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).expect("is written");
        drop_file(&mut window, &path);
        let told = message(&mut window);
        assert!(told.contains(name), "{name}: {told}");
        settle(&mut window);
        assert_same(&pixels(&window), &before, name);
    }
    let path = folder.path().join("triangle.obj");
    std::fs::write(&path, TRIANGLE).expect("is written");
    drop_file(&mut window, &path);
    message(&mut window);
    settle(&mut window);
    assert_eq!(window.state().scene.objects[0].mesh.triangles.len(), 1);
    assert!(pixels(&window) != before, "nothing has changed");
}

#[test]
fn no_picture_of_the_scene_before_is_shown_for_the_next() {
    let mut window = window(SIZE, Backend::Cpu);
    // The head's picture is under way when another scene comes.
    window.step();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("triangle.obj");
    std::fs::write(&path, TRIANGLE).expect("is written");
    drop_file(&mut window, &path);
    message(&mut window);
    let start = std::time::Instant::now();
    while !window.state().is_settled() {
        assert!(start.elapsed().as_secs() < 120, "no picture");
        window.step();
        let side = &window.state().sides[0];
        let shown = side.painted.as_ref().map(|p| p.scene.objects[0].mesh.triangles.len());
        assert!(shown.is_none_or(|triangles| triangles == 1), "{shown:?} triangles are shown");
    }
}

#[test]
fn a_film_needs_no_new_light_and_a_failure_is_of_its_wish() {
    let mut window = window(SIZE, Backend::Cpu);
    settle(&mut window);
    let (before, frame) = (pixels(&window), window.state().sides[0].painted.clone().expect("is drawn").frame);
    window.state_mut().looks[0].film.exposure_ev += 1.0;
    press(&mut window, Key::W);
    settle(&mut window);
    let after = window.state().sides[0].painted.clone().expect("is drawn");
    assert!(std::sync::Arc::ptr_eq(&frame, &after.frame), "the frame is the same");
    assert!(pixels(&window) != before, "nothing has changed");
    // More than a slider reaches is kept.
    window.state_mut().looks[0].film.exposure_ev = 10.0;
    settle(&mut window);
    assert_eq!(window.state().looks[0].film.exposure_ev, 10.0);
    window.state_mut().looks[0].skin.preset = Some("no such".to_owned());
    settle(&mut window);
    assert!(window.state().failure(0).is_some_and(|reason| reason.contains("no such")));
    window.state_mut().looks[0].skin.preset = None;
    window.step();
    assert!(window.state().failure(0).is_none() && !window.state().is_settled());
    settle(&mut window);
}

#[test]
fn a_picture_is_written_and_nowhere_is_told() {
    let mut window = window(SIZE, Backend::Cpu);
    settle(&mut window);
    let folder = tempfile::tempdir().expect("a folder");
    window.state_mut().folder = folder.path().to_owned();
    press(&mut window, Key::P);
    let image = image::open(folder.path().join("cutis-0001.png")).expect("is a picture");
    assert!(image.width() > 100);
    window.state_mut().folder = folder.path().join("none");
    press(&mut window, Key::P);
    assert!(window.state().message.as_deref().is_some_and(|m| m.contains("none")));
}

#[test]
fn a_saved_scene_opens_as_it_was_left() {
    let mut window = window(SIZE, Backend::Cpu);
    drag(&mut window, pos2(100.0, 150.0), vec2(40.0, 15.0), PointerButton::Primary, Modifiers::NONE);
    window.state_mut().looks[0].skin.preset = Some("marble".to_owned());
    window.state_mut().looks[0].skin.thickness = 0.5;
    window.state_mut().looks[0].lights[0].turn_degrees = 40.0;
    window.state_mut().looks[0].pose.wave = Some(Wave::sideways(6.0, 90.0, 1.0));
    settle(&mut window);
    let before = pixels(&window);
    let folder = tempfile::tempdir().expect("a folder");
    window.state_mut().folder = folder.path().to_owned();
    window.state_mut().write_look();
    drop_file(&mut window, &folder.path().join("cutis-0001.toml"));
    let told = message(&mut window);
    settle(&mut window);
    assert_eq!(window.state().original.pose.wave.map(|wave| wave.amplitude_mm), Some(6.0), "{told}");
    assert_eq!(window.state().scene.objects[0].material.thickness_scale, 0.5, "{told}");
    let after = pixels(&window);
    let off = before.iter().zip(&after).filter(|(a, b)| a.abs_diff(**b) > 2).count();
    // Numbers are rounded to text and back; a pixel at the silhouette may fall to the other side.
    assert!(off < before.len() / 500, "{off} of {} differ", before.len());
}

#[test]
fn a_wave_moves_what_is_seen_and_rest_is_rest() {
    for backend in backends("a_wave_moves_what_is_seen_and_rest_is_rest") {
        let mut window = window([500.0, 300.0], backend);
        settle(&mut window);
        let before = pixels(&window);
        window.state_mut().looks[0].pose.wave = Some(Wave::sideways(10.0, 90.0, 0.5));
        settle(&mut window);
        assert!(window.state().failure(0).is_none(), "{:?}", window.state().failure(0));
        assert!(pixels(&window) != before, "{backend}");
        window.state_mut().looks[0].pose.wave = None;
        settle(&mut window);
        assert_same(&pixels(&window), &before, &backend.to_string());
    }
}

#[test]
fn an_adapter_develops_like_the_processor() {
    if !backends("an_adapter_develops_like_the_processor").contains(&Backend::Gpu) {
        return;
    }
    let mut window = window([500.0, 300.0], Backend::Gpu);
    for exposure_ev in [0.0, 1.5] {
        window.state_mut().looks[0].film.exposure_ev = exposure_ev;
        // Another picture, so that it is not the one before that is developed anew.
        window.state_mut().looks[0].camera.position_mm.x += 20.0;
        settle(&mut window);
        let painted = window.state().sides[0].painted.clone().expect("is drawn");
        assert!(
            painted.frame.passes.iter().any(|pass| pass.name == "tone map"),
            "the adapter has developed it"
        );
        let here = picture(&painted.frame, &painted.camera, &painted.look, &painted.scene);
        let pairs = || painted.image.pixels.iter().zip(&here.pixels);
        let most = pairs().flat_map(|(a, b)| (0..3).map(|c| a[c].abs_diff(b[c]))).max();
        let off = pairs().filter(|(a, b)| a != b).count();
        assert!(most <= Some(1), "{most:?} codes");
        // The glow has 16 bits there.
        assert!(off < here.pixels.len() / 20, "{off} of {} differ", here.pixels.len());
    }
}

#[test]
fn a_light_is_moved_without_a_new_scene() {
    for backend in backends("a_light_is_moved_without_a_new_scene") {
        let mut moved = window([500.0, 300.0], backend);
        settle(&mut moved);
        let before = pixels(&moved);
        let change = |look: &mut Look| {
            look.lights[0].turn_degrees = 50.0;
            look.lights[1].strength = 2.0;
            look.surroundings.strength = 0.5;
        };
        change(&mut moved.state_mut().looks[0]);
        settle(&mut moved);
        let after = pixels(&moved);
        assert!(after != before, "{backend}");
        let mut fresh = window([500.0, 300.0], backend);
        change(&mut fresh.state_mut().looks[0]);
        settle(&mut fresh);
        assert_same(&after, &pixels(&fresh), &backend.to_string());
    }
}

#[test]
fn a_turntable_is_written_and_ends_where_it_began() {
    let mut window = window([500.0, 200.0], Backend::Cpu);
    settle(&mut window);
    let folder = tempfile::tempdir().expect("a folder");
    window.state_mut().folder = folder.path().to_owned();
    let camera = window.state().looks[0].camera;
    window.state_mut().begin_turntable(4);
    while window.state().turntable.is_some() {
        settle(&mut window);
    }
    assert_eq!(window.state().looks[0].camera, camera);
    let picture = |n: u32| {
        let path = folder.path().join(format!("turntable-0001/{n:04}.png"));
        image::open(path).expect("is a picture").into_rgb8().into_raw()
    };
    for n in 1..4 {
        assert_ne!(picture(n), picture(n + 1));
    }
    assert!(!folder.path().join("turntable-0001/0005.png").exists());
}

#[test]
fn the_help_lists_every_key_and_everything_can_be_hidden() {
    let mut window = window([900.0, 700.0], Backend::Cpu);
    press(&mut window, Key::F1);
    window.step();
    assert!(window.query_by_label("Keys and mouse").is_some());
    assert!(window.query_by_label_contains("move the light").is_some());
    press(&mut window, Key::F1);
    assert!(window.query_by_label("Skin").is_some());
    press(&mut window, Key::H);
    window.step();
    assert!(window.query_by_label("Skin").is_none());
    press(&mut window, Key::H);
    press(&mut window, Key::M);
    window.step();
    assert!(window.query_by_label("Skin").is_none());
}

#[test]
fn a_window_of_one_point_and_back() {
    let mut window = window(SIZE, Backend::Cpu);
    settle(&mut window);
    let before = pixels(&window);
    for size in [[1.0, 1.0], [300.0, 1.0], [1.0, 300.0]] {
        window.set_size(Vec2::from(size));
        settle(&mut window);
    }
    window.set_size(Vec2::from(SIZE));
    settle(&mut window);
    assert_same(&pixels(&window), &before, "the picture");
}

#[test]
fn nothing_is_drawn_anew_when_nothing_changes() {
    let mut window = window(SIZE, Backend::Cpu);
    settle(&mut window);
    let number = |window: &super::drive::Window| window.state().sides[0].painted.as_ref().map(|p| p.number);
    let before = number(&window);
    window.run_steps(20);
    assert_eq!(number(&window), before);
    assert!(!window.ctx.has_requested_repaint(), "an idle window is not drawn again");
}
