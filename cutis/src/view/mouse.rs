//! Drags and wheel over the picture.

use super::look::{LightLook, Look};
use super::orbit;
use eframe::egui::{PointerButton, Response, Ui};
use glam::Vec2;

/// Turn of a drag over the whole height of the picture, rad.
const TURN_RAD: f32 = 3.0;
/// Growth of a drag over the whole height of the picture, as a power of e.
const GROWTH: f32 = 2.5;
/// Growth per point of the wheel.
const WHEEL: f32 = 2e-3;

/// A movement of the mouse over the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Movement {
    /// Around the scene: right and down, in heights of the picture.
    Orbit(Vec2),
    /// Along with the scene.
    Pan(Vec2),
    /// Nearer by a factor.
    Zoom(f32),
    /// The light that follows the mouse.
    Light(Vec2),
}

/// What the mouse did since the last frame.
pub fn movement(ui: &Ui, response: &Response) -> Option<Movement> {
    let height = response.rect.height().max(1.0);
    let delta = response.drag_delta() / height;
    let by = Vec2::new(delta.x, delta.y);
    let (modifiers, wheel) = ui.input(|input| (input.modifiers, input.smooth_scroll_delta.y));
    let dragged = |button| response.dragged_by(button) && by != Vec2::ZERO;
    if dragged(PointerButton::Primary) {
        return Some(if modifiers.shift { Movement::Light(by) } else { Movement::Orbit(by) });
    }
    if dragged(PointerButton::Middle) {
        return Some(Movement::Pan(by));
    }
    if dragged(PointerButton::Secondary) {
        return Some(Movement::Zoom((GROWTH * (by.x - by.y)).exp()));
    }
    (response.hovered() && wheel != 0.0).then(|| Movement::Zoom((WHEEL * wheel).exp()))
}

impl Movement {
    /// Moves what it moves. `light` is the number of the light that follows the mouse.
    pub fn apply(self, look: &mut Look, light: usize) {
        match self {
            Movement::Orbit(by) => orbit::orbit(&mut look.camera, by * TURN_RAD),
            Movement::Pan(by) => orbit::pan(&mut look.camera, by),
            Movement::Zoom(factor) => orbit::zoom(&mut look.camera, factor),
            Movement::Light(by) => {
                if let Some(light) = look.lights.get_mut(light) {
                    turn(light, by);
                }
            }
        }
    }
}

fn turn(light: &mut LightLook, by: Vec2) {
    let degrees = TURN_RAD.to_degrees();
    // The light goes where the pointer goes: to the right of the picture, and up.
    light.turn_degrees = wrapped(light.turn_degrees + by.x * degrees);
    light.lift_degrees = (light.lift_degrees - by.y * degrees).clamp(-89.0, 89.0);
}

fn wrapped(degrees: f32) -> f32 {
    (degrees + 180.0).rem_euclid(360.0) - 180.0
}
