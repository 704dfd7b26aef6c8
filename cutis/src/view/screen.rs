//! From light to what a screen shows: the developed picture, layers in true or false colour, triangles over them.

use super::painter::Developing;
use super::shown::{View, is_scaled};
use super::wireframe;
use cutis_render::film::{self, Film, develop};
use cutis_render::{Aov, Frame, Layer};
use cutis_scene::{Camera, Scene};
use eframe::egui::{Color32, ColorImage};
use glam::{Vec3, Vec4};
use rayon::prelude::*;
use std::f32::consts::PI;

/// Display-linear grey behind what is transparent.
pub const BEHIND: f32 = 0.02;
/// Colours of the least to the greatest of what has no colour of its own: black, purple, orange, pale yellow, even in
/// lightness.
const SCALE: [[u8; 3]; 5] = [[0, 0, 4], [81, 18, 124], [183, 55, 121], [252, 137, 97], [252, 253, 191]];

/// What the camera sees, by the view that was chosen.
pub fn picture(frame: &Frame, camera: &Camera, how: &Developing, scene: &Scene) -> ColorImage {
    let image = match (how.shown.view, frame.layers.first()) {
        (View::Layer(aov), Some(layer)) => layer_image(layer, aov, &how.film),
        _ => developed(frame, &how.film),
    };
    overlaid(image, camera, how, scene)
}

/// An image with what is drawn over it.
pub fn overlaid(mut image: ColorImage, camera: &Camera, how: &Developing, scene: &Scene) -> ColorImage {
    if how.shown.wireframe {
        wireframe::draw_over(&mut image, scene, &how.pose, camera);
    }
    image
}

fn developed(frame: &Frame, film: &Film) -> ColorImage {
    of_codes([frame.width, frame.height], &film::codes(&develop(frame, film), BEHIND))
}

/// An image of 8-bit codes.
pub fn of_codes(size: [u32; 2], codes: &[[u8; 4]]) -> ColorImage {
    image(size, codes.par_iter().map(|&[r, g, b, _]| Color32::from_rgb(r, g, b)).collect())
}

/// A layer: light as the film exposes it, directions as colours, single numbers on a scale of colours.
pub fn layer_image(layer: &Layer, aov: Aov, film: &Film) -> ColorImage {
    let [low, high] = range(layer);
    let gain = film.exposure_ev.exp2();
    let pixel = |(i, p): (usize, &Vec4)| {
        let colour = p.truncate();
        let shown = |linear| encoded(linear, [i as u32 % layer.width, i as u32 / layer.width]);
        match aov {
            Aov::Normal => plain(0.5 + 0.5 * colour),
            Aov::Albedo => shown(colour),
            Aov::Charts => chart_colour(p.x),
            _ if is_scaled(aov) => on_scale((p.x - low) / (high - low).max(f32::MIN_POSITIVE)),
            // As a white sheet in this light would look.
            Aov::Irradiance | Aov::Blur(_) | Aov::Exitance => {
                shown(film.tone_mapper.map(colour * (gain / PI)))
            }
            _ => shown(film.tone_mapper.map(colour * gain)),
        }
    };
    image([layer.width, layer.height], layer.pixels.par_iter().enumerate().map(pixel).collect())
}

/// What the ends of the scale of a layer stand for: of the first channel's numbers above 0, a hundredth lies below and a
/// hundredth above them.
pub fn range(layer: &Layer) -> [f32; 2] {
    let mut values: Vec<f32> =
        layer.pixels.iter().map(|p| p.x).filter(|x| x.is_finite() && *x > 0.0).collect();
    if values.is_empty() {
        return [0.0, 1.0];
    }
    let mut at = |share: f32| {
        let place = (share * (values.len() - 1) as f32) as usize;
        *values.select_nth_unstable_by(place, f32::total_cmp).1
    };
    [at(0.01), at(0.99)]
}

/// A place of the scale of colours, 0 to 1.
fn on_scale(share: f32) -> Color32 {
    // Not a number counts as the least: max takes its other side.
    let place = share.clamp(0.0, 1.0).max(0.0) * (SCALE.len() - 1) as f32;
    let i = (place as usize).min(SCALE.len() - 2);
    let [a, b] = [SCALE[i], SCALE[i + 1]].map(|c| Vec3::from_array(c.map(f32::from)));
    let mixed = a.lerp(b, place - i as f32);
    Color32::from_rgb(mixed.x as u8, mixed.y as u8, mixed.z as u8)
}

/// Neighbouring numbers get colours far apart.
fn chart_colour(number: f32) -> Color32 {
    if number < 0.0 {
        return Color32::BLACK;
    }
    // The golden ratio keeps turning round the circle of hues without ever meeting itself.
    let hue = (number * 0.618_034).fract();
    let channel = |shift: f32| 0.5 + 0.4 * (std::f32::consts::TAU * (hue + shift)).cos();
    plain(Vec3::new(channel(0.0), channel(0.33), channel(0.67)))
}

/// Display-linear light as the screen wants it, dithered by its place.
fn encoded(linear: Vec3, at: [u32; 2]) -> Color32 {
    let [r, g, b] = film::encoded(linear, at);
    Color32::from_rgb(r, g, b)
}

/// A colour that is encoded already.
fn plain(encoded: Vec3) -> Color32 {
    let [r, g, b] = encoded.clamp(Vec3::ZERO, Vec3::ONE).to_array().map(|c| (255.0 * c + 0.5) as u8);
    Color32::from_rgb(r, g, b)
}

fn image(size: [u32; 2], pixels: Vec<Color32>) -> ColorImage {
    ColorImage::new(size.map(|side| side as usize), pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_of_colours_grows_lighter() {
        let lightness = |share: f32| {
            let [r, g, b, _] = on_scale(share).to_array().map(f32::from);
            0.21 * r + 0.72 * g + 0.07 * b
        };
        (0..100).for_each(|i| assert!(lightness(i as f32 / 100.0) <= lightness((i + 1) as f32 / 100.0)));
        assert!(lightness(1.0) > lightness(0.0) + 200.0);
        assert_eq!(on_scale(f32::NAN), on_scale(0.0));
    }

    #[test]
    fn what_is_no_number_or_beyond_all_bounds_has_a_colour() {
        let layer = Layer {
            name: "thickness".to_owned(),
            width: 4,
            height: 1,
            channels: vec!["light0".to_owned()],
            pixels: [f32::NAN, f32::INFINITY, -1.0, 2.0].map(Vec4::splat).to_vec(),
        };
        assert_eq!(range(&layer), [2.0, 2.0]);
        for aov in Aov::all() {
            assert_eq!(layer_image(&layer, aov, &Film::default()).pixels.len(), 4);
        }
    }
}
