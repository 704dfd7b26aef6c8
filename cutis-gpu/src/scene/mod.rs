//! A scene on the device: textures made once, steps that run in every frame.

pub mod camera;
pub mod charts;
pub mod deformable;
pub mod development;
pub mod environment;
pub mod geometry;
pub mod images;
pub mod layers;
pub mod lights;
pub mod material;
pub mod object;
mod on_demand;
pub mod one_blur;
mod picture;
pub mod posing;
pub mod reach;
pub mod relight;
pub mod shared;
pub mod slides;
pub mod surroundings;

use crate::cost::Cost;
use crate::passes::Passes;
use crate::passes::shadow::Drawn;
use crate::readback::read_layer;
use crate::step::Step;
use crate::timing::Timing;
use crate::{Gpu, GpuError};
use bytemuck::Zeroable;
use cutis_render::lit_scene::{atlas_sizes, chosen_kernel};
use cutis_render::prepare::FilteredEnvironment;
use cutis_render::{PassTime, Progress, RenderError, Settings, TechniqueName};
use cutis_scene::{Camera, Pose, PoseError, Scene};
use development::Development;
use glam::Vec4;
use images::Images;
use object::{ObjectMaps, ObjectSteps, Prepared};
use picture::Picture;
use posing::Posing;
use shared::Shared;
use std::sync::atomic::{AtomicBool, Ordering};

/// Everything that is needed to draw frames of one scene.
#[derive(Debug)]
pub struct GpuScene {
    /// Textures of each object.
    pub objects: Vec<ObjectMaps>,
    /// What they share.
    pub shared: Shared,
    /// What lights see, and the profiles, for the technique that samples these.
    images: Option<Images>,
    /// What it is drawn on.
    picture: Picture,
    /// What deforms the objects, and where the camera stands.
    posing: Posing,
    /// What develops it, if somebody wants that.
    development: Option<Development>,
    background: wgpu::Color,
    /// What has to be done when the geometry has changed.
    surface_steps: Vec<Step>,
    /// What has to be done in every frame, before the picture.
    light_steps: Vec<Step>,
    /// Whether the geometry has changed since the last frame.
    changed: AtomicBool,
    /// Whether the light is that of the last frame.
    lit: AtomicBool,
    timing: Timing,
    memory_bytes: u64,
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
        let gpu = &gpu.counting();
        gpu.check()?;
        check_texture(gpu, settings)?;
        let filtered = scene.environment.as_ref().map(FilteredEnvironment::new);
        let shared = Shared::new(gpu, scene, settings, filtered.as_ref())?;
        let mut this = Self {
            picture: Picture::new(gpu, settings)?,
            images: (settings.light_inside() == TechniqueName::ImageSpace)
                .then(|| Images::new(gpu, &shared, scene, settings))
                .transpose()?,
            posing: Posing::new(gpu, scene, shared.growth_mm())?,
            shared,
            objects: Vec::new(),
            development: None,
            background: background(scene),
            surface_steps: Vec::new(),
            light_steps: Vec::new(),
            changed: AtomicBool::new(true),
            lit: AtomicBool::new(false),
            timing: Timing::new(gpu, 0),
            memory_bytes: 0,
        };
        let steps = this.add_objects(gpu, passes, scene, settings, progress)?;
        this.add_steps(gpu, passes, steps);
        this.timing =
            Timing::new(gpu, this.surface_steps.len() + this.steps().count() + development::MAX_STEPS);
        this.memory_bytes = gpu.asked_bytes();
        gpu.check()?;
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
        let sizes = atlas_sizes(&scene.objects, settings.irradiance_size);
        let mut steps = Vec::new();
        for (number, (object, size)) in (0..).zip(scene.objects.iter().zip(sizes)) {
            let prepared = Prepared::new(object, size, chosen_kernel(&object.material, settings)?, settings);
            if !progress.goes_on() {
                return Err(RenderError::Stopped.into());
            }
            let (maps, more) =
                ObjectMaps::new(gpu, passes, &self.shared, number, object, prepared, settings)?;
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
        if let Some(surroundings) = &self.shared.surroundings {
            self.surface_steps.extend(surroundings.steps(gpu, passes, &self.objects));
        }
        for (light, layer) in (0..).zip(&self.shared.layers) {
            let Some(layer) = *layer else { continue };
            for (object, maps) in (0..).zip(&self.objects) {
                let drawn = Drawn { light, object, ..Drawn::zeroed() };
                let Shared { lights, shadows, .. } = &self.shared;
                self.light_steps.push(passes.shadow.step(gpu, drawn, lights, &maps.geometry, shadows, layer));
            }
        }
        self.add_depth_maps(gpu, passes);
        self.light_steps.extend(after);
        if let Some(images) = &self.images {
            self.light_steps.extend(images.steps(gpu, passes, &self.shared, &self.objects));
        }
        let images = self.images.as_ref();
        self.picture.lay_steps(gpu, passes, &self.shared, &self.objects, images, self.background);
    }

    /// All layers of each light's map, one after the other: each needs all objects of the one before.
    fn add_depth_maps(&mut self, gpu: &Gpu, passes: &Passes) {
        let Some(maps) = &self.shared.depth_maps else { return };
        for (light, map) in (0..).zip(&self.shared.layers) {
            let Some(map) = *map else { continue };
            for layer in 0..maps.layers {
                for (number, object) in (0..).zip(&self.objects) {
                    let inputs = object.depth_map_inputs(passes, &self.shared, number);
                    self.light_steps.push(passes.depth_map.step(gpu, &inputs, maps, (light, map), layer));
                }
            }
        }
    }

    /// Draws on a picture of another size or with other samples from now on; only those of the settings count.
    ///
    /// # Errors
    /// If it is larger than the device takes.
    pub fn set_picture(&mut self, gpu: &Gpu, passes: &Passes, settings: &Settings) -> Result<(), GpuError> {
        if !self.picture.serves(settings) {
            self.picture = Picture::new(gpu, settings)?;
            self.posing.set_aspect(gpu, &self.shared, self.picture.aspect());
            let images = self.images.as_ref();
            self.picture.lay_steps(gpu, passes, &self.shared, &self.objects, images, self.background);
            self.lay_film(gpu, passes);
        }
        gpu.check()
    }

    /// Takes the pattern of another round, and as many samples of a pixel as the settings want, for the technique that samples
    /// the profile.
    ///
    /// # Errors
    /// If the disc of the uniform samples has no radius.
    pub fn set_sampling(&self, gpu: &Gpu, settings: &Settings) -> Result<(), RenderError> {
        self.images.as_ref().map_or(Ok(()), |images| images.profiles.set_sampling(gpu, settings))
    }

    /// Moves the camera.
    pub fn set_camera(&self, gpu: &Gpu, camera: &Camera) {
        let aspect = self.picture.aspect();
        self.posing.set_camera(gpu, &self.shared, camera, aspect);
    }

    /// Deforms all objects from rest into a pose, from the next frame on; `scene` is the one this was made from.
    /// Stretch, the unrolled surface, the taps of the blurs, how heat flows, openness and the lights' maps follow.
    ///
    /// # Errors
    /// If it names what no object has, or a number makes no sense; nothing moves then.
    pub fn set_pose(&self, gpu: &Gpu, scene: &Scene, pose: &Pose) -> Result<(), PoseError> {
        pose.check(&scene.objects)?;
        let aspect = self.picture.aspect();
        self.posing.set_pose(gpu, &self.shared, scene, pose, aspect);
        self.let_heat_flow(gpu, scene, pose)?;
        self.changed.store(true, Ordering::Relaxed);
        Ok(())
    }

    /// Measures anew how heat flows, on the processor.
    fn let_heat_flow(&self, gpu: &Gpu, scene: &Scene, pose: &Pose) -> Result<(), PoseError> {
        if self.objects.iter().all(|object| object.flow.is_none()) {
            return Ok(());
        }
        let mut posed = scene.clone();
        posed.set_pose(pose)?;
        for (maps, object) in self.objects.iter().zip(&posed.objects) {
            maps.flow.iter().for_each(|flow| flow.set_pose(gpu, object));
        }
        Ok(())
    }

    /// The steps of a frame while the geometry stays.
    fn steps(&self) -> impl Iterator<Item = &Step> {
        self.light_steps.iter().chain(self.look_steps())
    }

    /// Those that need no new light.
    fn look_steps(&self) -> impl Iterator<Item = &Step> {
        self.picture.steps.iter().chain(self.film_steps())
    }

    /// The steps of the next frame.
    fn due(&self) -> impl Iterator<Item = &Step> {
        let changed = self.changed.swap(false, Ordering::Relaxed);
        self.lit.store(true, Ordering::Relaxed);
        self.surface_steps.iter().filter(move |_| changed).chain(self.steps())
    }

    /// Bytes of all textures and buffers that it keeps, those of single frames left out.
    pub fn memory_bytes(&self) -> u64 {
        let of_film = self.development.as_ref().map_or(0, |development| development.memory_bytes);
        self.memory_bytes + self.picture.memory_bytes + of_film
    }

    /// What every step of a frame costs at least, while the geometry stays.
    pub fn costs(&self) -> Vec<Cost> {
        self.steps().map(Cost::of).collect()
    }

    /// Draws a frame, without waiting for it.
    ///
    /// # Errors
    /// If the device has refused something.
    pub fn draw(&self, gpu: &Gpu) -> Result<(), GpuError> {
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.due().for_each(|step| step.encode(&mut encoder, None));
        gpu.queue.submit([encoder.finish()]);
        gpu.check()
    }

    /// Draws a frame and tells how long each pass took.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn draw_timed(&self, gpu: &Gpu) -> Result<Vec<PassTime>, GpuError> {
        self.timing.run(gpu, self.due())
    }

    /// Draws the light of the frame before from where the camera is now, and tells how long each pass took. The whole frame,
    /// if there was none or the geometry has changed.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn look_timed(&self, gpu: &Gpu) -> Result<Vec<PassTime>, GpuError> {
        if self.lit.load(Ordering::Relaxed) && !self.changed.load(Ordering::Relaxed) {
            self.timing.run(gpu, self.look_steps())
        } else {
            self.draw_timed(gpu)
        }
    }

    /// The picture that was drawn last.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn picture(&self, gpu: &Gpu) -> Result<Vec<Vec4>, GpuError> {
        read_layer(gpu, &self.picture.pixels, 0)
    }
}

fn check_texture(gpu: &Gpu, settings: &Settings) -> Result<(), GpuError> {
    let limit = gpu.device.limits().max_texture_dimension_2d;
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
