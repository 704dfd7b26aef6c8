//! The mean of pictures of one look that differ by their patterns only.

use cutis_render::{Frame, Layer};
use glam::{DVec4, Vec4};

/// Sums of radiance and layers.
pub struct Mean {
    count: u32,
    pixels: Vec<DVec4>,
    /// In the order of the frame's layers.
    layers: Vec<Vec<DVec4>>,
}

impl Mean {
    /// Of one picture.
    pub fn of(frame: &Frame) -> Self {
        let layers = frame.layers.iter().map(|layer| wide(&layer.pixels)).collect();
        Self { count: 1, pixels: wide(&frame.pixels), layers }
    }

    /// Takes in one more, which becomes the mean of all.
    ///
    /// # Panics
    /// If it has another size or other layers.
    pub fn take_in(&mut self, frame: &mut Frame) {
        assert_eq!(self.layers.len(), frame.layers.len(), "pictures of one look have the same layers");
        self.count += 1;
        average(&mut self.pixels, &mut frame.pixels, self.count);
        for (sums, Layer { pixels, .. }) in self.layers.iter_mut().zip(&mut frame.layers) {
            average(sums, pixels, self.count);
        }
    }

    /// How many there are.
    pub fn count(&self) -> u32 {
        self.count
    }
}

/// Sums of f64 lose nothing of so few f32 of one size.
fn wide(pixels: &[Vec4]) -> Vec<DVec4> {
    pixels.iter().map(|pixel| pixel.as_dvec4()).collect()
}

fn average(sums: &mut [DVec4], pixels: &mut [Vec4], count: u32) {
    assert_eq!(sums.len(), pixels.len(), "pictures of one look have the same size");
    for (sum, pixel) in sums.iter_mut().zip(pixels) {
        *sum += pixel.as_dvec4();
        *pixel = (*sum / f64::from(count)).as_vec4();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(k: u32) -> Frame {
        let pixel = |i: u32| Vec4::new(0.1, 1e-6, 1e4, 1.0) * (1.0 + ((i * 7 + k * 13) % 11) as f32);
        let pixels: Vec<_> = (0..12).map(pixel).collect();
        let layer = Layer {
            name: "diffuse".to_owned(),
            width: 4,
            height: 3,
            channels: Vec::new(),
            pixels: pixels.iter().map(|p| *p * 0.5).collect(),
        };
        Frame { width: 4, height: 3, pixels, layers: vec![layer], ..Frame::default() }
    }

    #[test]
    fn the_mean_of_many_pictures_is_exact() {
        let mut mean = Mean::of(&frame(0));
        let mut last = frame(0);
        for k in 1..64 {
            last = frame(k);
            mean.take_in(&mut last);
        }
        assert_eq!(mean.count(), 64);
        for i in 0..12 {
            let exact = |of: &dyn Fn(&Frame) -> Vec4| {
                let sum: DVec4 = (0..64).map(|k| of(&frame(k)).as_dvec4()).sum();
                (sum / 64.0).as_vec4()
            };
            assert_eq!(last.pixels[i], exact(&|f| f.pixels[i]));
            assert_eq!(last.layers[0].pixels[i], exact(&|f| f.layers[0].pixels[i]));
        }
    }

    #[test]
    fn pictures_that_are_all_alike_are_their_own_mean() {
        let mut mean = Mean::of(&frame(3));
        for _ in 1..7 {
            let mut same = frame(3);
            mean.take_in(&mut same);
            assert_eq!(same.pixels, frame(3).pixels);
        }
    }
}
