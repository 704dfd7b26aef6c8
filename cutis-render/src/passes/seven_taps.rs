//! The blur of Green 2004 (GPU Gems, listings 16-6 and 16-7): seven taps, two texels apart so that each reads between two of
//! them, with weights for each channel; along u, then along v.

use crate::passes::atlas::{ChartMap, NO_CHART};
use crate::passes::blur::Fields;
use crate::passes::diffusion::{Diffused, DiffusionOperator, Level};
use crate::progress::Progress;
use crate::technique::texture_blur::{BlurWeights, TextureBlurSettings};
use glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;
use std::sync::Arc;

/// Places of the taps, texels (listing 16-6).
pub const OFFSETS_TEXELS: [f32; 7] = [-5.5, -3.5, -1.5, 0.0, 1.5, 3.5, 5.5];
/// Weights of the taps for red, green and blue (listing 16-7).
pub const PRINTED_WEIGHTS: [[f32; 3]; 7] = [
    [0.006, 0.0, 0.0],
    [0.061, 0.0, 0.0],
    [0.242, 0.25, 0.25],
    [0.383, 0.5, 0.5],
    [0.242, 0.25, 0.20],
    [0.061, 0.0, 0.0],
    [0.006, 0.0, 0.0],
];

/// The weights that a choice means.
pub fn weights(choice: BlurWeights) -> [Vec3; 7] {
    let printed = PRINTED_WEIGHTS.map(Vec3::from_array);
    match choice {
        BlurWeights::Printed => printed,
        BlurWeights::Normalised => {
            let sum: Vec3 = printed.into_iter().sum();
            printed.map(|w| w / sum)
        }
    }
}

/// The operator.
#[derive(Debug, Clone, Copy)]
pub struct SevenTaps {
    settings: TextureBlurSettings,
}

impl SevenTaps {
    /// With these numbers.
    pub fn new(settings: TextureBlurSettings) -> Self {
        Self { settings }
    }
}

impl DiffusionOperator for SevenTaps {
    /// One level, whatever the variances: the map after all passes.
    fn diffuse(
        &self,
        charts: Arc<ChartMap>,
        fields: Fields,
        _variances_mm2: &[f32],
        progress: &dyn Progress,
    ) -> Diffused {
        progress.begin("blur", u64::from(self.settings.passes));
        let weights = weights(self.settings.weights);
        let sharp = Level { charts: Arc::clone(&charts), layers: Arc::clone(&fields.layers) };
        let mut light = fields.layers[0].clone();
        for _ in 0..self.settings.passes {
            for axis in [Vec2::X, Vec2::Y] {
                light = blurred(&charts, &light, axis, &weights);
            }
            progress.advance(1);
        }
        let rest = fields.layers[1..].iter().cloned();
        let blurred = Level { charts, layers: Arc::new(std::iter::once(light).chain(rest).collect()) };
        Diffused { levels: vec![sharp, blurred] }
    }
}

/// One blur along an axis. What a tap would read from another chart, it reads from the texel itself.
fn blurred(charts: &ChartMap, light: &[Vec4], axis: Vec2, weights: &[Vec3; 7]) -> Vec<Vec4> {
    let size = charts.size;
    let texel = |i: usize| {
        let chart = charts.chart[i];
        if chart == NO_CHART {
            return light[i];
        }
        let middle = Vec2::new((i % size) as f32, (i / size) as f32) + 0.5;
        let taps = OFFSETS_TEXELS.iter().zip(weights).map(|(offset, weight)| {
            let uv = (middle + axis * *offset) / size as f32;
            charts.sample(light, uv, chart).unwrap_or(light[i]).truncate() * *weight
        });
        taps.sum::<Vec3>().extend(light[i].w)
    };
    (0..light.len()).into_par_iter().map(texel).collect()
}
