//! Where the light lives before and after every Gaussian: one texture, so that a pass reads all of it at once. Its layers
//! are halved as often as its widest Gaussians need, and a level is some layers of one size.

use crate::Gpu;
use crate::map::{Map, Pyramid, View};
use crate::scene::charts::ChartTexture;
use bytemuck::{Pod, Zeroable};
use cutis_render::passes::blur::Widening;
use cutis_render::passes::diffusion::Action;
use wgpu::TextureFormat as Format;

/// Most Gaussians of a kernel; also in the shaders.
pub const MAX_GAUSSIANS: usize = 16;
/// Most sizes of levels: one for every Gaussian, and one for the light before; also in the shaders.
pub const MAX_SIZES: usize = MAX_GAUSSIANS + 1;

/// The light before any blur and after every Gaussian.
#[derive(Debug)]
pub struct Levels {
    /// Level 0 is unblurred; level i is blurred by the i-th variance.
    pub all: Vec<Level>,
    /// All levels of all sizes.
    pub texture: View,
}

/// One blurred state of all layers.
#[derive(Debug, Clone)]
pub struct Level {
    /// Charts at this level's size.
    pub charts: ChartTexture,
    /// Irradiance with distance in alpha; with several lights, their distances in further layers.
    pub light: Map,
}

/// Gaussians whose levels have one size; its twin has the same name.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
pub struct LevelSize {
    /// How often the first size is halved.
    pub halvings: u32,
    /// Number of the first of the Gaussians after these.
    pub end: u32,
    /// How often the size before is halved; the first has itself.
    pub finer_halvings: u32,
    /// First layer of the last level of the size before.
    pub finer_layer: u32,
}

/// How often the first size is halved, and the place among the levels of that size.
type Place = [usize; 2];

impl Levels {
    /// A texture for what `actions` keep, `layers` layers for each level. `charts` are those of the first size and of every
    /// halved one.
    pub fn new(gpu: &Gpu, charts: &[ChartTexture], layers: u32, actions: &[Action]) -> Self {
        let (places, counts) = places(actions);
        let most = counts.iter().max().map_or(1, |&count| count as u32);
        let halvings = counts.len() as u32 - 1;
        let pyramid =
            Pyramid::new(gpu, "levels", charts[0].size, [most * layers, halvings], Format::Rgba16Float);
        let level = |[halvings, place]: Place| Level {
            charts: charts[halvings].clone(),
            light: pyramid.part(halvings as u32, place as u32 * layers, layers),
        };
        Self { all: places.into_iter().map(level).collect(), texture: pyramid.array }
    }

    /// A texture for a light map, what one blur makes of it, and the light map once more: a share of it may leave unblurred.
    pub fn of_one_blur(gpu: &Gpu, charts: &[ChartTexture], layers: u32) -> Self {
        let widening = Widening { from_mm2: 0.0, to_mm2: 0.0, saved_texel2: 0.0 };
        let mut levels = Self::new(gpu, charts, layers, &[Action::Step(widening), Action::Keep]);
        levels.all.push(levels.all[0].clone());
        levels
    }

    /// The Gaussians by the sizes of their levels, the largest first. The first entry is of full size and may be empty.
    pub fn sizes(&self) -> Vec<LevelSize> {
        let mut sizes = vec![LevelSize::zeroed()];
        for (end, pair) in (1..).zip(self.all.windows(2)) {
            let (before, halvings) = (&pair[0].light, pair[1].light.halvings);
            if halvings > before.halvings {
                let (finer_halvings, finer_layer) = (before.halvings, before.first_layer);
                sizes.push(LevelSize { halvings, finer_halvings, finer_layer, end });
            }
            let last = sizes.len() - 1;
            sizes[last].end = end;
        }
        sizes
    }
}

/// Where every level lives, and how many there are of every size.
fn places(actions: &[Action]) -> (Vec<Place>, Vec<usize>) {
    let (mut places, mut counts) = (vec![[0, 0]], vec![1]);
    let mut blurred = false;
    for action in actions {
        match action {
            Action::Halve => counts.push(0),
            Action::Step(_) => blurred = true,
            Action::Keep if blurred => {
                let size = counts.len() - 1;
                places.push([size, counts[size]]);
                counts[size] += 1;
                blurred = false;
            }
            // Nothing has been done since the level before: that one serves again.
            Action::Keep => places.push(places[places.len() - 1]),
        }
    }
    (places, counts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_of_one_size_lie_side_by_side() {
        let step = Action::Step(Widening { from_mm2: 0.0, to_mm2: 1.0, saved_texel2: 0.0 });
        let (keep, halve) = (Action::Keep, Action::Halve);
        let actions = [keep, step, keep, step, keep, halve, halve, step, keep, keep];
        let (places, counts) = places(&actions);
        assert_eq!(places, [[0, 0], [0, 0], [0, 1], [0, 2], [2, 0], [2, 0]]);
        assert_eq!(counts, [3, 0, 1]);
    }
}
