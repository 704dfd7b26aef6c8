//! The film on the device: from the light of a picture to 8-bit codes of a screen, on maps that are made once.

use super::GpuScene;
use crate::map::Map;
use crate::passes::Passes;
use crate::passes::bloom::GLOW;
use crate::passes::tone_map::{CODES, GpuFilm};
use crate::readback::Reader;
use crate::step::Step;
use crate::{Gpu, GpuError};
use cutis_render::PassTime;
use cutis_render::film::{Film, Spread};

/// How a picture is developed: the film, and the display-linear grey behind what is transparent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Developing {
    /// Exposure, bloom, tone mapper.
    pub film: Film,
    /// Grey behind, 0..=1.
    pub behind: f32,
}

/// What develops one picture.
#[derive(Debug)]
pub struct Development {
    /// What it does, once the picture is drawn.
    pub steps: Vec<Step>,
    /// How it does it.
    pub how: Developing,
    codes: Map,
    numbers: wgpu::Buffer,
    /// Side of a cell of the glow, pixels; none without glow.
    cell: Option<usize>,
    reader: Reader,
    /// Bytes of its maps.
    pub memory_bytes: u64,
}

/// Steps of a development at most.
pub const MAX_STEPS: usize = 4;

impl Development {
    /// Of a picture.
    pub fn new(gpu: &Gpu, passes: &Passes, picture: &Map, how: Developing) -> Self {
        let gpu = &gpu.counting();
        let size = [picture.width(), picture.height()];
        let spread = spread(&how.film, size[1]);
        let numbers = gpu.uniform("film", &GpuFilm::new(&how.film, spread.as_ref(), how.behind));
        let codes = Map::new(gpu, "codes", size, 1, CODES);
        let glow = spread.as_ref().map(|spread| {
            let cells = size.map(|side| side.div_ceil(spread.cell as u32));
            ["glow", "glow on its way"].map(|label| Map::new(gpu, label, cells, 1, GLOW))
        });
        let mut steps = Vec::new();
        if let Some(glow) = &glow {
            steps.extend(passes.bloom.steps(gpu, &numbers, picture, glow));
        }
        let light = (picture, glow.as_ref().map(|[first, _]| first));
        steps.push(passes.tone_map.step(gpu, &passes.samplers, &numbers, light, &codes));
        let (cell, reader) = (spread.map(|spread| spread.cell), Reader::new(gpu, &codes));
        Self { steps, how, codes, numbers, cell, reader, memory_bytes: gpu.asked_bytes() }
    }

    /// Whether another film only needs other numbers.
    fn serves(&self, film: &Film) -> bool {
        spread(film, self.codes.height()).map(|spread| spread.cell) == self.cell
    }

    fn set(&mut self, gpu: &Gpu, how: Developing) {
        let spread = spread(&how.film, self.codes.height());
        let numbers = GpuFilm::new(&how.film, spread.as_ref(), how.behind);
        gpu.queue.write_buffer(&self.numbers, 0, bytemuck::bytes_of(&numbers));
        self.how = how;
    }

    /// The codes of the picture that was developed last, row by row: red, green, blue, and 255.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn codes(&self, gpu: &Gpu) -> Result<Vec<[u8; 4]>, GpuError> {
        let bytes = self.reader.read(gpu, &self.codes, 0)?;
        Ok(bytes.chunks_exact(4).map(|code| [code[0], code[1], code[2], code[3]]).collect())
    }
}

fn spread(film: &Film, height: u32) -> Option<Spread> {
    film.bloom.and_then(|bloom| bloom.spread(height))
}

impl GpuScene {
    /// Develops pictures from now on, each when it is drawn. Another film needs neither new light nor a new picture: see
    /// [`Self::develop_timed`]. It is laid anew only where another bloom needs maps of another size.
    ///
    /// # Errors
    /// If the device has refused something.
    pub fn set_film(&mut self, gpu: &Gpu, passes: &Passes, how: Developing) -> Result<(), GpuError> {
        match &mut self.development {
            Some(development) if development.serves(&how.film) => development.set(gpu, how),
            other => *other = Some(Development::new(gpu, passes, &self.picture.pixels, how)),
        }
        gpu.check()
    }

    /// Develops no more pictures.
    pub fn unset_film(&mut self) {
        self.development = None;
    }

    /// Develops the picture that was drawn last once more, and tells how long each pass took.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn develop_timed(&self, gpu: &Gpu) -> Result<Vec<PassTime>, GpuError> {
        self.timing.run(gpu, self.film_steps())
    }

    /// The codes of the picture that was developed last, row by row: red, green, blue, and 255; none without a film.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn developed(&self, gpu: &Gpu) -> Result<Option<Vec<[u8; 4]>>, GpuError> {
        self.development.as_ref().map(|development| development.codes(gpu)).transpose()
    }

    /// The steps that develop a picture.
    pub(super) fn film_steps(&self) -> impl Iterator<Item = &Step> {
        self.development.iter().flat_map(|development| &development.steps)
    }

    /// Develops another picture by the film that there is.
    pub(super) fn lay_film(&mut self, gpu: &Gpu, passes: &Passes) {
        if let Some(development) = &mut self.development {
            *development = Development::new(gpu, passes, &self.picture.pixels, development.how);
        }
    }
}
