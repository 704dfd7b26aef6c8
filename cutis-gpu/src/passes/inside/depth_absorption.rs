//! Absorption over distances through bodies: numbers and ramp of one object. The twin of cutis-render's technique
//! `depth-absorption`.

use crate::Gpu;
use crate::pipeline::Bound;
use crate::scene::shared::Shared;
use bytemuck::{Pod, Zeroable};
use cutis_render::technique::depth_absorption::{EntryPoint, FallOff, sigma_t_per_mm};
use cutis_render::{RenderError, Settings};
use cutis_scene::Object;
use glam::{Vec3, Vec4};

/// The numbers of a body; its twin has the same name.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct DepthAbsorption {
    /// Extinction of each channel, 1/mm.
    pub sigma_t_per_mm: [f32; 3],
    /// Factor on distances through the body.
    pub thickness_scale: f32,
    /// Diffuse reflectance of the body.
    pub colour: [f32; 3],
    /// Radius of the disc around a point whose ways are followed, mm.
    pub filter_radius_mm: f32,
    /// Places on it.
    pub samples: u32,
    /// Surfaces that are told apart.
    pub layers: u32,
    /// Whether normal and colour of the entry are known.
    pub by_surface: u32,
    /// Stops of the ramp; none: the exponential.
    pub stops: u32,
}

/// What the technique reads of one object.
#[derive(Debug)]
pub struct DepthAbsorptionMaps {
    numbers: wgpu::Buffer,
    ramp: wgpu::Buffer,
}

impl DepthAbsorptionMaps {
    /// Uploads the numbers of an object, whose diffuse reflectance is `colour`.
    ///
    /// # Errors
    /// If its material has no kernel.
    pub fn new(gpu: &Gpu, object: &Object, colour: Vec3, settings: &Settings) -> Result<Self, RenderError> {
        let own = &settings.techniques.depth_absorption;
        let ramp: Vec<Vec4> = match &own.fall_off {
            FallOff::Ramp(ramp) => ramp.stops().iter().map(|&(mm, colour)| colour.extend(mm)).collect(),
            FallOff::Material | FallOff::Exponential(_) => Vec::new(),
        };
        let numbers = DepthAbsorption {
            sigma_t_per_mm: sigma_t_per_mm(own, object, settings.gaussians)?.to_array(),
            thickness_scale: object.material.thickness_scale,
            colour: colour.to_array(),
            filter_radius_mm: own.filter_radius_mm,
            samples: own.samples,
            layers: own.layers,
            by_surface: u32::from(own.entry == EntryPoint::Surface),
            stops: ramp.len() as u32,
        };
        Ok(Self { numbers: gpu.uniform("depth absorption", &numbers), ramp: gpu.storage("ramp", &ramp) })
    }

    /// What the shader reads.
    pub fn bound<'a>(&'a self, shared: &'a Shared) -> Vec<(u32, Bound<'a>)> {
        let maps = shared.depth_maps.as_ref().expect("they are made with the scene for this technique");
        vec![
            (30, Bound::Buffer(&self.numbers)),
            (31, Bound::Buffer(&self.ramp)),
            (32, Bound::Texture(shared.environment.irradiance.view())),
            (33, Bound::Texture(&maps.distances.array)),
            (34, Bound::Texture(&maps.entered.array)),
        ]
    }
}
