//! A window of a small head, and what a person does in it.

use crate::backend::Backend;
use crate::scene_source::SceneSource;
use crate::view::app::Viewer;
use crate::view::keys::TECHNIQUE_KEYS;
use crate::view::look::Drawing;
use cutis_render::TechniqueName;
use cutis_scene::ReadOptions;
use cutis_scene::head::HeadDetail;
use eframe::egui::{self, Event, Key, Modifiers, PointerButton, Pos2, Vec2};
use egui_kittest::Harness;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Longest wait for a picture.
const PATIENCE: Duration = Duration::from_secs(120);

/// A window.
pub type Window = Harness<'static, Viewer>;

/// A window on a small built-in head, drawn by a backend.
pub fn window(size: [f32; 2], backend: Backend) -> Window {
    let source = SceneSource {
        file: None,
        options: ReadOptions::default(),
        environment: None,
        detail: HeadDetail { triangles: 4000, map_size: 64 },
        material: None,
        longest_side_mm: None,
        time_s: 0.0,
    };
    let scene = source.load().expect("the built-in head is valid");
    let drawing = Drawing { backend, irradiance_size: 128, ..Drawing::default() };
    let context = egui::Context::default();
    let viewer = Viewer::new(&context, source, scene, drawing).expect("there are threads");
    Harness::builder()
        .with_size(size)
        .with_max_steps(8)
        .build_ui_state(|ui, viewer: &mut Viewer| viewer.show(ui), viewer)
}

/// The processor, and a graphics adapter where there is one; `CUTIS_REQUIRE_GPU=1` forbids to do without.
pub fn backends(test: &str) -> Vec<Backend> {
    match cutis_gpu::Gpu::find(cutis_gpu::Adapters::Any) {
        Ok(_) => vec![Backend::Cpu, Backend::Gpu],
        Err(why) => {
            let required = std::env::var_os("CUTIS_REQUIRE_GPU").is_some_and(|v| v == "1");
            assert!(!required, "{test}: {why}");
            eprintln!("SKIPPED: {test} on a graphics adapter: {why}");
            vec![Backend::Cpu]
        }
    }
}

/// Draws until nothing better will come.
pub fn settle(window: &mut Window) {
    let start = Instant::now();
    window.step();
    while !window.state().is_settled() {
        assert!(start.elapsed() < PATIENCE, "no picture: {:?}", window.state().failure(0));
        std::thread::sleep(Duration::from_millis(5));
        window.step();
    }
    window.step();
}

/// Presses and lets go of a key.
pub fn press(window: &mut Window, key: Key) {
    window.key_press(key);
    window.step();
}

/// The key of a technique.
pub fn key_of(technique: TechniqueName) -> Key {
    let place = TechniqueName::ALL.iter().position(|one| *one == technique).expect("is listed");
    TECHNIQUE_KEYS[place]
}

/// Drags from one place to another.
pub fn drag(window: &mut Window, from: Pos2, by: Vec2, button: PointerButton, modifiers: Modifiers) {
    let pressed = |pos, pressed| Event::PointerButton { pos, button, pressed, modifiers };
    for events in [
        vec![Event::PointerMoved(from)],
        vec![pressed(from, true)],
        vec![Event::PointerMoved(from + 0.5 * by)],
        vec![Event::PointerMoved(from + by)],
        vec![pressed(from + by, false)],
    ] {
        window.input_mut().events.push(Event::ModifiersChanged(modifiers));
        window.input_mut().events.extend(events);
        window.step();
    }
    window.input_mut().events.push(Event::ModifiersChanged(Modifiers::NONE));
}

/// A file that is dropped.
#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

/// Drops a file into the window.
pub fn drop_file(window: &mut Window, path: &Path) {
    window.input_mut().dropped_files.push(Arc::new(Dropped(path.to_owned())));
    window.step();
}

/// Waits until a dropped scene has been read, or refused.
pub fn message(window: &mut Window) -> String {
    let start = Instant::now();
    loop {
        window.step();
        let message = window.state().message.clone().unwrap_or_default();
        if message != "reading …" {
            return message;
        }
        assert!(start.elapsed() < PATIENCE, "still reading");
        std::thread::sleep(Duration::from_millis(5));
    }
}
