//! Textures that passes draw into and read from.

use crate::Gpu;
use glam::Vec4;
use half::f16;

/// A square or rectangular texture of one or more layers.
#[derive(Debug, Clone)]
pub struct Map {
    /// The texture itself.
    pub texture: wgpu::Texture,
    /// All layers, for shaders that take an array.
    pub array: View,
    /// Each layer on its own, to be drawn into or read.
    pub layers: Vec<View>,
    /// Number of the first of them in the texture.
    pub first_layer: u32,
}

/// Some layers of a texture, as passes bind them.
#[derive(Debug, Clone)]
pub struct View {
    /// The view itself.
    pub raw: wgpu::TextureView,
    /// Texels of all layers that it shows.
    pub texels: u64,
    /// Bytes of one of them.
    pub texel_bytes: u64,
}

impl View {
    /// Bytes of all that it shows.
    pub fn bytes(&self) -> u64 {
        self.texels * self.texel_bytes
    }
}

impl Map {
    /// A texture of zeros.
    pub fn new(gpu: &Gpu, label: &str, size: [u32; 2], layers: u32, format: wgpu::TextureFormat) -> Self {
        gpu.count(u64::from(size[0]) * u64::from(size[1]) * u64::from(layers) * texel_bytes(format));
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: layers },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: usages(format),
            view_formats: &[],
        });
        Self::over(texture, 0, layers)
    }

    /// Some layers of it, as a map of their own.
    pub fn part(&self, first: u32, layers: u32) -> Self {
        Self::over(self.texture.clone(), self.first_layer + first, layers)
    }

    fn over(texture: wgpu::Texture, first_layer: u32, layers: u32) -> Self {
        let view = |dimension, base_array_layer, count| View {
            raw: texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(dimension),
                base_array_layer,
                array_layer_count: Some(count),
                ..wgpu::TextureViewDescriptor::default()
            }),
            texels: u64::from(texture.width()) * u64::from(texture.height()) * u64::from(count),
            texel_bytes: texel_bytes(texture.format()),
        };
        let array = view(wgpu::TextureViewDimension::D2Array, first_layer, layers);
        let each = first_layer..first_layer + layers;
        let layers = each.map(|l| view(wgpu::TextureViewDimension::D2, l, 1)).collect();
        Self { texture, array, layers, first_layer }
    }

    /// A square texture of zeros.
    pub fn square(gpu: &Gpu, label: &str, size: u32, layers: u32, format: wgpu::TextureFormat) -> Self {
        Self::new(gpu, label, [size, size], layers, format)
    }

    /// A texture filled with bytes, row by row.
    pub fn filled(gpu: &Gpu, label: &str, size: [u32; 2], format: wgpu::TextureFormat, bytes: &[u8]) -> Self {
        let map = Self::new(gpu, label, size, 1, format);
        map.write(gpu, 0, bytes);
        map
    }

    /// A texture of 16-bit floats.
    pub fn of_values(gpu: &Gpu, label: &str, size: [u32; 2], values: impl Iterator<Item = Vec4>) -> Self {
        Self::filled(gpu, label, size, wgpu::TextureFormat::Rgba16Float, &half_bytes(values))
    }

    /// Fills a layer, row by row.
    pub fn write(&self, gpu: &Gpu, layer: u32, bytes: &[u8]) {
        let size = wgpu::Extent3d { depth_or_array_layers: 1, ..self.texture.size() };
        let texel_bytes = self.texture.format().block_copy_size(None).expect("no format here is compressed");
        let mut target = self.texture.as_image_copy();
        target.origin.z = self.first_layer + layer;
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(size.width * texel_bytes),
            rows_per_image: None,
        };
        gpu.queue.write_texture(target, bytes, layout, size);
    }

    /// The only layer.
    pub fn view(&self) -> &View {
        &self.layers[0]
    }

    /// Width in texels.
    pub fn width(&self) -> u32 {
        self.texture.width()
    }

    /// Height in texels.
    pub fn height(&self) -> u32 {
        self.texture.height()
    }
}

fn texel_bytes(format: wgpu::TextureFormat) -> u64 {
    // What cannot be copied is a depth of 32 bits.
    u64::from(format.block_copy_size(None).unwrap_or(4))
}

/// Everything is read; what can be is drawn into.
fn usages(format: wgpu::TextureFormat) -> wgpu::TextureUsages {
    let copied = wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::COPY_DST;
    wgpu::TextureUsages::TEXTURE_BINDING
        | match format {
            wgpu::TextureFormat::Depth32Float => wgpu::TextureUsages::RENDER_ATTACHMENT,
            _ => wgpu::TextureUsages::RENDER_ATTACHMENT | copied,
        }
}

/// Values as 16-bit floats; what is larger than those reach is the largest of them.
pub fn half_bytes(values: impl Iterator<Item = Vec4>) -> Vec<u8> {
    let largest = Vec4::splat(f16::MAX.to_f32());
    let halves =
        values.flat_map(|v| v.clamp(-largest, largest).to_array().map(|c| f16::from_f32(c).to_bits()));
    halves.flat_map(u16::to_le_bytes).collect()
}
