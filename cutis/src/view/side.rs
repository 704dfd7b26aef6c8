//! One side of the window: what was drawn last, as textures for the screen.

use super::painter::{Developing, Painted};
use super::screen::{layer_image, picture};
use super::shown::unit;
use cutis_render::film::Film;
use cutis_render::{Aov, Layer};
use eframe::egui::{Context, TextureHandle, TextureOptions};
use glam::Vec4;

/// Largest side of a small picture of a map, texels.
const TILE_TEXELS: u32 = 320;

/// A side.
#[derive(Default)]
pub struct Side {
    /// The picture on the screen.
    pub texture: Option<TextureHandle>,
    /// What it was made from.
    pub painted: Option<Painted>,
    /// Textures of the passes, small.
    pub maps: Vec<Tile>,
    full: Option<(Aov, TextureHandle)>,
    /// Number of the wish that could not be fulfilled, and why.
    pub failure: Option<(u64, String)>,
}

/// A texture of a pass on the screen.
pub struct Tile {
    /// Which one.
    pub aov: Aov,
    /// Small picture of it.
    pub texture: TextureHandle,
    /// Number in the list of maps.
    pub index: usize,
}

impl Side {
    /// Develops the frame that is there anew, where only that has changed.
    pub fn develop(&mut self, context: &Context, number: usize, how: Developing) {
        let Some(painted) = self.painted.as_ref().filter(|painted| painted.look != how) else { return };
        let image = picture(&painted.frame, &painted.camera, &how, &painted.scene);
        self.show(context, number, Painted { image, look: how, ..painted.clone() });
    }

    /// Takes in a new picture.
    pub fn show(&mut self, context: &Context, number: usize, painted: Painted) {
        let film = &painted.look.film;
        let image = painted.image.clone();
        match &mut self.texture {
            Some(texture) => texture.set(image, TextureOptions::LINEAR),
            None => {
                self.texture =
                    Some(context.load_texture(format!("side {number}"), image, TextureOptions::LINEAR));
            }
        }
        let tiles = painted.maps.iter().enumerate().filter_map(|(index, layer)| {
            let aov: Aov = layer.name.parse().ok()?;
            let image = layer_image(&smaller(layer), aov, film);
            let texture = context.load_texture(&layer.name, image, TextureOptions::LINEAR);
            Some(Tile { aov, texture, index })
        });
        self.maps = tiles.collect();
        self.full = None;
        self.failure = None;
        self.painted = Some(painted);
    }

    /// A map in full.
    pub fn map(&self, aov: Aov) -> Option<&Layer> {
        let maps = &self.painted.as_ref()?.maps;
        maps.iter().find(|layer| layer.name == aov.to_string())
    }

    /// A map in full, on the screen.
    pub fn full_map(&mut self, context: &Context, aov: Aov, film: &Film) -> Option<TextureHandle> {
        if self.full.as_ref().is_none_or(|(kept, _)| *kept != aov) {
            let image = layer_image(self.map(aov)?, aov, film);
            self.full = Some((aov, context.load_texture(aov.to_string(), image, TextureOptions::NEAREST)));
        }
        self.full.as_ref().map(|(_, texture)| texture.clone())
    }

    /// What lies under the pointer, a place of the picture from 0 to 1, in words with its unit.
    pub fn value(&self, place: [f32; 2]) -> Option<String> {
        let painted = self.painted.as_ref()?;
        let frame = &painted.frame;
        if let Some(layer) = frame.layers.first() {
            return value_of(layer, place);
        }
        let pixel = texel(&frame.pixels, [frame.width, frame.height], place)?;
        Some(format!("radiance {} W/(m² sr)", numbers(&pixel.to_array()[..3])))
    }
}

/// The numbers of a layer at a place from 0 to 1, in words with their unit.
pub fn value_of(layer: &Layer, place: [f32; 2]) -> Option<String> {
    let aov: Aov = layer.name.parse().ok()?;
    let value = texel(&layer.pixels, [layer.width, layer.height], place)?.to_array();
    let channels = layer.channels.len().min(4);
    Some(format!("{} {} {}", layer.name, numbers(&value[..channels]), unit(aov)).trim_end().to_owned())
}

fn texel(pixels: &[Vec4], size: [u32; 2], place: [f32; 2]) -> Option<Vec4> {
    if place.iter().any(|p| !(0.0..1.0).contains(p)) {
        return None;
    }
    let [x, y] = [0, 1].map(|axis| (place[axis] * size[axis] as f32) as usize);
    pixels.get(y * size[0] as usize + x).copied()
}

fn numbers(values: &[f32]) -> String {
    values.iter().map(|v| format!("{v:.4}")).collect::<Vec<_>>().join(", ")
}

/// Every n-th texel of a layer, so that it is small.
fn smaller(layer: &Layer) -> Layer {
    let step = layer.width.max(layer.height).div_ceil(TILE_TEXELS).max(1);
    let [width, height] = [layer.width, layer.height].map(|side| side.div_ceil(step));
    let texels =
        (0..height).flat_map(|y| (0..width).map(move |x| (y * step * layer.width + x * step) as usize));
    let pixels = texels.map(|i| layer.pixels[i]).collect();
    Layer { name: layer.name.clone(), width, height, channels: layer.channels.clone(), pixels }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layer() -> Layer {
        Layer {
            name: "stretch".to_owned(),
            width: 2,
            height: 1,
            channels: vec!["U".to_owned(), "V".to_owned()],
            pixels: vec![Vec4::ZERO, Vec4::new(0.25, 0.5, 9.0, 9.0)],
        }
    }

    #[test]
    fn a_value_is_told_with_its_unit_and_only_where_there_is_one() {
        assert_eq!(value_of(&layer(), [0.75, 0.5]).as_deref(), Some("stretch 0.2500, 0.5000 mm per texel"));
        assert_eq!(value_of(&layer(), [1.0, 0.5]), None);
        assert_eq!(value_of(&layer(), [f32::NAN, 0.5]), None);
    }

    #[test]
    fn a_small_map_has_texels_of_the_large_one() {
        let wide = Layer { width: 1000, height: 3, pixels: vec![Vec4::ONE; 3000], ..layer() };
        let small = smaller(&wide);
        assert_eq!([small.width, small.height], [250, 1]);
        assert_eq!(small.pixels.len(), 250);
    }
}
