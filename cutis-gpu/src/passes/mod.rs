//! The passes of the frame, by the names the papers give them; each beside its WGSL. Each makes steps that are prepared
//! once and run in every frame.

pub mod atlas;
pub mod bloom;
pub mod deform;
pub mod depth_map;
pub mod diffusion;
pub mod downsample;
pub mod gather;
pub mod heat_flow;
pub mod inside;
pub mod irradiance;
pub mod irradiance_image;
pub mod levels;
pub mod openness;
pub mod resolve;
pub mod sample_profile;
pub mod seven_taps;
pub mod shadow;
pub mod shares;
pub mod stretch;
pub mod thin_parts;
pub mod tone_map;
pub mod transmission;
pub mod visibility;

use crate::Gpu;
use crate::map::{Map, View};
use crate::pipeline::{Bound, Pipeline};
use crate::scene::charts::ChartTexture;
use crate::step::{Draw, Step};

/// Side of a tile of a map that is drawn or left out, texels; also in `lib/tiles.wgsl`.
pub const TILE_TEXELS: usize = 16;
/// Lights that are looked at together: as many as a texel has channels.
pub const LIGHTS_TOGETHER: usize = 4;

/// Where `lib/lights.wgsl` has the images of projectors bound.
pub const SLIDES: u32 = 29;

/// Everything that is compiled once.
#[derive(Debug)]
pub struct Passes {
    /// How textures are read.
    pub samplers: Samplers,
    /// Pass `deform`.
    pub deform: deform::DeformPass,
    /// Pass `stretch`.
    pub stretch: stretch::StretchPass,
    /// Pass `atlas`.
    pub atlas: atlas::AtlasPass,
    /// Pass `openness`.
    pub openness: openness::OpennessPass,
    /// Pass `shadow map`.
    pub shadow: shadow::ShadowPass,
    /// Pass `shadows`.
    pub visibility: visibility::VisibilityPass,
    /// Pass `depth map`.
    pub depth_map: depth_map::DepthMapPass,
    /// Pass `irradiance`.
    pub irradiance: irradiance::IrradiancePass,
    /// Pass `shares`.
    pub shares: shares::SharesPass,
    /// Pass `blur`.
    pub diffusion: diffusion::DiffusionPass,
    /// Pass `heat flow`.
    pub heat_flow: heat_flow::HeatFlowPass,
    /// Pass `blur` of the technique `texture-blur`.
    pub seven_taps: seven_taps::SevenTapsPass,
    /// Pass `transmission` of the technique `texture-blur`.
    pub thin_parts: thin_parts::ThinPartsPass,
    /// Pass `gather`.
    pub gather: gather::GatherPass,
    /// Pass `transmission`.
    pub transmission: transmission::TransmissionPass,
    /// Pass `resolve`.
    pub resolve: resolve::ResolvePass,
    /// Pass `irradiance image`.
    pub irradiance_image: irradiance_image::IrradianceImagePass,
    /// Pass `sample profile`.
    pub sample_profile: sample_profile::SampleProfilePass,
    /// Pass `downsample`.
    pub downsample: downsample::DownsamplePass,
    /// Pass `bloom`.
    pub bloom: bloom::BloomPass,
    /// Pass `tone map`.
    pub tone_map: tone_map::ToneMapPass,
}

impl Passes {
    /// Compiles all of them.
    pub fn new(gpu: &Gpu) -> Self {
        let samplers = Samplers::new(gpu);
        Self {
            deform: deform::DeformPass::new(gpu),
            stretch: stretch::StretchPass::new(gpu),
            atlas: atlas::AtlasPass::new(gpu),
            openness: openness::OpennessPass::new(gpu),
            shadow: shadow::ShadowPass::new(gpu),
            visibility: visibility::VisibilityPass::new(gpu),
            depth_map: depth_map::DepthMapPass::new(gpu),
            irradiance: irradiance::IrradiancePass::new(gpu),
            shares: shares::SharesPass::new(gpu),
            diffusion: diffusion::DiffusionPass::new(gpu, &samplers),
            heat_flow: heat_flow::HeatFlowPass::new(gpu, &samplers),
            seven_taps: seven_taps::SevenTapsPass::new(gpu),
            thin_parts: thin_parts::ThinPartsPass::new(gpu),
            gather: gather::GatherPass::new(gpu),
            transmission: transmission::TransmissionPass::new(gpu),
            resolve: resolve::ResolvePass::new(gpu),
            irradiance_image: irradiance_image::IrradianceImagePass::new(gpu),
            sample_profile: sample_profile::SampleProfilePass::new(gpu),
            downsample: downsample::DownsamplePass::new(gpu),
            bloom: bloom::BloomPass::new(gpu),
            tone_map: tone_map::ToneMapPass::new(gpu),
            samplers,
        }
    }
}

/// The ways in which textures are read.
#[derive(Debug)]
pub struct Samplers {
    /// The nearest texel; the edge goes on outside.
    pub nearest: wgpu::Sampler,
    /// Bilinear; the edge goes on outside.
    pub linear: wgpu::Sampler,
    /// Bilinear; repeats.
    pub repeating: wgpu::Sampler,
    /// Bilinear; repeats along u, as a latitude-longitude map needs.
    pub around_sky: wgpu::Sampler,
}

impl Samplers {
    fn new(gpu: &Gpu) -> Self {
        use wgpu::{AddressMode, FilterMode};
        let sampler = |label, filter, u, v| {
            gpu.device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some(label),
                address_mode_u: u,
                address_mode_v: v,
                mag_filter: filter,
                min_filter: filter,
                ..wgpu::SamplerDescriptor::default()
            })
        };
        let (clamp, repeat) = (AddressMode::ClampToEdge, AddressMode::Repeat);
        let linear = FilterMode::Linear;
        Self {
            nearest: sampler("nearest", FilterMode::Nearest, clamp, clamp),
            linear: sampler("linear", linear, clamp, clamp),
            repeating: sampler("repeating", linear, repeat, repeat),
            around_sky: sampler("around the sky", linear, repeat, clamp),
        }
    }
}

/// A draw over a whole picture, whose shader has the vertices of `lib/cover.wgsl`.
fn over_picture(gpu: &Gpu, pipeline: &Pipeline, bound: &[(u32, Bound)], picture: &Map) -> Step {
    Step::Draw(Draw {
        pipeline: pipeline.clone(),
        bind_groups: vec![pipeline.bind(gpu, 0, bound)],
        targets: vec![picture.view().clone()],
        depth: None,
        clear: None,
        indices: None,
        vertices: 3,
        instances: 1,
    })
}

/// A draw over all tiles of a map that hold a chart. Binding 0 is the list of these; `clear` empties the targets before.
fn over_charts(
    gpu: &Gpu,
    pipeline: &Pipeline,
    charts: &ChartTexture,
    bound: &[(u32, Bound)],
    targets: &[&View],
    clear: bool,
) -> Step {
    over_tiles(gpu, pipeline, (&charts.tiles, charts.runs), bound, targets, clear)
}

/// The same over a list of so many runs of tiles.
fn over_tiles(
    gpu: &Gpu,
    pipeline: &Pipeline,
    (tiles, runs): (&wgpu::Buffer, u32),
    bound: &[(u32, Bound)],
    targets: &[&View],
    clear: bool,
) -> Step {
    let mut all = vec![(0, Bound::Buffer(tiles))];
    all.extend_from_slice(bound);
    Step::Draw(Draw {
        pipeline: pipeline.clone(),
        bind_groups: vec![pipeline.bind(gpu, 0, &all)],
        targets: targets.iter().map(|&view| view.clone()).collect(),
        depth: None,
        clear: clear.then_some(wgpu::Color::TRANSPARENT),
        // Two triangles for every run of tiles.
        indices: None,
        vertices: 6,
        instances: runs,
    })
}
