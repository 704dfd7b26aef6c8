//! What the camera sees: samples, their depths and their mean.

use super::images::Images;
use super::object::ObjectMaps;
use super::shared::Shared;
use crate::map::Map;
use crate::passes::Passes;
use crate::passes::irradiance_image::IrradianceImages;
use crate::passes::resolve::{Canvas, PICTURE};
use crate::pipeline::DEPTH;
use crate::step::Step;
use crate::{Gpu, GpuError};
use cutis_render::{Settings, TechniqueName};

/// A picture of one size.
#[derive(Debug)]
pub struct Picture {
    /// The finished picture, linear.
    pub pixels: Map,
    /// Depths of the samples.
    pub depth: Map,
    /// Samples along a side of a pixel.
    pub grid: u32,
    /// What draws it, once the light is there.
    pub steps: Vec<Step>,
    samples: Map,
    gathering: Option<Gathering>,
    /// Bytes of its maps.
    pub memory_bytes: u64,
}

impl Picture {
    /// An empty picture of the size and with the samples of the settings.
    ///
    /// # Errors
    /// If it is larger than the device takes.
    pub fn new(gpu: &Gpu, settings: &Settings) -> Result<Self, GpuError> {
        let (size, grid) = (size(settings), grid(settings));
        let sides = size.map(|side| side.saturating_mul(grid));
        let limit = gpu.device.limits().max_texture_dimension_2d;
        if sides[0].max(sides[1]) > limit {
            let size = format!("{} × {} samples", sides[0], sides[1]);
            return Err(GpuError::TooLarge { what: "the picture", size, limit: u64::from(limit) });
        }
        let gpu = &gpu.counting();
        let samples = Map::new(gpu, "samples", sides, 1, PICTURE);
        Ok(Self {
            pixels: if grid > 1 { Map::new(gpu, "pixels", size, 1, PICTURE) } else { samples.clone() },
            depth: Map::new(gpu, "depth", sides, 1, DEPTH),
            grid,
            steps: Vec::new(),
            gathering: (settings.light_inside() == TechniqueName::ImageSpace)
                .then(|| Gathering::new(gpu, sides)),
            samples,
            memory_bytes: gpu.asked_bytes(),
        })
    }

    /// Whether it is what the settings ask for.
    pub fn serves(&self, settings: &Settings) -> bool {
        [self.pixels.width(), self.pixels.height()] == size(settings) && self.grid == grid(settings)
    }

    /// Width over height.
    pub fn aspect(&self) -> f32 {
        self.pixels.width() as f32 / self.pixels.height() as f32
    }

    /// What was gathered for its samples, where the technique does that.
    pub fn gathered(&self) -> Option<&Map> {
        self.gathering.as_ref().map(|gathering| &gathering.gathered)
    }

    /// Lays the steps that draw some objects before the sky or a plain background.
    pub fn lay_steps(
        &mut self,
        gpu: &Gpu,
        passes: &Passes,
        shared: &Shared,
        objects: &[ObjectMaps],
        images: Option<&Images>,
        background: wgpu::Color,
    ) {
        let Shared { environment, camera, .. } = shared;
        let sky = environment.sky.as_ref();
        let resolve = &passes.resolve;
        let of_sky =
            sky.map(|sky| resolve.sky_step(gpu, &passes.samplers, camera, environment, sky, &self.samples));
        self.steps = of_sky.into_iter().collect();
        for (i, maps) in objects.iter().enumerate() {
            self.steps.push(resolve.nearest_step(gpu, camera, &maps.geometry, &self.depth, i == 0));
        }
        if let (Some(gathering), Some(images)) = (&self.gathering, images) {
            self.steps.extend(gathering.steps(gpu, passes, shared, (objects, images), &self.depth));
        }
        for (i, maps) in objects.iter().enumerate() {
            let canvas = Canvas {
                samples: &self.samples,
                depth: &self.depth,
                clear: sky.is_none().then_some(background),
                first: i == 0,
            };
            self.steps.push(resolve.step(
                gpu,
                &maps.resolve_inputs(passes, shared, self.gathered()),
                &canvas,
            ));
        }
        if self.grid > 1 {
            self.steps.push(passes.downsample.step(gpu, self.grid, &self.samples, &self.pixels));
        }
    }
}

fn size(settings: &Settings) -> [u32; 2] {
    [settings.width, settings.height]
}

fn grid(settings: &Settings) -> u32 {
    settings.samples_grid()
}

/// What the camera sees of the irradiance, and what is gathered from it for every sample.
#[derive(Debug)]
struct Gathering {
    image: IrradianceImages,
    /// What entered where the camera sees it, and elsewhere.
    gathered: Map,
}

impl Gathering {
    fn new(gpu: &Gpu, sides: [u32; 2]) -> Self {
        Self {
            image: IrradianceImages::new(gpu, sides, 1),
            gathered: Map::new(gpu, "gathered light", sides, 2, PICTURE),
        }
    }

    fn steps(
        &self,
        gpu: &Gpu,
        passes: &Passes,
        shared: &Shared,
        (objects, images): (&[ObjectMaps], &Images),
        depth: &Map,
    ) -> Vec<Step> {
        let seen = (0..).zip(objects).map(|(object, maps)| {
            let inputs = maps.resolve_inputs(passes, shared, None);
            passes.irradiance_image.camera_step(gpu, &inputs, images.drawn(object), &self.image, depth)
        });
        let from = [&self.image, &images.of_lights];
        let gather = passes.sample_profile.step(gpu, shared, &images.profiles, from, &self.gathered);
        seen.chain([gather]).collect()
    }
}
