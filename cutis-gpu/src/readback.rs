//! From textures back to numbers.

use crate::map::Map;
use crate::{Gpu, GpuError};
use glam::Vec4;
use half::f16;
use wgpu::TextureFormat as Format;

/// All texels of one layer, row by row. Channels that the format lacks are 0.
///
/// # Errors
/// If the device is lost.
///
/// # Panics
/// If the format is none of those that passes draw into.
pub fn read_layer(gpu: &Gpu, map: &Map, layer: u32) -> Result<Vec<Vec4>, GpuError> {
    let reader = Reader::new(gpu, map);
    let bytes = reader.read(gpu, map, layer)?;
    let format = map.texture.format();
    Ok(bytes.chunks_exact(texel_bytes(map)).map(|bytes| texel(format, bytes)).collect())
}

/// A buffer through which maps of one size and format are read.
#[derive(Debug)]
pub struct Reader {
    buffer: wgpu::Buffer,
}

impl Reader {
    /// For maps like this one.
    pub fn new(gpu: &Gpu, map: &Map) -> Self {
        let size = (pitch(map) * map.height() as usize) as u64;
        gpu.count(size);
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("read back"),
            size,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        Self { buffer }
    }

    /// The bytes of all texels of one layer, row by row.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn read(&self, gpu: &Gpu, map: &Map, layer: u32) -> Result<Vec<u8>, GpuError> {
        copy(gpu, map, layer, &self.buffer);
        let bytes = mapped(gpu, &self.buffer)?;
        let row_bytes = map.width() as usize * texel_bytes(map);
        Ok(bytes.chunks_exact(pitch(map)).flat_map(|row| &row[..row_bytes]).copied().collect())
    }
}

fn texel_bytes(map: &Map) -> usize {
    map.texture.format().block_copy_size(None).expect("no format here is compressed") as usize
}

/// Bytes from one row in a buffer to the next: they begin at multiples of what WebGPU asks for.
fn pitch(map: &Map) -> usize {
    let row_bytes = map.width() as usize * texel_bytes(map);
    row_bytes.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as usize)
}

fn copy(gpu: &Gpu, map: &Map, layer: u32, buffer: &wgpu::Buffer) {
    let bytes_per_row = Some(pitch(map) as u32);
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row, rows_per_image: None };
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let to = wgpu::TexelCopyBufferInfo { buffer, layout };
    encoder.copy_texture_to_buffer(map.place(layer), to, map.extent());
    gpu.queue.submit([encoder.finish()]);
}

/// Waits for a buffer and copies what it holds.
///
/// # Errors
/// If the device is lost.
pub fn mapped(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Vec<u8>, GpuError> {
    let lost = |reason: String| GpuError::Lost { reason };
    buffer.map_async(wgpu::MapMode::Read, .., |_| {});
    gpu.wait()?;
    let bytes = buffer.get_mapped_range(..).map_err(|e| lost(e.to_string()))?.to_vec();
    buffer.unmap();
    Ok(bytes)
}

fn texel(format: Format, bytes: &[u8]) -> Vec4 {
    let half = |i: usize| f16::from_le_bytes([bytes[2 * i], bytes[2 * i + 1]]).to_f32();
    let float = |i: usize| f32::from_le_bytes([0, 1, 2, 3].map(|b| bytes[4 * i + b]));
    match format {
        Format::Rgba16Float => Vec4::from_array([0, 1, 2, 3].map(half)),
        Format::Rg16Float => Vec4::new(half(0), half(1), 0.0, 0.0),
        // Bits that are no numbers pass through unharmed.
        Format::Rgba32Float | Format::Rgba32Uint => Vec4::from_array([0, 1, 2, 3].map(float)),
        Format::R32Float => Vec4::new(float(0), 0.0, 0.0, 0.0),
        Format::Rgba8Unorm => Vec4::from_array([0, 1, 2, 3].map(|i| f32::from(bytes[i]) / 255.0)),
        other => unreachable!("no pass draws {other:?} for anyone to read"),
    }
}
