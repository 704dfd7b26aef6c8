//! Steps of an object's light map under the technique `texture-blur`.

use super::object::ObjectMaps;
use super::shared::Shared;
use crate::Gpu;
use crate::map::Map;
use crate::passes::Passes;
use crate::passes::seven_taps::SevenTapsInputs;
use crate::passes::thin_parts::{Body, ThinPartsInputs};
use crate::step::Step;
use bytemuck::Zeroable;
use cutis_render::passes::atlas::Atlas;
use cutis_render::passes::seven_taps::factor_of;
use cutis_render::prepare::kernel::kernel_of;
use cutis_render::{RenderError, Settings};
use cutis_scene::Object;
use wgpu::TextureFormat as Format;

/// An object as the steps need it.
#[derive(Debug, Clone, Copy)]
pub struct Subject<'a> {
    /// The object.
    pub object: &'a Object,
    /// Its number.
    pub number: u32,
    /// Its surface unrolled.
    pub atlas: &'a Atlas,
    /// Texel size that half of the surface falls below, mm.
    pub texel_mm: f32,
    /// Share of each light in its light map; none with a single one.
    pub shares: Option<&'a Map>,
}

/// Adds what comes through thin parts, blurs, and blends with what was not blurred.
///
/// # Errors
/// If the material has no kernel.
pub fn steps(
    gpu: &Gpu,
    passes: &Passes,
    shared: &Shared,
    maps: &ObjectMaps,
    subject: &Subject,
    settings: &Settings,
) -> Result<Vec<Step>, RenderError> {
    let Subject { object, atlas, texel_mm, .. } = *subject;
    let mut steps = Vec::new();
    let through = if settings.techniques.texture_blur.depth {
        let map = Map::square(gpu, "through thin parts", maps.charts.sizes[1].size, 1, Format::Rgba16Float);
        let deviation_mm = kernel_of(&object.material, settings.gaussians)?.deviation_mm().to_array();
        let body = Body {
            deviation_mm,
            thickness_scale: object.material.thickness_scale,
            object: subject.number,
            ..Body::zeroed()
        };
        let inputs = ThinPartsInputs {
            lights: &shared.lights,
            atlas: &maps.atlas,
            charts: &maps.charts,
            shadows: &shared.shadows,
            shares: subject.shares,
            light: &maps.levels.all[0].light,
        };
        steps.push(passes.thin_parts.step(gpu, body, &inputs, map.view()));
        Some(map)
    } else {
        None
    };
    let inputs = SevenTapsInputs {
        object,
        atlas,
        charts: &maps.charts,
        through: through.as_ref(),
        light: &maps.levels.all[0].light,
        maps: [&maps.levels.all[1].light, &maps.local],
        settings: &settings.techniques.texture_blur,
        factor: factor_of(object, texel_mm, settings)?,
    };
    steps.extend(passes.seven_taps.steps(gpu, &inputs));
    steps.push(passes.gather.step(gpu, &maps.kernel, &maps.levels, &maps.charts, maps.local.view()));
    Ok(steps)
}
