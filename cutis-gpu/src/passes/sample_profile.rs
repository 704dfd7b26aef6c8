//! Samples of the diffusion profile around every sample of the picture. The twin of cutis-render's technique `image_space`.

use crate::Gpu;
use crate::map::Map;
use crate::passes::irradiance_image::IrradianceImages;
use crate::pipeline::{Blueprint, Bound, Pipeline};
use crate::scene::shared::Shared;
use crate::shaders;
use crate::step::{Draw, Step};
use bytemuck::{Pod, Zeroable};
use cutis_render::prepare::mixtures;
use cutis_render::prepare::radial::RadialKernel;
use cutis_render::technique::image_space::{MAX_LIGHT_VIEWS, SampleCount};
use cutis_render::{RenderError, Settings};
use cutis_scene::Scene;
use wgpu::TextureFormat as Format;

/// What is gathered from; its twin has the same name.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Gathering {
    /// Lights whose images there are.
    pub lights: [u32; MAX_LIGHT_VIEWS],
    /// How many.
    pub light_count: u32,
    /// Places for a sample of the picture.
    pub place_count: u32,
    /// Whether areas on the plane are turned into areas on the body.
    pub jacobian: u32,
    /// Whether only samples that met the body count.
    pub count_valid: u32,
    /// Mixtures of every object's media.
    pub mixtures: u32,
    /// Number of the picture in a row of pictures.
    pub round: u32,
    /// Fills up the struct.
    pub pad0: u32,
    /// Fills up the struct.
    pub pad1: u32,
}

/// The profile of one mixture of one object; its twin has the same name.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Radial {
    /// Distance up to which the entries of the table are even, mm.
    pub fine_mm: f32,
    /// Entries for a factor of e far out.
    pub entries_per_e: f32,
    /// Fills up the struct.
    pub pad0: f32,
    /// Fills up the struct.
    pub pad1: f32,
}

/// A place on the tangent plane; its twin has the same name.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct PlaceToLook {
    /// Along tangent and bitangent, mm.
    pub offset_mm: [f32; 2],
    /// Samples that are to be expected there, per mm².
    pub density_per_mm2: f32,
    /// Fills up the struct.
    pub pad0: f32,
}

/// Profiles of all objects, and where they are looked up.
#[derive(Debug)]
pub struct Profiles {
    numbers: wgpu::Buffer,
    tables: wgpu::Buffer,
    places: wgpu::Buffer,
    radials: wgpu::Buffer,
    lights: Vec<u32>,
    /// Object by object, as many mixtures of each.
    kernels: Vec<RadialKernel>,
    mixtures: u32,
}

impl Profiles {
    /// Of a scene; `lights` are those that have an image.
    ///
    /// # Errors
    /// If a material has no profile that can be sampled.
    pub fn new(gpu: &Gpu, scene: &Scene, settings: &Settings, lights: &[u32]) -> Result<Self, RenderError> {
        let materials = || scene.objects.iter().map(|object| &object.material);
        let mixtures = mixtures::count(materials());
        let of = |material| RadialKernel::of_mixtures(material, settings, mixtures);
        // Room for a picture of one sample a pixel, which takes most places.
        let kernels = materials().map(of).collect::<Result<Vec<_>, _>>()?.concat();
        let tables: Vec<[f32; 4]> =
            kernels.iter().flat_map(|kernel| kernel.table.iter().map(|entry| entry.to_array())).collect();
        let radial = |kernel: &RadialKernel| Radial {
            fine_mm: kernel.fine_mm,
            entries_per_e: kernel.entries_per_e,
            ..Radial::zeroed()
        };
        let radials: Vec<Radial> = kernels.iter().map(radial).collect();
        let this = Self {
            numbers: gpu.uniform("gathering", &Gathering::zeroed()),
            tables: gpu.storage("tables of profiles", &tables),
            places: gpu.storage("places to look at", &places(&kernels)),
            radials: gpu.storage("profiles", &radials),
            lights: lights.to_vec(),
            kernels,
            mixtures,
        };
        this.set_sampling(gpu, settings)?;
        Ok(this)
    }

    /// Takes the places of a round, for as many samples of a pixel as the settings want.
    ///
    /// # Errors
    /// If the disc of the uniform samples has no radius.
    pub fn set_sampling(&self, gpu: &Gpu, settings: &Settings) -> Result<(), RenderError> {
        let grid = settings.samples_grid();
        let image_space = &settings.techniques.image_space;
        let again = |kernel: &RadialKernel| kernel.sampled(image_space, grid * grid);
        let kernels = self.kernels.iter().map(again).collect::<Result<Vec<_>, _>>()?;
        let mut numbers = Gathering {
            light_count: self.lights.len() as u32,
            place_count: kernels.first().map_or(0, |kernel| kernel.counts.iter().sum()),
            jacobian: u32::from(image_space.jacobian),
            count_valid: u32::from(image_space.count == SampleCount::Valid),
            mixtures: self.mixtures,
            round: image_space.round,
            ..Gathering::zeroed()
        };
        numbers.lights[..self.lights.len()].copy_from_slice(&self.lights);
        gpu.queue.write_buffer(&self.numbers, 0, bytemuck::bytes_of(&numbers));
        gpu.queue.write_buffer(&self.places, 0, bytemuck::cast_slice(&places(&kernels)));
        Ok(())
    }
}

fn places(kernels: &[RadialKernel]) -> Vec<PlaceToLook> {
    let place = |p: &cutis_render::prepare::radial::PlaceToLook| PlaceToLook {
        offset_mm: p.offset_mm.to_array(),
        density_per_mm2: p.density_per_mm2,
        pad0: 0.0,
    };
    kernels.iter().flat_map(|kernel| kernel.places.iter().map(place)).collect()
}

/// The pass's pipeline.
#[derive(Debug)]
pub struct SampleProfilePass {
    pipeline: Pipeline,
}

impl SampleProfilePass {
    /// Compiles it.
    pub fn new(gpu: &Gpu) -> Self {
        let blueprint = Blueprint {
            name: "sample profile",
            source: shaders::SAMPLE_PROFILE,
            entries: ["cover_picture", "sample_profile"],
            targets: &[Format::Rgba16Float, Format::Rgba16Float],
            additive: false,
            depth: false,
        };
        Self { pipeline: Pipeline::new(gpu, &blueprint) }
    }

    /// Gathers light for every sample of the picture from what the camera and some lights see, into the two layers of
    /// `gathered`.
    pub fn step(
        &self,
        gpu: &Gpu,
        shared: &Shared,
        profiles: &Profiles,
        [by_camera, by_lights]: [&IrradianceImages; 2],
        gathered: &Map,
    ) -> Step {
        let bound = [
            (0, Bound::Buffer(&shared.camera)),
            (1, Bound::Buffer(&shared.lights)),
            (2, Bound::Buffer(&profiles.numbers)),
            (3, Bound::Texture(&by_camera.places.layers[0])),
            (4, Bound::Texture(&by_camera.light.layers[0])),
            (5, Bound::Texture(&by_lights.places.array)),
            (6, Bound::Texture(&by_lights.light.array)),
            (7, Bound::Buffer(&profiles.tables)),
            (8, Bound::Buffer(&profiles.places)),
            (9, Bound::Buffer(&profiles.radials)),
        ];
        Step::Draw(Draw {
            pipeline: self.pipeline.clone(),
            bind_groups: vec![self.pipeline.bind(gpu, 0, &bound)],
            targets: gathered.layers.clone(),
            depth: None,
            clear: None,
            indices: None,
            vertices: 3,
            instances: 1,
        })
    }
}
