//! Diffusion of light over the unrolled surface: from irradiance to one map per Gaussian.
//!
//! An operator takes the fields at full size and gives back a [`Diffused`]; what is done in between is its own affair.
//! There are three: [`Separable`] (d'Eon, Luebke & Enderton 2007, section 5.1), [`HeatFlow`] and [`SevenTaps`] (Green 2004,
//! section 16.4).

use crate::RenderError;
use crate::passes::atlas::{ChartMap, NO_CHART};
use crate::passes::blur::{Axis, Fields, Widening, blur};
use crate::passes::heat_flow::HeatFlow;
use crate::passes::object_maps::ObjectMaps;
use crate::passes::seven_taps::SevenTaps;
use crate::progress::Progress;
use crate::settings::{Diffusion, Settings, TechniqueName};
use cutis_scene::Object;
use glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;
use std::sync::Arc;

/// Something that can spread light over a surface.
pub trait DiffusionOperator: Sync {
    /// Blurs `fields` by every variance in turn (growing, mm²). Level 0 of the result is `fields` itself.
    fn diffuse(
        &self,
        charts: Arc<ChartMap>,
        fields: Fields,
        variances_mm2: &[f32],
        progress: &dyn Progress,
    ) -> Diffused;
}

/// The light before and after every Gaussian.
#[derive(Debug, Clone)]
pub struct Diffused {
    /// Level 0 is unblurred; level i is blurred by the i-th variance.
    pub levels: Vec<Level>,
}

/// One blurred state of all layers.
#[derive(Debug, Clone)]
pub struct Level {
    /// Charts at this level's size.
    pub charts: Arc<ChartMap>,
    /// The layers of [`Fields`].
    pub layers: Arc<Vec<Vec<Vec4>>>,
}

impl Diffused {
    /// Bilinear read of a layer at a level, within one chart. A chart too thin for a coarse level is read from the
    /// nearest finer one that has it; black if none does.
    pub fn sample(&self, level: usize, layer: usize, uv: Vec2, chart: u32) -> Vec4 {
        let level = level.min(self.levels.len() - 1);
        let mut candidates = self.levels[..=level].iter().rev();
        candidates.find_map(|l| l.charts.sample(&l.layers[layer], uv, chart)).unwrap_or(Vec4::ZERO)
    }

    /// The kernel's sum of Gaussians at a place: radiant exitance under the surface, W/m².
    pub fn weighted_sum(&self, weights: &[Vec3], uv: Vec2, chart: u32) -> Vec3 {
        weights.iter().enumerate().map(|(i, &w)| w * self.sample(i + 1, 0, uv, chart).truncate()).sum()
    }
}

/// The operator that the light of an object is spread by. `through` is light that came through its thin parts, at half the
/// size, where the technique adds that before it spreads anything.
///
/// # Errors
/// If it follows from the material, and that has no kernel.
pub fn operator<'a>(
    settings: &Settings,
    object: &'a Object,
    maps: &'a ObjectMaps,
    through: Option<Vec<Vec4>>,
) -> Result<Box<dyn DiffusionOperator + 'a>, RenderError> {
    Ok(match (settings.technique, settings.diffusion) {
        (TechniqueName::TextureBlur, Diffusion::Separable | Diffusion::HeatFlow) => {
            Box::new(SevenTaps::new(object, maps, through, settings)?)
        }
        (TechniqueName::TextureSpace, Diffusion::HeatFlow) => {
            Box::new(HeatFlow::new(object, &maps.atlas, &maps.stretch_mm, &maps.kernel.variances_mm2))
        }
        // Without diffusion the kernel is one Gaussian of no width, which any operator leaves as it is.
        _ => Box::new(Separable),
    })
}

/// Seven-tap blurs along u and v, each Gaussian from the one before, wide ones in smaller textures.
#[derive(Debug, Clone, Copy, Default)]
pub struct Separable;

/// A Gaussian may live in a smaller texture when its standard deviation is still this many texels there. At 1.75, the
/// variance that bilinear reads add varies by at most 1/8 texel² about its mean, 4 % of 3; only wide Gaussians, with
/// little power, are that coarse.
const COARSE_DEVIATION_TEXELS: f32 = 1.75;
/// Smallest texture: below this, charts dissolve and nothing is left to save.
const MIN_SIZE: usize = 64;
/// A step may at most quadruple the variance (section 5.1 of the paper): ripples of exp(-2 pi²/3) = 0.14 %.
const MAX_RATIO: f32 = 4.0;
/// Only triple it from a deviation of one to two texels, where interpolation adds to the ripples. Below, the light
/// keeps to its texels whatever is done.
const FINE_RATIO: f32 = 3.0;
/// Variances in texel² between which steps are finer.
const FINE_TEXEL2: std::ops::Range<f32> = 0.9..4.0;
/// Largest first step from raw texels, texel²: the taps then lie one texel apart.
const FIRST_STEP_TEXEL2: f32 = 1.1;
/// Mean variance that bilinear reads add, texel²: f(1-f) over all f.
const BILINEAR_TEXEL2: f32 = 1.0 / 6.0;
/// Texels that are asked for the median of their size.
const MEDIAN_TEXELS: usize = 1 << 14;
/// Charts of fewer texels do not count in it, if others do: one with two rings of padding around it.
const TELLING_TEXELS: usize = 26;
/// Variance that averaging two neighbours adds, in texel² of the halved texture: (1/2)² of the finer, 1/16 here.
const HALVING_TEXEL2: f32 = 1.0 / 16.0;

impl DiffusionOperator for Separable {
    fn diffuse(
        &self,
        charts: Arc<ChartMap>,
        fields: Fields,
        variances_mm2: &[f32],
        progress: &dyn Progress,
    ) -> Diffused {
        progress.begin("blur", variances_mm2.len() as u64);
        let texel_mm = median_texel_mm(&charts, &fields.stretch_mm);
        let actions = plan(charts.size, texel_mm, variances_mm2);
        let mut state = State::new(charts, fields);
        let mut levels = vec![state.level()];
        for action in actions {
            match action {
                Action::Halve => state.halve(),
                Action::Step(widening) => state.step(widening),
                Action::Keep => {
                    levels.push(state.level());
                    progress.advance(1);
                }
            }
        }
        Diffused { levels }
    }
}

/// One thing that is done on the way from irradiance to the widest Gaussian.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Action {
    /// Everything moves on to textures of half the size.
    Halve,
    /// A blur along u, then along v.
    Step(Widening),
    /// What there is now is the level of the next Gaussian.
    Keep,
}

/// How [`Separable`] gets to every variance (growing, mm²) from a map of `size` texels, most of them `texel_mm` wide.
pub fn plan(size: usize, texel_mm: f32, variances_mm2: &[f32]) -> Vec<Action> {
    let mut way = Way { size, texel_mm, saved_texel2: 0.0, left_to_read_texel2: 0.0 };
    let mut actions = Vec::new();
    let mut reached_mm2 = 0.0;
    for &variance_mm2 in variances_mm2 {
        while way.can_be_halved_for(variance_mm2) {
            way.halve();
            actions.push(Action::Halve);
        }
        while reached_mm2 < variance_mm2 {
            let to_mm2 = way.next_step_mm2(reached_mm2, variance_mm2);
            let saved_texel2 = std::mem::take(&mut way.saved_texel2);
            actions.push(Action::Step(Widening { from_mm2: reached_mm2, to_mm2, saved_texel2 }));
            reached_mm2 = to_mm2;
        }
        actions.push(Action::Keep);
    }
    actions
}

/// Where a plan has got to.
struct Way {
    /// Width and height of the textures, texels.
    size: usize,
    /// Texel size that half of the surface falls below, mm.
    texel_mm: f32,
    /// Variance the next step leaves out, texel².
    saved_texel2: f32,
    /// Variance left to the final bilinear read so far, texel².
    left_to_read_texel2: f32,
}

impl Way {
    fn can_be_halved_for(&self, variance_mm2: f32) -> bool {
        let halves = self.size.is_multiple_of(2) && self.size / 2 >= MIN_SIZE;
        halves && variance_mm2.sqrt() >= COARSE_DEVIATION_TEXELS * 2.0 * self.texel_mm
    }

    fn halve(&mut self) {
        self.size /= 2;
        self.texel_mm *= 2.0;
        // A quarter of each amount, because a texel² is now four times as large.
        self.saved_texel2 =
            0.25 * self.saved_texel2 + HALVING_TEXEL2 + BILINEAR_TEXEL2 - 0.25 * self.left_to_read_texel2;
        self.left_to_read_texel2 = BILINEAR_TEXEL2;
    }

    /// Variance to go to next on the way from `reached` to `wanted`, so that the taps never skip texels that matter.
    fn next_step_mm2(&self, reached_mm2: f32, wanted_mm2: f32) -> f32 {
        let texel2_mm2 = self.texel_mm * self.texel_mm;
        let ratio = if FINE_TEXEL2.contains(&(reached_mm2 / texel2_mm2)) { FINE_RATIO } else { MAX_RATIO };
        // 2 % of slack, so that a kernel made for this rule does not cost a step more.
        let most_mm2 = (ratio * reached_mm2).max(reached_mm2 + FIRST_STEP_TEXEL2 * texel2_mm2);
        if wanted_mm2 <= 1.02 * most_mm2 { wanted_mm2 } else { most_mm2 }
    }
}

/// Fields on their way through the levels.
struct State {
    charts: Arc<ChartMap>,
    fields: Fields,
    scratch: Fields,
}

impl State {
    fn new(charts: Arc<ChartMap>, fields: Fields) -> Self {
        let scratch = fields.zeros_like();
        Self { charts, fields, scratch }
    }

    fn level(&self) -> Level {
        Level { charts: Arc::clone(&self.charts), layers: Arc::clone(&self.fields.layers) }
    }

    fn halve(&mut self) {
        let coarse = self.charts.halved();
        self.fields = halved_fields(&self.charts, &coarse, &self.fields);
        self.scratch = self.fields.zeros_like();
        self.charts = Arc::new(coarse);
    }

    fn step(&mut self, widening: Widening) {
        blur(&self.charts, Axis::U, widening, &self.fields, &mut self.scratch);
        blur(&self.charts, Axis::V, widening, &self.scratch, &mut self.fields);
    }
}

/// The texel size (the smaller of both directions) below which half of the surface lies, mm.
pub fn median_texel_mm(charts: &ChartMap, stretch_mm: &[Vec2]) -> f32 {
    // Texels that a chart thinner than they are has claimed stand for less of the surface than their stretch tells.
    let count = charts.chart.iter().filter(|c| **c != NO_CHART).max().map_or(0, |&last| last as usize + 1);
    let mut texels = vec![0; count];
    charts.chart.iter().filter(|c| **c != NO_CHART).for_each(|&c| texels[c as usize] += 1);
    let least = if texels.iter().any(|&count| count >= TELLING_TEXELS) { TELLING_TEXELS } else { 0 };
    let tells = |c: u32| c != NO_CHART && texels[c as usize] >= least;
    // A few thousand texels are plenty for a median; an odd stride divides no texture size.
    let stride = (stretch_mm.len() / MEDIAN_TEXELS) | 1;
    let covered = charts.chart.iter().zip(stretch_mm).step_by(stride).filter(|(c, _)| tells(**c));
    let mut sizes: Vec<(f32, f64)> = covered.map(|(_, s)| (s.min_element(), f64::from(s.x * s.y))).collect();
    sizes.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = sizes.iter().map(|s| s.1).sum();
    let mut sum = 0.0;
    let middle = sizes.iter().find(|(_, area)| {
        sum += area;
        sum >= 0.5 * total
    });
    middle.map_or(1.0, |s| s.0)
}

/// The mean over the texels of the same chart; the stretch counts for coarse texels.
pub fn halved_fields(fine: &ChartMap, coarse: &ChartMap, fields: &Fields) -> Fields {
    let layers = fields.layers.iter().map(|layer| halved(fine, coarse, layer, Vec4::ZERO)).collect();
    let mut stretch_mm = halved(fine, coarse, &fields.stretch_mm, Vec2::ZERO);
    stretch_mm.par_iter_mut().for_each(|s| *s *= 2.0);
    Fields::new(layers, stretch_mm)
}

fn halved<T>(fine: &ChartMap, coarse: &ChartMap, map: &[T], zero: T) -> Vec<T>
where
    T: Copy + Send + Sync + std::ops::Add<Output = T> + std::ops::Mul<f32, Output = T>,
{
    let mean = |i: usize| {
        let chart = coarse.chart[i];
        if chart == NO_CHART {
            return zero;
        }
        let children = fine.children(i % coarse.size, i / coarse.size);
        if children.iter().all(|&c| fine.chart[c] == chart) {
            let [a, b, c, d] = children.map(|c| map[c]);
            return (a + b + c + d) * 0.25;
        }
        let own = children.into_iter().filter(|&c| fine.chart[c] == chart);
        let (sum, count) = own.fold((zero, 0.0f32), |(sum, count), c| (sum + map[c], count + 1.0));
        sum * count.recip()
    };
    (0..coarse.size * coarse.size).into_par_iter().map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half of the surface, by area, lies under texels of 1 mm or less; a texel that a needle has claimed and its padding, a metre wide
    /// by their stretch, change nothing, unless there is nothing else.
    #[test]
    fn the_usual_texel_is_none_that_a_needle_claims() {
        let map = |needle: usize| {
            let chart_of = |i: usize| if i < needle { 1 } else { 0 };
            let stretch_mm =
                |i: usize| Vec2::splat(if i < needle { 1000.0 } else { [1.0, 2.0][i % 16 / 13] });
            let charts = ChartMap::new(16, (0..256).map(chart_of).collect());
            median_texel_mm(&charts, &(0..256).map(stretch_mm).collect::<Vec<_>>())
        };
        assert_eq!([map(0), map(25), map(26), map(256)], [1.0, 1.0, 1000.0, 1000.0]);
        let alone = ChartMap::new(2, vec![0, 1, 2, 3]);
        assert_eq!(median_texel_mm(&alone, &[Vec2::splat(2.0); 4]), 2.0);
    }
}
