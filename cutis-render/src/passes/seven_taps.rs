//! The blur of Green 2004 (GPU Gems, listings 16-6 and 16-7): seven taps, two texels apart so that each reads between two of
//! them, with weights for each channel; along u, then along v.
//!
//! The paper has one chart. Here taps come closer towards a seam, as those of [`crate::passes::blur`] do, so that none
//! reads another chart; what they would have read there does not exist on the body.

use crate::RenderError;
use crate::passes::atlas::{Atlas, ChartMap, NO_CHART};
use crate::passes::blur::{Axis, Fields};
use crate::passes::diffusion::{Diffused, DiffusionOperator, Level, median_texel_mm};
use crate::passes::object_maps::ObjectMaps;
use crate::prepare::kernel::kernel_of;
use crate::progress::Progress;
use crate::settings::Settings;
use crate::technique::texture_blur::{BlurWeights, BlurWidth, TextureBlurSettings};
use cutis_scene::Object;
use glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;
use std::ops::Range;
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
/// Farthest that a tap may lie, texels: a device knows no farther how far it is to the edge of a chart.
pub const FARTHEST_TEXELS: u16 = 255;

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

/// Second moment along its axis of what one blur makes of one texel, over its sum, texel²: the variance, where the weights
/// are as even as red's.
pub fn variance_texel2(weights: [f64; 7], factor: f64) -> f64 {
    let moment = |(weight, &offset): (&f64, &f32)| weight * read_square(f64::from(offset).abs() * factor);
    weights.iter().zip(&OFFSETS_TEXELS).map(moment).sum::<f64>() / weights.iter().sum::<f64>()
}

/// Mean square of the distances of both texels that a read `x` texels away takes in: (1-f) n² + f (n+1)² = x² + f (1-f) for
/// x = n + f.
fn read_square(x: f64) -> f64 {
    let n = x.floor();
    n * n + (2.0 * n + 1.0) * (x - n)
}

/// Factor on the offsets with which one blur has this variance, texel². It grows with the factor, along straight lines.
pub fn factor_for(variance: f64, weights: [f64; 7]) -> f64 {
    let mut high = 1.0;
    while variance_texel2(weights, high) < variance {
        high *= 2.0;
    }
    let mut low = 0.0;
    // As many halvings as a number of double precision has digits.
    for _ in 0..53 {
        let middle = 0.5 * (low + high);
        if variance_texel2(weights, middle) < variance { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Factor on the offsets of the taps of one object, most of whose texels are `texel_mm` wide.
///
/// # Errors
/// If it follows from the material, and that has no kernel.
pub fn factor_of(object: &Object, texel_mm: f32, settings: &Settings) -> Result<f32, RenderError> {
    let blur = &settings.techniques.texture_blur;
    match blur.width {
        BlurWidth::Listing(factor) => Ok(factor),
        BlurWidth::Material => {
            let kernel = kernel_of(&object.material, settings.gaussians)?;
            let deviation_texels = f64::from(kernel.deviation_mm().x / texel_mm);
            let red = weights(blur.weights).map(|weight| f64::from(weight.x));
            Ok(factor_for(deviation_texels * deviation_texels / f64::from(blur.passes.max(1)), red) as f32)
        }
    }
}

/// Numbers (0 the nearest to the surface) of those of `layers` under the surface that filter the light when `left` of
/// `passes` blurs are to come: the k-th before the last k begin, and what lies deeper than there are blurs before the first.
pub fn layers_due(layers: usize, passes: u32, left: u32) -> Range<usize> {
    let end = if left == passes { layers } else { left as usize };
    (left.saturating_sub(1) as usize).min(layers)..end.min(layers)
}

/// The operator, for one object.
pub struct SevenTaps<'a> {
    settings: TextureBlurSettings,
    factor: f32,
    object: &'a Object,
    atlas: &'a Atlas,
    /// Light that came through thin parts, W/m², at half the size.
    through: Option<(&'a ChartMap, Vec<Vec4>)>,
}

impl<'a> SevenTaps<'a> {
    /// For an object and its textures, with light that came through its thin parts (at half the size), if any.
    ///
    /// # Errors
    /// If the width follows from the material, and that has no kernel.
    pub fn new(
        object: &'a Object,
        maps: &'a ObjectMaps,
        through: Option<Vec<Vec4>>,
        settings: &Settings,
    ) -> Result<Self, RenderError> {
        let texel_mm = median_texel_mm(&maps.atlas.charts, &maps.stretch_mm);
        Ok(Self {
            settings: settings.techniques.texture_blur,
            factor: factor_of(object, texel_mm, settings)?,
            object,
            atlas: &maps.atlas,
            through: through.map(|light| (&maps.half_charts, light)),
        })
    }

    /// Adds what came through.
    fn add_through(&self, charts: &ChartMap, light: &mut [Vec4]) {
        let Some((half_charts, through)) = &self.through else { return };
        light.par_iter_mut().enumerate().filter(|(i, _)| charts.chart[*i] != NO_CHART).for_each(
            |(i, texel)| {
                let more = half_charts.sample(through, middle(charts, i), charts.chart[i]);
                *texel += more.map_or(Vec4::ZERO, |more| more.truncate().extend(0.0));
            },
        );
    }

    /// Multiplies the light by the colours of some layers under the surface.
    fn filter(&self, light: &mut [Vec4], layers: Range<usize>) {
        for layer in &self.object.material.under[layers] {
            light.par_iter_mut().enumerate().for_each(|(i, texel)| {
                let colour = self.atlas.map_uv_under(self.object, i).map_or(Vec3::ONE, |uv| layer.at(uv));
                *texel *= colour.extend(1.0);
            });
        }
    }
}

impl DiffusionOperator for SevenTaps<'_> {
    /// One level, whatever the variances: the map after all passes. After it the light as it was once more, for the share
    /// of it that leaves without having been blurred.
    fn diffuse(
        &self,
        charts: Arc<ChartMap>,
        fields: Fields,
        _variances_mm2: &[f32],
        progress: &dyn Progress,
    ) -> Diffused {
        let passes = self.settings.passes;
        progress.begin("blur", u64::from(passes));
        let due = |left| layers_due(self.object.material.under.len(), passes, left);
        let weights = weights(self.settings.weights);
        let sharp = Level { charts: Arc::clone(&charts), layers: Arc::clone(&fields.layers) };
        let mut light = fields.layers[0].clone();
        self.add_through(&charts, &mut light);
        if passes == 0 {
            self.filter(&mut light, due(0));
        }
        for left in (1..=passes).rev() {
            self.filter(&mut light, due(left));
            for axis in [Axis::U, Axis::V] {
                light = blurred(&charts, &light, axis, self.factor, &weights);
            }
            progress.advance(1);
        }
        let rest = fields.layers[1..].iter().cloned();
        let blurred = Level { charts, layers: Arc::new(std::iter::once(light).chain(rest).collect()) };
        Diffused { levels: vec![sharp.clone(), blurred, sharp] }
    }
}

fn middle(charts: &ChartMap, texel: usize) -> Vec2 {
    (Vec2::new((texel % charts.size) as f32, (texel / charts.size) as f32) + 0.5) / charts.size as f32
}

/// One blur along an axis, with the listing's offsets times a factor.
pub fn blurred(charts: &ChartMap, light: &[Vec4], axis: Axis, factor: f32, weights: &[Vec3; 7]) -> Vec<Vec4> {
    let (step, reach) = match axis {
        Axis::U => (1, &charts.reach_u),
        Axis::V => (charts.size as isize, &charts.reach_v),
    };
    let texel = |i: usize| {
        if charts.chart[i] == NO_CHART {
            return light[i];
        }
        let room = f32::from(reach[i].min(FARTHEST_TEXELS));
        let factor = factor.min(room / OFFSETS_TEXELS[6]);
        let taps = OFFSETS_TEXELS.iter().zip(weights).map(|(offset, weight)| {
            // The quotient above may be rounded upwards.
            let x = (offset * factor).clamp(-room, room);
            let at = |n: f32| light[(i as isize + n as isize * step) as usize].truncate();
            let (near, f) = (at(x.floor()), x - x.floor());
            let read = if f > 0.0 { near + (at(x.floor() + 1.0) - near) * f } else { near };
            read * *weight
        });
        taps.sum::<Vec3>().extend(light[i].w)
    };
    (0..light.len()).into_par_iter().map(texel).collect()
}
