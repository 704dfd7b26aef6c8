//! Materials as shaders read them.

use crate::map::Map;
use crate::{Gpu, GpuError};
use bytemuck::{Pod, Zeroable};
use cutis_scene::material::NormalSpace;
use cutis_scene::{Material, ScalarMap, Texels, Texture};
use glam::Vec4;

/// The numbers of a material; the twin of `Material` in `lib/material.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct GpuMaterial {
    /// Factor on the albedo's texture.
    pub albedo_factor: [f32; 3],
    /// Exponent of the albedo on the way in.
    pub albedo_mix: f32,
    /// Offset, gain and channel of the map of rho_s.
    pub rho_s: [f32; 3],
    /// Reflectance at normal incidence.
    pub f0: f32,
    /// Offset, gain and channel of the map of the roughness.
    pub roughness: [f32; 3],
    /// Factor on the relief.
    pub relief_strength: f32,
    /// Offset, gain and channel of the map of the second medium's share.
    pub share: [f32; 3],
    /// 0 without relief, 1 in tangent space, 2 in object space.
    pub relief_space: u32,
}

/// A material's numbers and maps.
#[derive(Debug)]
pub struct MaterialMaps {
    /// [`GpuMaterial`].
    pub numbers: wgpu::Buffer,
    /// Factor on distances through the body.
    pub thickness_scale: f32,
    /// Diffuse colour.
    pub albedo: Map,
    /// Normals.
    pub relief: Map,
    /// Specular intensity.
    pub rho_s: Map,
    /// Roughness.
    pub roughness: Map,
    /// Share of the second medium.
    pub share: Map,
}

impl MaterialMaps {
    /// Uploads a material.
    ///
    /// # Errors
    /// If a map is larger than the device takes.
    pub fn new(gpu: &Gpu, material: &Material) -> Result<Self, GpuError> {
        let texture = |label, texture: Option<&Texture>| upload(gpu, label, texture);
        let scalar = |label, map: Option<&ScalarMap>| {
            texture(label, map.and_then(|map| map.texture.as_ref()).map(|(map, _)| map.as_ref()))
        };
        let relief = material.normal.as_ref();
        Ok(Self {
            numbers: gpu.uniform("material", &numbers(material)),
            thickness_scale: material.thickness_scale,
            albedo: texture("albedo", material.albedo.texture.as_deref())?,
            relief: texture("relief", relief.map(|map| map.texture.as_ref()))?,
            rho_s: scalar("rho_s", Some(&material.rho_s))?,
            roughness: scalar("roughness", Some(&material.roughness))?,
            share: scalar("share", material.mixed_with.as_ref().map(|second| &second.share))?,
        })
    }
}

/// The numbers alone.
pub fn numbers(material: &Material) -> GpuMaterial {
    let scalar = |map: &ScalarMap| match &map.texture {
        Some((_, channel)) => [map.offset, map.gain, *channel as f32],
        None => [map.offset, 0.0, 0.0],
    };
    GpuMaterial {
        albedo_factor: material.albedo.factor.to_array(),
        albedo_mix: material.albedo_mix,
        rho_s: scalar(&material.rho_s),
        f0: material.f0,
        roughness: scalar(&material.roughness),
        relief_strength: material.normal.as_ref().map_or(0.0, |map| map.strength),
        share: material.mixed_with.as_ref().map_or([0.0; 3], |second| scalar(&second.share)),
        relief_space: material.normal.as_ref().map_or(0, |map| match map.space {
            NormalSpace::Tangent => 1,
            NormalSpace::Object => 2,
        }),
    }
}

/// A texture in the form that keeps its values; without one, a white texel.
fn upload(gpu: &Gpu, label: &str, texture: Option<&Texture>) -> Result<Map, GpuError> {
    let Some(texture) = texture else {
        return Ok(Map::filled(gpu, label, [1, 1], wgpu::TextureFormat::Rgba8Unorm, &[255; 4]));
    };
    let size = [texture.width(), texture.height()];
    let limit = gpu.device.limits().max_texture_dimension_2d;
    if size[0].max(size[1]) > limit {
        let size = format!("{} × {} texels", size[0], size[1]);
        return Err(GpuError::TooLarge { what: "a texture", size, limit: u64::from(limit) });
    }
    Ok(match texture.texels() {
        Texels::Srgb8(t) => {
            let bytes = bytemuck::cast_slice(t);
            Map::filled(gpu, label, size, wgpu::TextureFormat::Rgba8UnormSrgb, bytes)
        }
        Texels::Linear8(t) => {
            let bytes = bytemuck::cast_slice(t);
            Map::filled(gpu, label, size, wgpu::TextureFormat::Rgba8Unorm, bytes)
        }
        Texels::LinearF32(t) => {
            Map::of_values(gpu, label, size, t.iter().map(|&texel| Vec4::from_array(texel)))
        }
    })
}
