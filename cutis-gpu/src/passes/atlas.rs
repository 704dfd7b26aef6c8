//! The surface unrolled: where every texel lies in space, which way it faces and how far it is stretched.
//!
//! Which triangle lies under a texel is found once, by cutis-render: it follows from places in the atlas alone, and no
//! deformation moves those. So charts, padding and their edges are the same on both backends.

use crate::map::Map;
use crate::passes::{Samplers, over_charts};
use crate::pipeline::{Blueprint, Bound, Pipeline};
use crate::readback::read_layer;
use crate::scene::charts::{ChartTexture, coordinates_texture};
use crate::scene::geometry::Geometry;
use crate::scene::material::MaterialMaps;
use crate::shaders;
use crate::step::Step;
use crate::{Gpu, GpuError};
use cutis_render::passes::atlas::Atlas;
use cutis_scene::Object;
use glam::{Vec2, Vec3, Vec4};
use wgpu::TextureFormat as Format;

/// The pass's pipeline.
#[derive(Debug)]
pub struct AtlasPass {
    pipeline: Pipeline,
}

/// The unrolled surface.
#[derive(Debug)]
pub struct AtlasMaps {
    /// Position in mm as bits, smooth normal packed in w.
    pub places: Map,
    /// Normal with relief, packed.
    pub reliefs: Map,
    /// Millimetres per texel along u and v, lift in mm in z.
    pub stretch: Map,
    /// Place in the material's maps and in those of light, packed. No deformation moves them.
    pub coordinates: Map,
}

impl AtlasMaps {
    /// For the atlas of an object.
    pub fn new(gpu: &Gpu, object: &Object, atlas: &Atlas) -> Self {
        let size = atlas.size as u32;
        Self {
            places: Map::square(gpu, "places", size, 1, Format::Rgba32Uint),
            reliefs: Map::square(gpu, "reliefs", size, 1, Format::R32Uint),
            stretch: Map::square(gpu, "stretch", size, 1, Format::Rgba16Float),
            coordinates: coordinates_texture(gpu, object, atlas),
        }
    }
}

impl AtlasMaps {
    /// Positions in mm and smooth normals of all texels.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn unpacked(&self, gpu: &Gpu) -> Result<[Vec<Vec4>; 2], GpuError> {
        let packed = read_layer(gpu, &self.places, 0)?;
        let normals = packed.iter().map(|p| unpack_unit(p.w.to_bits()).extend(0.0)).collect();
        Ok([packed.iter().map(|p| p.truncate().extend(0.0)).collect(), normals])
    }
}

/// The twin of `unpack_unit` in `lib/packing.wgsl`.
fn unpack_unit(code: u32) -> Vec3 {
    let snorm = |bits: u32| (f32::from(bits as u16 as i16) / 32767.0).max(-1.0);
    let e = Vec2::new(snorm(code & 0xffff), snorm(code >> 16));
    let z = 1.0 - e.x.abs() - e.y.abs();
    let sign = Vec2::new(if e.x >= 0.0 { 1.0 } else { -1.0 }, if e.y >= 0.0 { 1.0 } else { -1.0 });
    let folded = (Vec2::ONE - Vec2::new(e.y, e.x).abs()) * sign;
    let side = if z >= 0.0 { e } else { folded };
    side.extend(z).normalize_or(Vec3::Z)
}

impl AtlasPass {
    /// Compiles it.
    pub fn new(gpu: &Gpu) -> Self {
        let targets = &[Format::Rgba32Uint, Format::R32Uint, Format::Rgba16Float];
        let entries = ["cover_run", "unroll"];
        let blueprint = Blueprint {
            name: "atlas",
            source: shaders::ATLAS,
            entries,
            targets,
            additive: false,
            depth: false,
        };
        Self { pipeline: Pipeline::new(gpu, &blueprint) }
    }

    /// Fills the maps from the triangle under every texel.
    pub fn step(
        &self,
        gpu: &Gpu,
        samplers: &Samplers,
        (geometry, material): (&Geometry, &MaterialMaps),
        (surface, charts): (&Map, &ChartTexture),
        maps: &AtlasMaps,
    ) -> Step {
        let bound = [
            (1, Bound::Buffer(&geometry.vertices)),
            (2, Bound::Buffer(&geometry.triangles)),
            (3, Bound::Buffer(&geometry.squared_stretch_mm2)),
            (4, Bound::Texture(surface.view())),
            (5, Bound::Buffer(&material.numbers)),
            (6, Bound::Texture(material.relief.view())),
            (7, Bound::Sampler(&samplers.repeating)),
        ];
        let targets = [maps.places.view(), maps.reliefs.view(), maps.stretch.view()];
        over_charts(gpu, &self.pipeline, charts, &bound, &targets, false)
    }
}
