//! Textures that passes draw into and read from.

use crate::Gpu;
use glam::Vec4;
use half::f16;

/// A square or rectangular texture of one or more layers, or those of one size of a [`Pyramid`].
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
    /// How often the texture's size is halved.
    pub halvings: u32,
}

/// Layers of several sizes, each half of the one before, in one texture: what its shader calls mip levels.
#[derive(Debug, Clone)]
pub struct Pyramid {
    texture: wgpu::Texture,
    /// All layers of all sizes, for shaders that take an array.
    pub array: View,
    /// The first layer of all sizes.
    pub first: View,
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

impl Pyramid {
    /// A square texture of zeros; its size may be halved `halvings` times.
    pub fn new(
        gpu: &Gpu,
        label: &str,
        size: u32,
        [layers, halvings]: [u32; 2],
        format: wgpu::TextureFormat,
    ) -> Self {
        let texture = texture(gpu, label, [size, size], [layers, halvings + 1], format);
        let view = |dimension, layers| view(&texture, dimension, (0, layers), (0, halvings + 1));
        Self {
            array: view(wgpu::TextureViewDimension::D2Array, layers),
            first: view(wgpu::TextureViewDimension::D2, 1),
            texture,
        }
    }

    /// Some layers of the size that is halved so often.
    pub fn part(&self, halvings: u32, first: u32, layers: u32) -> Map {
        Map::over(self.texture.clone(), halvings, first, layers)
    }
}

impl Map {
    /// A texture of zeros.
    pub fn new(gpu: &Gpu, label: &str, size: [u32; 2], layers: u32, format: wgpu::TextureFormat) -> Self {
        Self::over(texture(gpu, label, size, [layers, 1], format), 0, 0, layers)
    }

    /// A square texture of one layer of zeros that computations write, too.
    pub fn computed(gpu: &Gpu, label: &str, size: u32, format: wgpu::TextureFormat) -> Self {
        let usage = usages(format) | wgpu::TextureUsages::STORAGE_BINDING;
        Self::over(texture_for(gpu, label, [size, size], [1, 1], format, usage), 0, 0, 1)
    }

    fn over(texture: wgpu::Texture, halvings: u32, first_layer: u32, count: u32) -> Self {
        let view = |dimension, layers| view(&texture, dimension, layers, (halvings, 1));
        let array = view(wgpu::TextureViewDimension::D2Array, (first_layer, count));
        let each = first_layer..first_layer + count;
        let layers = each.map(|l| view(wgpu::TextureViewDimension::D2, (l, 1))).collect();
        Self { texture, array, layers, first_layer, halvings }
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
        let size = self.extent();
        let texel_bytes = self.texture.format().block_copy_size(None).expect("no format here is compressed");
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(size.width * texel_bytes),
            rows_per_image: None,
        };
        gpu.queue.write_texture(self.place(layer), bytes, layout, size);
    }

    /// The only layer.
    pub fn view(&self) -> &View {
        &self.layers[0]
    }

    /// Where a layer lies in the texture.
    pub fn place(&self, layer: u32) -> wgpu::TexelCopyTextureInfo<'_> {
        let mut place = self.texture.as_image_copy();
        place.mip_level = self.halvings;
        place.origin.z = self.first_layer + layer;
        place
    }

    /// Width and height of one layer.
    pub fn extent(&self) -> wgpu::Extent3d {
        wgpu::Extent3d { width: self.width(), height: self.height(), depth_or_array_layers: 1 }
    }

    /// Width in texels.
    pub fn width(&self) -> u32 {
        halved(self.texture.width(), self.halvings)
    }

    /// Height in texels.
    pub fn height(&self) -> u32 {
        halved(self.texture.height(), self.halvings)
    }
}

/// A texture of zeros for what passes draw into.
fn texture(
    gpu: &Gpu,
    label: &str,
    size: [u32; 2],
    layers_and_sizes: [u32; 2],
    format: wgpu::TextureFormat,
) -> wgpu::Texture {
    texture_for(gpu, label, size, layers_and_sizes, format, usages(format))
}

fn texture_for(
    gpu: &Gpu,
    label: &str,
    [width, height]: [u32; 2],
    [layers, sizes]: [u32; 2],
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: layers },
        mip_level_count: sizes,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    });
    gpu.count(texels(&texture, layers, (0, sizes)) * texel_bytes(format));
    texture
}

/// Some layers and sizes of a texture, each told by the first and how many there are.
fn view(
    texture: &wgpu::Texture,
    dimension: wgpu::TextureViewDimension,
    (base_array_layer, layers): (u32, u32),
    (base_mip_level, sizes): (u32, u32),
) -> View {
    View {
        raw: texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(dimension),
            base_array_layer,
            array_layer_count: Some(layers),
            base_mip_level,
            mip_level_count: Some(sizes),
            ..wgpu::TextureViewDescriptor::default()
        }),
        texels: texels(texture, layers, (base_mip_level, sizes)),
        texel_bytes: texel_bytes(texture.format()),
    }
}

/// Texels of so many layers of some sizes.
fn texels(texture: &wgpu::Texture, layers: u32, (first, sizes): (u32, u32)) -> u64 {
    let of_size = |n| u64::from(halved(texture.width(), n)) * u64::from(halved(texture.height(), n));
    (first..first + sizes).map(of_size).sum::<u64>() * u64::from(layers)
}

fn halved(side: u32, times: u32) -> u32 {
    (side >> times).max(1)
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
