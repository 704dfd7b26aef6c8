//! Where the light lives before and after every Gaussian. Levels of one size are layers of one texture, so that a pass reads
//! all of them at once.

use crate::Gpu;
use crate::map::Map;
use crate::scene::charts::ChartTexture;
use cutis_render::passes::diffusion::Action;
use wgpu::TextureFormat as Format;

/// Most Gaussians of a kernel; also in the shaders.
pub const MAX_GAUSSIANS: usize = 16;

/// The light before any blur and after every Gaussian.
#[derive(Debug)]
pub struct Levels {
    /// Level 0 is unblurred; level i is blurred by the i-th variance.
    pub all: Vec<Level>,
    /// The textures they live in, the largest first.
    pub sizes: Vec<LevelSize>,
}

/// One blurred state of all layers.
#[derive(Debug, Clone)]
pub struct Level {
    /// Charts at this level's size.
    pub charts: ChartTexture,
    /// Irradiance with distance in alpha; with several lights, their distances in further layers.
    pub light: Map,
    /// Which of the sizes it has.
    pub size: usize,
}

/// All levels of one size.
#[derive(Debug)]
pub struct LevelSize {
    /// Their charts.
    pub charts: ChartTexture,
    /// Their layers, level by level.
    pub light: Map,
    /// Layer of the last of them.
    pub last_layer: u32,
}

/// Number of the size and place among the levels of that size.
type Place = [usize; 2];

impl Levels {
    /// Textures for what `actions` keep, `layers` layers for each level. `charts` are those of the first size and of every
    /// halved one.
    pub fn new(gpu: &Gpu, charts: &[ChartTexture], layers: u32, actions: &[Action]) -> Self {
        let (places, counts) = places(actions);
        let size = |(charts, &count): (&ChartTexture, &usize)| {
            let all = count as u32 * layers;
            let light = Map::square(gpu, "levels", charts.size, all, Format::Rgba16Float);
            LevelSize { charts: charts.clone(), light, last_layer: all - layers }
        };
        let sizes: Vec<_> = charts.iter().zip(&counts).filter(|(_, count)| **count > 0).map(size).collect();
        let level = |[halvings, place]: Place| {
            let size = counts[..halvings].iter().filter(|count| **count > 0).count();
            let LevelSize { charts, light, .. } = &sizes[size];
            Level { charts: charts.clone(), light: light.part(place as u32 * layers, layers), size }
        };
        Self { all: places.into_iter().map(level).collect(), sizes }
    }

    /// Number of the size of a Gaussian's level.
    pub fn size_of(&self, gaussian: usize) -> usize {
        self.all[gaussian + 1].size
    }

    /// The size before one; the largest has itself.
    pub fn finer_than(&self, size: usize) -> &LevelSize {
        &self.sizes[size.saturating_sub(1)]
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
    use cutis_render::passes::blur::Widening;

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
