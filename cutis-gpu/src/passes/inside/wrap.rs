//! Wrap lighting: numbers and table of one object. The twin of cutis-render's technique `wrap`.

use crate::Gpu;
use crate::map::Map;
use crate::pipeline::Bound;
use crate::scene::shared::Shared;
use bytemuck::{Pod, Zeroable};
use cutis_render::prepare::skin_table::{SIZE, SkinTable};
use cutis_render::technique::wrap::{WrapForm, WrapShine};
use cutis_render::{RenderError, Settings};
use cutis_scene::Material;
use glam::Vec3;

/// The numbers of a body; its twin has the same name.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Wrap {
    /// Wrap of each channel.
    pub wraps: [f32; 3],
    /// Width of the tint.
    pub scatter_width: f32,
    /// Colour of the tint.
    pub scatter_colour: [f32; 3],
    /// Exponent of the specular power.
    pub shininess: f32,
    /// Its colour.
    pub specular_colour: [f32; 3],
    /// How far above a place beyond the terminator shadows are looked for, mm.
    pub shadow_offset_mm: f32,
    /// Diffuse reflectance of the body.
    pub colour: [f32; 3],
    /// Whether the table is read.
    pub by_table: u32,
    /// Whether a whole ball sends back no more than a Lambertian one.
    pub energy_conserving: u32,
    /// Whether lights are reflected by the power.
    pub by_power: u32,
    /// Fills up the struct.
    pub pad0: u32,
    /// Fills up the struct.
    pub pad1: u32,
}

/// What the technique reads of one object.
#[derive(Debug)]
pub struct WrapMaps {
    numbers: wgpu::Buffer,
    table: Map,
}

impl WrapMaps {
    /// Uploads the numbers of an object, whose diffuse reflectance is `colour`.
    ///
    /// # Errors
    /// If its material has no kernel.
    pub fn new(
        gpu: &Gpu,
        material: &Material,
        colour: Vec3,
        settings: &Settings,
    ) -> Result<Self, RenderError> {
        let wrap = &settings.techniques.wrap;
        let wraps = wrap.wraps(material, settings.gaussians)?;
        let numbers = Wrap {
            wraps: wraps.to_array(),
            scatter_width: wrap.tint_width(wraps),
            scatter_colour: wrap.scatter_colour.to_array(),
            shininess: wrap.shininess,
            specular_colour: wrap.specular_colour.to_array(),
            shadow_offset_mm: wrap.shadow_offset_mm,
            colour: colour.to_array(),
            by_table: u32::from(wrap.form == WrapForm::Table),
            energy_conserving: u32::from(wrap.energy_conserving),
            by_power: u32::from(wrap.shine == WrapShine::Power),
            ..Wrap::zeroed()
        };
        let entries = SkinTable::new(wrap, wraps).entries;
        let side = SIZE as u32;
        Ok(Self {
            numbers: gpu.uniform("wrap", &numbers),
            table: Map::of_values(gpu, "skin table", [side, side], entries.into_iter()),
        })
    }

    /// What the shader reads.
    pub fn bound<'a>(&'a self, shared: &'a Shared) -> Vec<(u32, Bound<'a>)> {
        vec![
            (30, Bound::Buffer(&self.numbers)),
            (31, Bound::Texture(self.table.view())),
            (32, Bound::Texture(shared.environment.irradiance.view())),
            (33, Bound::Texture(&shared.shadows.depths.array)),
        ]
    }
}
