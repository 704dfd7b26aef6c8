//! The glow around bright things: the twin of cutis-render's `Bloom`.

use crate::Gpu;
use crate::map::Map;
use crate::pipeline::{Blueprint, Bound, Pipeline};
use crate::shaders;
use crate::step::Step;
use wgpu::TextureFormat as Format;

/// What the reduced copy is kept as.
pub const GLOW: Format = Format::Rgba16Float;

/// The pass's pipelines.
#[derive(Debug)]
pub struct BloomPass {
    reduce: Pipeline,
    rows: Pipeline,
    columns: Pipeline,
}

impl BloomPass {
    /// Compiles them.
    pub fn new(gpu: &Gpu) -> Self {
        let pipeline = |entry| {
            let (name, source, targets) = ("bloom", shaders::BLOOM, &[GLOW]);
            let entries = ["cover_picture", entry];
            Pipeline::new(gpu, &Blueprint { name, source, entries, targets, additive: false, depth: false })
        };
        Self {
            reduce: pipeline("reduce"),
            rows: pipeline("blur_along_rows"),
            columns: pipeline("blur_along_columns"),
        }
    }

    /// From a picture to its glow, which ends in the first of two maps of one size; `film` holds the numbers.
    pub fn steps(&self, gpu: &Gpu, film: &wgpu::Buffer, picture: &Map, glow: &[Map; 2]) -> [Step; 3] {
        let step = |pipeline: &Pipeline, from: &Map, to: &Map| {
            let bound = [(0, Bound::Texture(from.view())), (1, Bound::Buffer(film))];
            super::over_picture(gpu, pipeline, &bound, to)
        };
        let [first, second] = glow;
        [
            step(&self.reduce, picture, first),
            step(&self.rows, first, second),
            step(&self.columns, second, first),
        ]
    }
}
