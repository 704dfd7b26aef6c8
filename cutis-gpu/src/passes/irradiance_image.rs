//! The irradiance as an image, seen by the camera or by a light. The twin of cutis-render's pass `irradiance_image`.

use crate::Gpu;
use crate::map::{Map, View};
use crate::passes::resolve::ResolveInputs;
use crate::passes::shadow::Drawn;
use crate::pipeline::{Blueprint, Bound, DEPTH, Pipeline};
use crate::shaders;
use crate::step::{Draw, Step};
use wgpu::TextureFormat as Format;

/// Images of one size, one layer each.
#[derive(Debug)]
pub struct IrradianceImages {
    /// Place, normal and mixture of what is seen.
    pub places: Map,
    /// Irradiance, and which object is seen.
    pub light: Map,
}

impl IrradianceImages {
    /// So many empty images, one at least: no binding may be empty.
    pub fn new(gpu: &Gpu, size: [u32; 2], count: u32) -> Self {
        let map = |label, format| Map::new(gpu, label, size, count.max(1), format);
        Self {
            places: map("places seen", Format::Rgba32Uint),
            light: map("irradiance seen", Format::Rgba16Float),
        }
    }
}

/// The pass's pipelines.
#[derive(Debug)]
pub struct IrradianceImagePass {
    from_camera: Pipeline,
    from_light: Pipeline,
}

impl IrradianceImagePass {
    /// Compiles them.
    pub fn new(gpu: &Gpu) -> Self {
        let pipeline = |vertex| {
            let blueprint = Blueprint {
                name: "irradiance image",
                source: shaders::IRRADIANCE_IMAGE,
                entries: [vertex, "light_image"],
                targets: &[Format::Rgba32Uint, Format::Rgba16Float],
                additive: false,
                depth: true,
            };
            Pipeline::new(gpu, &blueprint)
        };
        Self { from_camera: pipeline("see"), from_light: pipeline("see_from_light") }
    }

    /// Draws an object as the camera sees it, where it is nearest by the depths that are there.
    pub fn camera_step(
        &self,
        gpu: &Gpu,
        inputs: &ResolveInputs,
        drawn: Drawn,
        images: &IrradianceImages,
        depth: &Map,
    ) -> Step {
        let targets = [&images.places.layers[0], &images.light.layers[0]];
        let more = [(2, Bound::Buffer(inputs.camera))];
        draw(gpu, &self.from_camera, inputs, drawn, &more, targets, (depth, false))
    }

    /// Draws an object as a light sees it, into image number `layer`; the first object empties it before.
    pub fn light_step(
        &self,
        gpu: &Gpu,
        inputs: &ResolveInputs,
        drawn: Drawn,
        images: &IrradianceImages,
        (layer, depth): (u32, &Map),
    ) -> Step {
        let targets = [&images.places, &images.light].map(|map| &map.layers[layer as usize]);
        draw(gpu, &self.from_light, inputs, drawn, &[], targets, (depth, drawn.object == 0))
    }
}

/// A depth buffer for images that lights see.
pub fn depth_buffer(gpu: &Gpu, side: u32) -> Map {
    Map::square(gpu, "depths of irradiance images", side, 1, DEPTH)
}

fn draw(
    gpu: &Gpu,
    pipeline: &Pipeline,
    inputs: &ResolveInputs,
    drawn: Drawn,
    more: &[(u32, Bound)],
    targets: [&View; 2],
    (depth, clear_depth): (&Map, bool),
) -> Step {
    let numbers = gpu.uniform("drawn", &drawn);
    let mut bound = inputs.lit_surface();
    bound.extend([
        (32, Bound::Texture(inputs.environment.irradiance.view())),
        (40, Bound::Buffer(&numbers)),
        (41, Bound::Texture(inputs.material.share.view())),
    ]);
    bound.extend_from_slice(more);
    Step::Draw(Draw {
        pipeline: pipeline.clone(),
        bind_groups: vec![pipeline.bind(gpu, 0, &bound)],
        targets: targets.into_iter().cloned().collect(),
        depth: Some((depth.view().clone(), clear_depth)),
        clear: (drawn.object == 0).then_some(wgpu::Color::TRANSPARENT),
        indices: None,
        vertices: 3 * inputs.geometry.triangle_count,
        instances: 1,
    })
}
