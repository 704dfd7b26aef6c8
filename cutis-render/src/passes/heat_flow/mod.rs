//! Diffusion as heat flow from texel to texel: convolution with a Gaussian of variance v on a surface is heat flow for the time v/2.
//!
//! ```text
//! du/dt = 1/sqrt(det g) d_i (sqrt(det g) g^ij d_j u)
//! ```
//!
//! Finite elements on texels: light is bilinear between them, and charts are held together along their seams ([`gaps`]). All times
//! come from one row of exchanges ([`chebyshev`]), those of wide Gaussians from rows on smaller maps ([`coarse`]).
//! Not modelled: light that goes straight through the flesh from one fold of the surface to the next.

mod cells;
mod chebyshev;
pub mod coarse;
mod elements;
pub mod exchange;
mod gaps;
pub mod metric;
mod padding;
mod pattern;
mod row;
pub mod rows;
mod seam_edges;
pub mod shore;
mod squares;
mod stencil;
mod strides;
mod sweep;
mod walk;
mod witness;

use crate::passes::atlas::{Atlas, ChartMap};
use crate::passes::blur::Fields;
use crate::passes::diffusion::{self, Diffused, DiffusionOperator, median_texel_mm};
use crate::progress::Progress;
use chebyshev::coefficients;
use coarse::{ADDED_TEXEL2, Halving};
use cutis_scene::Object;
use exchange::{Exchange, Layout};
use glam::Vec4;
use metric::usual_conductivity;
pub use row::Light;
use row::flown;
use shore::{Read, Shore};
use std::sync::Arc;

/// A Gaussian may live in a smaller map when its standard deviation is still this many texels there.
const COARSE_DEVIATION_TEXELS: f32 = 4.0;
/// If less than this part of the texels lies inside of charts, and not at their edges, where coarse light is less true, …
const LEAST_INSIDE: f32 = 0.92;
/// … a Gaussian may do so only when it is this many texels wide there.
const CUT_DEVIATION_TEXELS: f32 = 12.0;
/// Smallest map: below this, charts dissolve and nothing is left to save.
const MIN_SIZE: usize = 128;
/// Mean variance that the bilinear read of a coarse map adds, texel².
const BILINEAR_TEXEL2: f32 = 1.0 / 6.0;
/// Squares of the object's extent up to which variances count.
const MOST_EXTENTS2: f32 = 10.0;

/// Heat flow on the atlas of one object, for the variances of one kernel.
#[derive(Debug, Clone)]
pub struct HeatFlow {
    /// Maps by their size, each half of the one before.
    pub levels: Vec<Level>,
}

/// A size of the maps.
#[derive(Debug, Clone)]
pub struct Level {
    /// The surface unrolled.
    pub atlas: Atlas,
    /// What its edges need, whatever the pose.
    pub layout: Layout,
    /// Who gives how much heat to whom, in the pose.
    pub exchange: Exchange,
    /// From the map of twice the size.
    pub halving: Option<Halving>,
    /// Coefficients of every time that is flown here.
    pub times: Vec<Vec<f32>>,
    /// Those times, mm².
    times_mm2: Vec<f32>,
    /// The fastest rate that they are laid for, 1/mm².
    laid_rate_per_mm2: f32,
    /// The usual width of a texel, mm, …
    texel_mm: f32,
    /// … and how well heat usually flows.
    usual_conductivity: f32,
}

impl HeatFlow {
    /// Of an object in its pose, for growing variances, mm². Where the mean free path of its material is scaled, variances are by
    /// the square of that.
    pub fn new(object: &Object, atlas: &Atlas, stretch_mm: &[glam::Vec2], variances_mm2: &[f32]) -> Self {
        let mut texel_mm = median_texel_mm(&atlas.charts, stretch_mm);
        let narrowest = object.material.least_mean_free_path_scale();
        let usual = usual_conductivity(object, atlas);
        // Beyond that light is even, but for less than 16 bits tell.
        let widest_mm2 = MOST_EXTENTS2 * extent_mm2(object) / usual;
        let mut levels: Vec<Level> = Vec::new();
        let mut left = variances_mm2;
        let (mut atlas, mut added_texel2) = (atlas.clone(), 0.0);
        loop {
            let mut level = Level::new(object, atlas, levels.last(), (texel_mm, usual));
            let size = level.atlas.size;
            let halves = size.is_multiple_of(2) && size / 2 >= MIN_SIZE;
            let is_cut = level.part_inside() < LEAST_INSIDE;
            let least_texels = if is_cut { CUT_DEVIATION_TEXELS } else { COARSE_DEVIATION_TEXELS };
            let wide = |v: &f32| halves && v.sqrt() * narrowest >= least_texels * 2.0 * texel_mm;
            let here = left.iter().position(wide).unwrap_or(left.len());
            // What halving and reading add is as wide everywhere, whatever flows.
            let added_mm2 = added_texel2 * texel_mm * texel_mm / usual;
            let time_mm2 = |v: &f32| 0.5 * (v.min(widest_mm2) - added_mm2).max(0.0);
            level.times_mm2 = left[..here].iter().map(time_mm2).collect();
            level.lay(level.exchange.fastest_rate_per_mm2);
            let charts = halves.then(|| Arc::new(level.atlas.charts.halved()));
            levels.push(level);
            left = &left[here..];
            let Some(charts) = charts.filter(|_| !left.is_empty()) else { return Self { levels } };
            let halved = if levels.len() == 1 { 0.0 } else { added_texel2 - BILINEAR_TEXEL2 };
            added_texel2 = 0.25 * halved + ADDED_TEXEL2 + BILINEAR_TEXEL2;
            texel_mm *= 2.0;
            atlas = Atlas { charts, ..Atlas::new(object, size / 2) };
        }
    }

    /// The same with stages that serve every pose: links may become as fast as they ever do.
    #[must_use]
    pub fn for_all_poses(mut self) -> Self {
        for level in &mut self.levels {
            level.lay(level.exchange.fastest_rate_per_mm2.max(level.exchange.limit_per_mm2));
        }
        self
    }

    /// Lets heat flow over the object in another pose; what depends on the layout alone stays, and so do the stages. Where links
    /// are faster than those can follow, all flow more slowly: by next to nothing, if they were made for all poses. Texels that the
    /// pose makes narrower than slivers were are held to be slivers.
    pub fn set_pose(&mut self, object: &Object) {
        for n in 0..self.levels.len() {
            let (finer, rest) = self.levels.split_at_mut(n);
            rest[0].set_pose(object, finer.last());
        }
    }

    /// Area that each texel of the light's own map stands for, mm²: what light is worth in energy.
    pub fn areas_mm2(&self) -> &[f32] {
        &self.levels[0].exchange.areas_mm2
    }

    /// Light on its own map to light after every variance, on the maps of their levels.
    pub fn flow<L: Light>(&self, light: &[L]) -> Vec<Vec<L>> {
        let mut halved: Option<Vec<L>> = None;
        let mut all = Vec::new();
        for level in &self.levels {
            if let Some(halving) = &level.halving {
                halved = Some(halving.halved(halved.as_deref().unwrap_or(light)));
            }
            let flown = flown(&level.exchange, &level.times, halved.as_deref().unwrap_or(light));
            all.extend(flown.into_iter().map(|map| level.padded(map)));
        }
        all
    }

    /// The transpose of [`Self::flow`]: from what something changes by the light of every map to what it changes by the light
    /// before.
    pub fn transposed<L: Light>(&self, maps: &[Vec<L>]) -> Vec<L> {
        let mut maps = maps.iter().rev();
        let mut sum: Option<Vec<L>> = None;
        for level in self.levels.iter().rev() {
            let size = level.exchange.size;
            let mut own = sum.take().unwrap_or_else(|| vec![L::default(); size * size]);
            for (time, map) in level.times.iter().rev().zip(maps.by_ref()) {
                let back = level.flown_back(time, map);
                own.iter_mut().zip(back).for_each(|(own, back)| *own = *own + back);
            }
            sum = Some(match &level.halving {
                Some(halving) => halving.transposed(&own),
                None => own,
            });
        }
        sum.unwrap_or_default()
    }
}

impl Level {
    fn new(
        object: &Object,
        atlas: Atlas,
        finer: Option<&Level>,
        (texel_mm, usual_conductivity): (f32, f32),
    ) -> Self {
        let shore = Shore::new(object, &atlas);
        let layout = Layout::new(object, &shore, texel_mm);
        let halving =
            finer.map(|finer| Halving::new(&finer.atlas, &finer.exchange.areas_mm2, &shore, &layout));
        let exchange = Exchange::new(object, &atlas, &layout, halving.as_ref(), texel_mm);
        Self {
            atlas,
            layout,
            exchange,
            halving,
            times: Vec::new(),
            times_mm2: Vec::new(),
            laid_rate_per_mm2: 0.0,
            texel_mm,
            usual_conductivity,
        }
    }

    /// Part of the texels with light that are not at edges of charts.
    fn part_inside(&self) -> f32 {
        let lit = self.exchange.areas_mm2.iter().filter(|area| **area > 0.0).count();
        let inside = self.layout.whole.iter().filter(|whole| **whole).count();
        inside as f32 / lit.max(1) as f32
    }

    /// Lays stages for waves that fall at that rate at most.
    fn lay(&mut self, rate_per_mm2: f32) {
        let texel_mm = f64::from(self.texel_mm / self.usual_conductivity.sqrt());
        let of = |&time: &f32| coefficients(f64::from(time), f64::from(rate_per_mm2), texel_mm);
        self.times = self.times_mm2.iter().map(of).collect();
        self.laid_rate_per_mm2 = rate_per_mm2;
        self.exchange.fastest_rate_per_mm2 = rate_per_mm2;
    }

    fn set_pose(&mut self, object: &Object, finer: Option<&Level>) {
        if let (Some(halving), Some(finer)) = (&mut self.halving, finer) {
            halving.set_areas(&finer.exchange.areas_mm2);
        }
        self.exchange =
            Exchange::new(object, &self.atlas, &self.layout, self.halving.as_ref(), self.texel_mm);
        let fastest = &mut self.exchange.fastest_rate_per_mm2;
        *fastest = fastest.max(self.laid_rate_per_mm2);
    }

    /// What is beyond the edges of charts is what is across the seam, for those who read there.
    fn padded<L: Light>(&self, mut map: Vec<L>) -> Vec<L> {
        let read =
            |read: &Read| read.iter().fold(L::default(), |sum, &(t, w)| sum + map[t as usize].times(w));
        let filled: Vec<L> = self.layout.padding.iter().map(|(_, from)| read(from)).collect();
        self.layout.padding.iter().zip(filled).for_each(|((texel, _), light)| map[*texel as usize] = light);
        map
    }

    /// The transpose of flowing for a time, with the padding: links are the same both ways, but light counts by area.
    fn flown_back<L: Light>(&self, time: &[f32], map: &[L]) -> Vec<L> {
        let mut map = map.to_vec();
        let taken: Vec<L> =
            self.layout.padding.iter().map(|(texel, _)| std::mem::take(&mut map[*texel as usize])).collect();
        for ((_, read), light) in self.layout.padding.iter().zip(taken) {
            read.iter().for_each(|&(t, w)| map[t as usize] = map[t as usize] + light.times(w));
        }
        let per_area = &self.exchange.inverse_areas_per_mm2;
        let counts = |&per_area: &f32| if per_area > 0.0 { per_area } else { 1.0 };
        map.iter_mut().zip(per_area).for_each(|(light, p)| *light = light.times(counts(p)));
        let mut back = flown(&self.exchange, &[time.to_vec()], &map).swap_remove(0);
        back.iter_mut().zip(per_area).for_each(|(light, p)| *light = light.over(counts(p)));
        back
    }
}

impl DiffusionOperator for HeatFlow {
    fn diffuse(
        &self,
        charts: Arc<ChartMap>,
        fields: Fields,
        variances_mm2: &[f32],
        progress: &dyn Progress,
    ) -> Diffused {
        let times = self.levels.iter().map(|level| level.times.len()).sum::<usize>();
        assert_eq!(times, variances_mm2.len(), "the variances are those that the flow was made for");
        progress.begin("heat flow", fields.layers.len() as u64);
        let level = |charts: &Arc<ChartMap>, layers| diffusion::Level { charts: Arc::clone(charts), layers };
        let mut levels = vec![level(&charts, Arc::clone(&fields.layers))];
        // By layer, then by time; levels are the other way round.
        let flow = |layer: &Vec<Vec4>| {
            let maps = self.flow(layer);
            progress.advance(1);
            maps.into_iter()
        };
        let mut by_layer: Vec<_> = fields.layers.iter().map(flow).collect();
        for own in &self.levels {
            for _ in &own.times {
                let layers: Vec<Vec<Vec4>> = by_layer.iter_mut().filter_map(Iterator::next).collect();
                levels.push(level(&own.atlas.charts, Arc::new(layers)));
            }
        }
        Diffused { levels }
    }
}

/// Squared diagonal of the box around an object, mm².
fn extent_mm2(object: &Object) -> f32 {
    object.mesh.bounds_mm().map_or(0.0, |[lo, hi]| (hi - lo).length_squared())
}
