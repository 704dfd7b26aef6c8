//! What all objects of a scene share: lights and what they see, the environment, the camera.

use super::camera::GpuCamera;
use super::environment::EnvironmentMaps;
use super::lights::{GpuLight, NO_MAP};
use super::relight::{any_extent, layers};
use super::slides::{Slides, first_texels};
use super::surroundings::Surroundings;
use crate::passes::depth_map::DepthMaps;
use crate::passes::shadow::ShadowMaps;
use crate::{Gpu, GpuError};
use cutis_render::prepare::FilteredEnvironment;
use cutis_render::technique::depth_absorption::DepthAbsorptionSettings;
use cutis_render::{Settings, TechniqueName};
use cutis_scene::Scene;
use glam::Vec3;

/// Lights that get a shadow map; more would fill the memory of small adapters.
pub const SHADOW_BUDGET: usize = 8;
/// Largest and smallest side of a shadow map, texels.
const SHADOW_SIZES: [u32; 2] = [256, 2048];
/// Places on a light's disc that are tried at least: fewer leave grain in specular light.
const MIN_SHADOW_SAMPLES: u32 = 16;

/// Buffers and textures of the whole scene.
#[derive(Debug)]
pub struct Shared {
    /// [`GpuLight`] of every light.
    pub lights: wgpu::Buffer,
    /// What projectors among them throw.
    pub slides: Slides,
    /// How many there are, at least one: a scene without has a dark one.
    pub light_count: usize,
    /// Whether any light has an extent.
    pub any_extent: bool,
    /// Layer of the maps of each light, if it has one.
    pub layers: Vec<Option<u32>>,
    /// What the lights see.
    pub shadows: ShadowMaps,
    /// The same with distances through bodies, where the technique takes them.
    pub depth_maps: Option<DepthMaps>,
    /// The filtered environment.
    pub environment: EnvironmentMaps,
    /// What hides it; none without an environment.
    pub surroundings: Option<Surroundings>,
    /// [`GpuCamera`].
    pub camera: wgpu::Buffer,
    /// Places on a light's disc that are tried.
    pub shadow_samples: u32,
    /// Lights that cast no shadow, in words.
    pub warnings: Vec<String>,
}

impl Shared {
    /// How far bodies are grown in the lights' maps, mm.
    pub fn growth_mm(&self) -> f32 {
        self.depth_maps.as_ref().map_or(0.0, |maps| maps.growth_mm)
    }

    /// Uploads what a scene's objects share.
    ///
    /// # Errors
    /// If the environment, or what projectors throw, is larger than the device takes.
    pub fn new(
        gpu: &Gpu,
        scene: &Scene,
        settings: &Settings,
        filtered: Option<&FilteredEnvironment>,
    ) -> Result<Self, GpuError> {
        let depth = depth_absorption(settings);
        let lights = gpu_lights(scene, depth.map_or(0.0, |depth| depth.growth_mm));
        let layers = layers(&lights);
        let maps = layers.iter().flatten().count() as u32;
        let [smallest, largest] = SHADOW_SIZES;
        let size = settings.irradiance_size.clamp(smallest, largest);
        let aspect = settings.width as f32 / settings.height as f32;
        Ok(Self {
            slides: Slides::new(gpu, scene)?,
            light_count: lights.len().max(1),
            any_extent: any_extent(&lights),
            shadows: ShadowMaps::new(gpu, size, maps),
            depth_maps: depth.map(|depth| DepthMaps::new(gpu, scene, depth, size, maps)),
            environment: EnvironmentMaps::new(gpu, filtered)?,
            surroundings: filtered.map(|_| Surroundings::new(gpu, settings.ambient_samples, &points(scene))),
            camera: gpu.uniform("camera", &GpuCamera::of_scene(scene, aspect)),
            shadow_samples: settings.shadow_samples.max(MIN_SHADOW_SAMPLES),
            warnings: warnings(&layers),
            lights: gpu.storage("lights", if lights.is_empty() { &[GpuLight::DARK] } else { &lights }),
            layers,
        })
    }
}

/// The scene's lights; the first ones have maps, in layers without gaps, with room for what is grown.
pub fn gpu_lights(scene: &Scene, growth_mm: f32) -> Vec<GpuLight> {
    let mut next = 0;
    let light = |(light, slide_first)| {
        let layer = (next < SHADOW_BUDGET as u32).then_some(next);
        let light = GpuLight { slide_first, ..GpuLight::new(light, &scene.objects, growth_mm, layer) };
        next += u32::from(light.map_layer != NO_MAP);
        light
    };
    scene.lights.iter().zip(first_texels(&scene.lights)).map(light).collect()
}

/// What the technique that draws wants of depth maps, if it takes them.
fn depth_absorption(settings: &Settings) -> Option<&DepthAbsorptionSettings> {
    let is_wanted = settings.light_inside() == TechniqueName::DepthAbsorption;
    is_wanted.then_some(&settings.techniques.depth_absorption)
}

/// All vertices, mm.
fn points(scene: &Scene) -> Vec<Vec3> {
    scene.objects.iter().flat_map(|object| object.mesh.positions_mm.iter().copied()).collect()
}

fn warnings(layers: &[Option<u32>]) -> Vec<String> {
    let without = layers.iter().enumerate().filter(|(_, layer)| layer.is_none());
    let why = "it stands within the scene or too close to it, or there are more lights than maps";
    without.map(|(l, _)| format!("light {} casts no shadow on the GPU: {why}", l + 1)).collect()
}
