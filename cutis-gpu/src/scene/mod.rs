//! A scene on the device: textures made once, steps that run in every frame.

pub mod camera;
pub mod charts;
pub mod deformable;
pub mod environment;
pub mod geometry;
pub mod layers;
pub mod lights;
pub mod material;
pub mod object;
pub mod posing;
pub mod reach;
pub mod shared;

use crate::map::Map;
use crate::passes::Passes;
use crate::passes::resolve::{Canvas, PICTURE};
use crate::passes::shadow::Drawn;
use crate::pipeline::DEPTH;
use crate::readback::read_layer;
use crate::step::Step;
use crate::timing::Timing;
use crate::{Gpu, GpuError};
use bytemuck::Zeroable;
use cutis_render::passes::ambient::Ambient;
use cutis_render::prepare::FilteredEnvironment;
use cutis_render::technique::texture_space::{atlas_sizes, chosen_kernel};
use cutis_render::{PassTime, Progress, RenderError, Settings};
use cutis_scene::{Bvh, Camera, Pose, PoseError, Scene};
use glam::Vec4;
use object::{ObjectMaps, ObjectSteps, Prepared};
use posing::Posing;
use shared::Shared;
use std::sync::atomic::{AtomicBool, Ordering};

/// Everything that is needed to draw frames of one scene, at one size.
#[derive(Debug)]
pub struct GpuScene {
    /// Textures of each object.
    pub objects: Vec<ObjectMaps>,
    /// What they share.
    pub shared: Shared,
    /// The finished picture, linear.
    pub pixels: Map,
    samples: Map,
    depth: Map,
    /// Samples along a side of a pixel.
    grid: u32,
    /// What deforms the objects, and where the camera stands.
    posing: Posing,
    background: wgpu::Color,
    /// What has to be done when the geometry has changed.
    surface_steps: Vec<Step>,
    /// What has to be done in every frame.
    steps: Vec<Step>,
    /// Whether the geometry has changed since the last frame.
    changed: AtomicBool,
    timing: Timing,
}

/// Why a scene cannot be drawn by the device.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// It cannot be drawn at all.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The device cannot.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

impl GpuScene {
    /// Uploads a scene and prepares its frames.
    ///
    /// # Errors
    /// If a material cannot be turned into a kernel, or something is larger than the device takes.
    pub fn new(
        gpu: &Gpu,
        passes: &Passes,
        scene: &Scene,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<Self, SceneError> {
        let grid = (settings.samples_per_pixel as f32).sqrt().ceil() as u32;
        check_sizes(gpu, settings, grid)?;
        let filtered = scene.environment.as_ref().map(FilteredEnvironment::new);
        let shared = Shared::new(gpu, scene, settings, filtered.as_ref())?;
        let size = [settings.width, settings.height];
        let samples = Map::new(gpu, "samples", size.map(|s| s * grid), 1, PICTURE);
        let mut this = Self {
            pixels: if grid > 1 { Map::new(gpu, "pixels", size, 1, PICTURE) } else { samples.clone() },
            depth: Map::new(gpu, "depth", size.map(|s| s * grid), 1, DEPTH),
            samples,
            grid,
            shared,
            objects: Vec::new(),
            posing: Posing::new(gpu, scene)?,
            background: background(scene),
            surface_steps: Vec::new(),
            steps: Vec::new(),
            changed: AtomicBool::new(true),
            timing: Timing::new(gpu, 0),
        };
        let steps = this.add_objects(gpu, passes, scene, settings, progress)?;
        this.add_steps(gpu, passes, steps);
        this.timing = Timing::new(gpu, this.surface_steps.len() + this.steps.len());
        Ok(this)
    }

    fn add_objects(
        &mut self,
        gpu: &Gpu,
        passes: &Passes,
        scene: &Scene,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<Vec<ObjectSteps>, SceneError> {
        let bvh = scene.environment.is_some().then(|| Bvh::build(&scene.objects));
        let sizes = atlas_sizes(&scene.objects, settings.irradiance_size);
        let mut steps = Vec::new();
        for (number, (object, size)) in (0..).zip(scene.objects.iter().zip(sizes)) {
            let prepared = Prepared::new(object, size, chosen_kernel(&object.material, settings)?);
            let charts = prepared.atlas.charts.halved().halved();
            let (samples, seed) = (settings.ambient_samples, settings.seed);
            let ambient = match &bvh {
                Some(bvh) => Ambient::new(object, &prepared.atlas, charts, bvh, samples, seed, progress),
                None => Ambient::open(charts),
            };
            let (maps, more) =
                ObjectMaps::new(gpu, passes, &self.shared, number, object, prepared, &ambient)?;
            self.surface_steps.push(passes.deform.step(gpu, self.posing.deformable(number), &maps.geometry));
            self.objects.push(maps);
            steps.push(more);
        }
        Ok(steps)
    }

    fn add_steps(&mut self, gpu: &Gpu, passes: &Passes, objects: Vec<ObjectSteps>) {
        let mut after = Vec::new();
        for steps in objects {
            self.surface_steps.extend(steps.surface);
            after.extend(steps.light);
        }
        for (light, layer) in (0..).zip(&self.shared.layers) {
            let Some(layer) = *layer else { continue };
            for (object, maps) in (0..).zip(&self.objects) {
                let drawn = Drawn { light, object, ..Drawn::zeroed() };
                let Shared { lights, shadows, .. } = &self.shared;
                self.steps.push(passes.shadow.step(gpu, drawn, lights, &maps.geometry, shadows, layer));
            }
        }
        self.steps.extend(after);
        self.add_picture_steps(gpu, passes);
    }

    fn add_picture_steps(&mut self, gpu: &Gpu, passes: &Passes) {
        let Shared { environment, camera, .. } = &self.shared;
        let sky = environment.sky.as_ref();
        if let Some(sky) = sky {
            let samples = &self.samples;
            self.steps.push(passes.resolve.sky_step(
                gpu,
                &passes.samplers,
                camera,
                environment,
                sky,
                samples,
            ));
        }
        for (i, maps) in self.objects.iter().enumerate() {
            let canvas = Canvas {
                samples: &self.samples,
                depth: &self.depth,
                clear: sky.is_none().then_some(self.background),
                first: i == 0,
            };
            let inputs = maps.resolve_inputs(passes, &self.shared);
            self.steps.push(passes.resolve.step(gpu, &inputs, &canvas));
        }
        if self.grid > 1 {
            self.steps.push(passes.downsample.step(gpu, self.grid, &self.samples, &self.pixels));
        }
    }

    /// Moves the camera.
    pub fn set_camera(&self, gpu: &Gpu, camera: &Camera) {
        let aspect = self.pixels.width() as f32 / self.pixels.height() as f32;
        self.posing.set_camera(gpu, &self.shared, camera, aspect);
    }

    /// Deforms all objects from rest into a pose, from the next frame on; `scene` is the one this was made from.
    /// Stretch, the unrolled surface, the taps of the blurs and the lights' maps follow; openness does not.
    ///
    /// # Errors
    /// If it names what no object has, or a number makes no sense; nothing moves then.
    pub fn set_pose(&self, gpu: &Gpu, scene: &Scene, pose: &Pose) -> Result<(), PoseError> {
        pose.check(&scene.objects)?;
        let aspect = self.pixels.width() as f32 / self.pixels.height() as f32;
        self.posing.set_pose(gpu, &self.shared, scene, pose, aspect);
        self.changed.store(true, Ordering::Relaxed);
        Ok(())
    }

    /// The steps of the next frame.
    fn due(&self) -> impl Iterator<Item = &Step> {
        let changed = self.changed.swap(false, Ordering::Relaxed);
        self.surface_steps.iter().filter(move |_| changed).chain(&self.steps)
    }

    /// Draws a frame, without waiting for it.
    pub fn draw(&self, gpu: &Gpu) {
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.due().for_each(|step| step.encode(&mut encoder, None));
        gpu.queue.submit([encoder.finish()]);
    }

    /// Draws a frame and tells how long each pass took.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn draw_timed(&self, gpu: &Gpu) -> Result<Vec<PassTime>, GpuError> {
        self.timing.run(gpu, self.due())
    }

    /// The picture that was drawn last.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn picture(&self, gpu: &Gpu) -> Result<Vec<Vec4>, GpuError> {
        read_layer(gpu, &self.pixels, 0)
    }
}

fn check_sizes(gpu: &Gpu, settings: &Settings, grid: u32) -> Result<(), GpuError> {
    let limit = gpu.device.limits().max_texture_dimension_2d;
    let sides = [settings.width, settings.height].map(|side| side.saturating_mul(grid));
    if sides[0].max(sides[1]) > limit {
        let size = format!("{} × {} samples", sides[0], sides[1]);
        return Err(GpuError::TooLarge { what: "the picture", size, limit: u64::from(limit) });
    }
    if settings.irradiance_size > limit {
        let size = format!("{} texels wide", settings.irradiance_size);
        return Err(GpuError::TooLarge { what: "the irradiance texture", size, limit: u64::from(limit) });
    }
    Ok(())
}

fn background(scene: &Scene) -> wgpu::Color {
    scene.background.map_or(wgpu::Color::TRANSPARENT, |c| wgpu::Color {
        r: f64::from(c.x),
        g: f64::from(c.y),
        b: f64::from(c.z),
        a: 1.0,
    })
}
