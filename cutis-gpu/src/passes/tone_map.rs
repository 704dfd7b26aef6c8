//! From light to 8-bit codes of a screen: the twin of cutis-render's `develop` and `codes`.

use super::Samplers;
use crate::Gpu;
use crate::map::Map;
use crate::pipeline::{Blueprint, Bound, Pipeline};
use crate::shaders;
use crate::step::Step;
use bytemuck::{Pod, Zeroable};
use cutis_render::film::{Film, MAX_REACH, Spread, ToneMapper};
use wgpu::TextureFormat as Format;

/// What codes are kept as.
pub const CODES: Format = Format::Rgba8Unorm;
/// Groups of four weights.
const QUARTETS: usize = MAX_REACH / 4 + 1;

/// The numbers of a film; the twin of `Film` in `lib/film.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct GpuFilm {
    /// Factor on the light.
    pub gain: f32,
    /// Display-linear grey behind what is transparent.
    pub behind: f32,
    /// Share of the light that is spread.
    pub strength: f32,
    /// One of the numbers in `tone_mappers.wgsl`.
    pub tone_mapper: u32,
    /// Side of a cell of the reduced copy, pixels.
    pub cell: i32,
    /// Cells to either side that the blur reaches.
    pub reach: i32,
    /// Fills up the struct.
    pub pad0: u32,
    /// Fills up the struct.
    pub pad1: u32,
    /// Weights of one half of the blur, from the middle outwards, four by four.
    pub weights: [[f32; 4]; QUARTETS],
}

impl GpuFilm {
    /// Of a film whose bloom, if it has one, spreads the light so.
    pub fn new(film: &Film, spread: Option<&Spread>, behind: f32) -> Self {
        let mut numbers = Self {
            gain: film.exposure_ev.exp2(),
            behind,
            tone_mapper: number(film.tone_mapper),
            ..Self::zeroed()
        };
        if let (Some(spread), Some(bloom)) = (spread, film.bloom) {
            numbers.strength = bloom.strength;
            numbers.cell = spread.cell as i32;
            numbers.reach = spread.weights.len() as i32 - 1;
            numbers.weights.as_flattened_mut()[..spread.weights.len()].copy_from_slice(&spread.weights);
        }
        numbers
    }
}

/// The number of a tone mapper in `tone_mappers.wgsl`.
pub fn number(tone_mapper: ToneMapper) -> u32 {
    match tone_mapper {
        ToneMapper::None => 0,
        ToneMapper::Reinhard => 1,
        ToneMapper::Aces => 2,
        ToneMapper::AgX => 3,
        ToneMapper::Neutral => 4,
    }
}

/// The pass's pipelines.
#[derive(Debug)]
pub struct ToneMapPass {
    plain: Pipeline,
    with_glow: Pipeline,
}

impl ToneMapPass {
    /// Compiles them.
    pub fn new(gpu: &Gpu) -> Self {
        let pipeline = |entry| {
            let (name, source, targets) = ("tone map", shaders::TONE_MAP, &[CODES]);
            let entries = ["cover_picture", entry];
            Pipeline::new(gpu, &Blueprint { name, source, entries, targets, additive: false, depth: false })
        };
        Self { plain: pipeline("develop"), with_glow: pipeline("develop_with_glow") }
    }

    /// From a picture, and its glow if it has one, to codes; `film` holds the numbers.
    pub fn step(
        &self,
        gpu: &Gpu,
        samplers: &Samplers,
        film: &wgpu::Buffer,
        (picture, glow): (&Map, Option<&Map>),
        codes: &Map,
    ) -> Step {
        let mut bound = vec![(0, Bound::Texture(picture.view())), (1, Bound::Buffer(film))];
        let Some(glow) = glow else { return super::over_picture(gpu, &self.plain, &bound, codes) };
        bound.extend([(2, Bound::Texture(glow.view())), (3, Bound::Sampler(&samplers.linear))]);
        super::over_picture(gpu, &self.with_glow, &bound, codes)
    }
}
