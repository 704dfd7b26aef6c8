//! The environment as shaders read it: filtered by cutis-render.

use crate::map::{Map, half_bytes};
use crate::{Gpu, GpuError};
use bytemuck::{Pod, Zeroable};
use cutis_render::prepare::FilteredEnvironment;
use cutis_render::prepare::prefilter::ROUGHNESSES;
use cutis_scene::{Environment, Texture};
use glam::Vec4;

/// The numbers of an environment; the twin of `Environment` in `lib/environment.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct GpuEnvironment {
    /// Factor on the map that the camera sees.
    pub radiance_scale: [f32; 3],
    /// Turn about +Y, rad.
    pub rotation_rad: f32,
    /// Roughness of each filtered reflection but the last.
    pub roughnesses: [f32; 4],
    /// That of the last.
    pub last_roughness: f32,
    /// Fills up the struct.
    pub pad0: f32,
    /// Fills up the struct.
    pub pad1: f32,
    /// Fills up the struct.
    pub pad2: f32,
}

/// Filtered maps; black ones where a scene has no environment.
#[derive(Debug)]
pub struct EnvironmentMaps {
    /// [`GpuEnvironment`].
    pub numbers: wgpu::Buffer,
    /// Irradiance by the normal.
    pub irradiance: Map,
    /// Reflected radiance by the mirror direction, one layer for each roughness.
    pub reflections: Map,
    /// The environment itself, if the camera sees it.
    pub sky: Option<Map>,
    /// What was uploaded; none without an environment.
    uploaded: Option<GpuEnvironment>,
}

impl EnvironmentMaps {
    /// Uploads an environment.
    ///
    /// # Errors
    /// If its map is larger than the device takes.
    pub fn new(gpu: &Gpu, filtered: Option<&FilteredEnvironment>) -> Result<Self, GpuError> {
        let Some(filtered) = filtered else { return Ok(Self::black(gpu)) };
        let format = wgpu::TextureFormat::Rgba16Float;
        let (irradiance, reflections) = (filtered.irradiance_map(), filtered.reflection_maps());
        let layers = reflections.len() as u32;
        let frame = filtered.frame();
        let this = Self {
            numbers: gpu.uniform("environment", &numbers(frame)),
            irradiance: Map::new(gpu, "irradiance of the environment", size(irradiance), 1, format),
            reflections: Map::new(gpu, "reflections", size(&reflections[0]), layers, format),
            sky: if frame.visible { Some(sky(gpu, frame)?) } else { None },
            uploaded: Some(numbers(frame)),
        };
        this.write(gpu, filtered);
        Ok(this)
    }

    /// Whether an environment of the same map can be taken in.
    pub fn serves(&self, environment: Option<&Environment>) -> bool {
        environment.is_some() == self.uploaded.is_some()
            && environment.is_some_and(|e| e.visible) == self.sky.is_some()
    }

    /// Takes in an environment that is turned, or of another strength.
    pub fn set(&mut self, gpu: &Gpu, environment: &Environment) {
        let now = numbers(environment);
        if self.uploaded.is_none_or(|uploaded| bytemuck::bytes_of(&uploaded) == bytemuck::bytes_of(&now)) {
            return;
        }
        gpu.queue.write_buffer(&self.numbers, 0, bytemuck::bytes_of(&now));
        self.write(gpu, &FilteredEnvironment::new(environment));
        self.uploaded = Some(now);
    }

    /// Fills the filtered maps.
    fn write(&self, gpu: &Gpu, filtered: &FilteredEnvironment) {
        self.irradiance.write(gpu, 0, &half_bytes(texels(filtered.irradiance_map())));
        for (layer, reflection) in (0..).zip(filtered.reflection_maps()) {
            self.reflections.write(gpu, layer, &half_bytes(texels(reflection)));
        }
    }

    fn black(gpu: &Gpu) -> Self {
        let format = wgpu::TextureFormat::Rgba16Float;
        let numbers = GpuEnvironment { roughnesses: first_roughnesses(), ..GpuEnvironment::zeroed() };
        Self {
            numbers: gpu
                .uniform("environment", &GpuEnvironment { last_roughness: ROUGHNESSES[4], ..numbers }),
            irradiance: Map::square(gpu, "no irradiance", 1, 1, format),
            reflections: Map::square(gpu, "no reflections", 1, ROUGHNESSES.len() as u32, format),
            sky: None,
            uploaded: None,
        }
    }
}

/// The numbers alone.
pub fn numbers(environment: &Environment) -> GpuEnvironment {
    GpuEnvironment {
        radiance_scale: environment.radiance_scale.to_array(),
        rotation_rad: environment.rotation_rad,
        roughnesses: first_roughnesses(),
        last_roughness: ROUGHNESSES[4],
        ..GpuEnvironment::zeroed()
    }
}

fn first_roughnesses() -> [f32; 4] {
    std::array::from_fn(|i| ROUGHNESSES[i])
}

fn sky(gpu: &Gpu, environment: &Environment) -> Result<Map, GpuError> {
    let map = &environment.map;
    let limit = gpu.device.limits().max_texture_dimension_2d;
    if map.width().max(map.height()) > limit {
        let size = format!("{} × {} texels", map.width(), map.height());
        return Err(GpuError::TooLarge { what: "the environment", size, limit: u64::from(limit) });
    }
    Ok(halves(gpu, "sky", map))
}

fn size(texture: &Texture) -> [u32; 2] {
    [texture.width(), texture.height()]
}

fn halves(gpu: &Gpu, label: &str, texture: &Texture) -> Map {
    Map::of_values(gpu, label, size(texture), texels(texture))
}

fn texels(texture: &Texture) -> impl Iterator<Item = Vec4> + '_ {
    let (width, height) = (texture.width(), texture.height());
    (0..width * height).map(move |i| texture.texel(i % width, i / width))
}
