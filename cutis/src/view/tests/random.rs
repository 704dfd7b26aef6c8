//! Hundreds of things a person might do, at random.

use super::drive::{Window, backends, drag, drop_file, press, settle, window};
use crate::backend::Backend;
use crate::view::keys::{KEYS, TECHNIQUE_KEYS};
use eframe::egui::{
    Event, Modifiers, MouseWheelSource, MouseWheelUnit, PointerButton, TouchPhase, Vec2, pos2, vec2,
};

/// Things done.
const ACTIONS: u32 = 500;
/// Sizes of the window, points.
const SIZES: [[f32; 2]; 5] = [[500.0, 300.0], [200.0, 120.0], [1.0, 1.0], [90.0, 400.0], [640.0, 90.0]];

/// Numbers that look random and are the same every time.
struct Dice(u64);

impl Dice {
    /// A number below `sides`.
    fn roll(&mut self, sides: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % sides
    }

    fn length(&mut self, most: f32) -> f32 {
        self.roll(1000) as f32 / 1000.0 * most
    }
}

fn act(window: &mut Window, dice: &mut Dice, folder: &std::path::Path) {
    let place = pos2(dice.length(640.0), dice.length(420.0));
    let button = [PointerButton::Primary, PointerButton::Middle, PointerButton::Secondary];
    let modifiers = [Modifiers::NONE, Modifiers::ALT, Modifiers::SHIFT, Modifiers::COMMAND];
    match dice.roll(16) {
        0..=5 => {
            let by = vec2(dice.length(300.0) - 150.0, dice.length(300.0) - 150.0);
            let button = button[dice.roll(3) as usize];
            drag(window, place, by, button, modifiers[dice.roll(4) as usize]);
        }
        6..=8 => drag(window, place, Vec2::ZERO, PointerButton::Primary, Modifiers::NONE),
        9..=12 => {
            let keys: Vec<_> = KEYS.iter().map(|(key, ..)| *key).chain(TECHNIQUE_KEYS).collect();
            press(window, keys[dice.roll(keys.len() as u64) as usize]);
        }
        13 => {
            let delta = vec2(0.0, dice.length(2000.0) - 1000.0);
            let unit = MouseWheelUnit::Point;
            let (phase, source) = (TouchPhase::Move, MouseWheelSource::Wheel);
            window.input_mut().events.push(Event::PointerMoved(place));
            let modifiers = Modifiers::NONE;
            window.input_mut().events.push(Event::MouseWheel { unit, delta, modifiers, phase, source });
            window.step();
        }
        14 => {
            window.set_size(Vec2::from(SIZES[dice.roll(SIZES.len() as u64) as usize]));
            window.step();
        }
        _ => {
            let path = folder.join("broken.glb");
            drop_file(window, &path);
        }
    }
}

fn random_actions(backend: Backend, seed: u64) {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("broken.glb"), b"glTF nonsense").expect("is written");
    let mut window = window(SIZES[0], backend);
    window.state_mut().folder = folder.path().to_owned();
    let mut dice = Dice(seed);
    for i in 0..ACTIONS {
        act(&mut window, &mut dice, folder.path());
        let failures: Vec<_> = window.state().sides.iter().filter_map(|side| side.failure.as_ref()).collect();
        assert!(failures.is_empty(), "action {i}: {failures:?}");
    }
    window.set_size(Vec2::from(SIZES[0]));
    let original = window.state().original.clone();
    window.state_mut().looks = [original.clone(), original];
    settle(&mut window);
    assert!(window.state().failure(0).is_none(), "{:?}", window.state().failure(0));
}

#[test]
fn five_hundred_random_actions() {
    for (seed, backend) in (1..).zip(backends("five_hundred_random_actions")) {
        random_actions(backend, seed);
    }
}
