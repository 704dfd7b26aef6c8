//! Images of projectors, one after the other in one buffer: no pass is short of buffers, while textures are few.

use crate::{Gpu, GpuError};
use cutis_scene::{Light, Scene, Texture};
use glam::Vec3;
use std::sync::Arc;

/// Most texels of all images together: eight bytes each, in the 128 MiB that every device grants a buffer.
pub const MAX_TEXELS: u64 = 1 << 24;

/// Added to exponents, so that none is negative; also in `lib/lights.wgsl`.
pub const EXPONENT: f32 = 128.0;

/// The images that the projectors of a scene throw.
#[derive(Debug)]
pub struct Slides {
    /// Linear colours: red and green in the first word, blue and the exponent of all three in the second.
    pub texels: wgpu::Buffer,
    images: Vec<Arc<Texture>>,
}

impl Slides {
    /// Finds out whether all of them fit.
    ///
    /// # Errors
    /// If they do not.
    pub fn check(scene: &Scene) -> Result<(), GpuError> {
        let texels: u64 =
            images(scene).map(|image| u64::from(image.width()) * u64::from(image.height())).sum();
        if texels > MAX_TEXELS {
            let size = format!("{texels} texels");
            return Err(GpuError::TooLarge { what: "what all projectors throw", size, limit: MAX_TEXELS });
        }
        Ok(())
    }

    /// Uploads them, in the order of the lights.
    ///
    /// # Errors
    /// If they do not fit.
    pub fn new(gpu: &Gpu, scene: &Scene) -> Result<Self, GpuError> {
        Self::check(scene)?;
        let images: Vec<_> = images(scene).cloned().collect();
        let texels: Vec<_> = images.iter().flat_map(|image| packed(image)).collect();
        Ok(Self { texels: gpu.storage("slides", &texels), images })
    }

    /// Whether other lights throw the same.
    pub fn serve(&self, scene: &Scene) -> bool {
        let others: Vec<_> = images(scene).collect();
        others.len() == self.images.len() && others.iter().zip(&self.images).all(|(a, b)| Arc::ptr_eq(a, b))
    }
}

/// Numbers of the first texel of each light's image; 0 for those that throw none.
pub fn first_texels(lights: &[Light]) -> impl Iterator<Item = u32> {
    let mut next = 0;
    lights.iter().map(move |light| match light {
        Light::Projector(projector) => {
            let first = next;
            next += projector.image.width() * projector.image.height();
            first
        }
        _ => 0,
    })
}

fn images(scene: &Scene) -> impl Iterator<Item = &Arc<Texture>> {
    scene.lights.iter().filter_map(|light| match light {
        Light::Projector(projector) => Some(&projector.image),
        _ => None,
    })
}

fn packed(image: &Texture) -> impl Iterator<Item = [u32; 2]> {
    let places = (0..image.height()).flat_map(|y| (0..image.width()).map(move |x| (x, y)));
    places.map(|(x, y)| packed_texel(image.texel(x, y).truncate().max(Vec3::ZERO)))
}

/// 16 bits for each channel, times two to the power that the brightest of them needs.
fn packed_texel(colour: Vec3) -> [u32; 2] {
    let exponent = colour.max_element().max(f32::MIN_POSITIVE).log2().ceil().clamp(-100.0, 127.0);
    let [r, g, b] = (colour / exponent.exp2()).to_array().map(|c| (c.min(1.0) * 65_535.0).round() as u32);
    [r | g << 16, b | ((exponent + EXPONENT) as u32) << 16]
}
