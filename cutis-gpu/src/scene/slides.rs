//! Images of projectors, one after the other in one buffer: no pass is short of buffers, while textures are few.

use crate::{Gpu, GpuError};
use cutis_scene::{Light, Scene, Texture};
use std::sync::Arc;

/// Most texels of all images together: eight bytes each, in the 128 MiB that every device grants a buffer.
pub const MAX_TEXELS: u64 = 1 << 24;

/// The images that the projectors of a scene throw.
#[derive(Debug)]
pub struct Slides {
    /// Linear colours as halves of single precision: red and green in the first word, blue in the second.
    pub texels: wgpu::Buffer,
    images: Vec<Arc<Texture>>,
}

impl Slides {
    /// Finds out whether all of them fit.
    ///
    /// # Errors
    /// If they do not.
    pub fn check(scene: &Scene) -> Result<(), GpuError> {
        let texels: u64 = images(scene).map(|image| u64::from(image.width()) * u64::from(image.height())).sum();
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
    places.map(|(x, y)| {
        // Brighter than half precision can be would be infinite.
        let [r, g, b, _] = image.texel(x, y).to_array().map(|c| half::f16::from_f32(c.clamp(0.0, 65_504.0)));
        let word =
            |low: half::f16, high: half::f16| u32::from(low.to_bits()) | u32::from(high.to_bits()) << 16;
        [word(r, g), word(b, half::f16::ZERO)]
    })
}
