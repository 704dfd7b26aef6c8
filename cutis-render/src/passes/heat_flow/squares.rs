//! Squares between four texel centres that lie on one chart as a whole: what each links, and how strongly.

use super::cells::Moments;
use super::metric::Metric;
use super::shore::corners;
use glam::Mat4;
use rayon::prelude::*;

/// The metric of every square, by its first texel; nothing where a square is no whole one.
pub struct Squares {
    size: usize,
    all: Vec<Metric>,
}

impl Squares {
    /// Those that are `whole`, by the metrics of their texels.
    pub fn new(size: usize, whole: &[bool], of_texels: &[Metric]) -> Self {
        let of = |i: usize| {
            if whole[i] { mean(corners(i, size).map(|texel| of_texels[texel])) } else { Metric::default() }
        };
        Self { size, all: (0..size * size).into_par_iter().map(of).collect() }
    }

    /// What every texel has of the areas of its squares, mm²: a quarter of each.
    pub fn areas_mm2(&self) -> Vec<f32> {
        self.by_texel(|square| 0.25 * square.area_mm2)
    }

    /// What its squares make of a wave at a texel at most, by the energy that the texel holds: see [`Metric::strength`].
    pub fn strengths(&self) -> Vec<f32> {
        self.by_texel(Metric::strength)
    }

    /// Weakens squares until no texel, by its area, gives more than the fastest wave may.
    pub fn slow_down(&mut self, areas_mm2: &[f32], fastest_rate_per_mm2: f32) {
        let strengths = self.strengths();
        let part = |texel: usize| {
            let most = fastest_rate_per_mm2 * areas_mm2[texel];
            if strengths[texel] > most { most / strengths[texel] } else { 1.0 }
        };
        let size = self.size;
        self.all.par_iter_mut().enumerate().filter(|(_, square)| square.area_mm2 > 0.0).for_each(
            |(i, square)| {
                let weakest = corners(i, size).map(part).into_iter().fold(1.0, f32::min);
                *square = square.conducting(weakest);
            },
        );
    }

    /// Slopes of one, as those of [`super::cells::Cell::integrals`].
    pub fn slopes(&self, first: usize) -> Mat4 {
        Moments::WHOLE.slopes(&self.all[first])
    }

    /// Links of each texel to the next along u, the next along v, and the next along v to the right and to the left.
    pub fn links(&self) -> Vec<[f32; 4]> {
        let along = |a: f32, b: f32| a / 3.0 - b / 6.0;
        let of = |i: usize| {
            let [here, below, left] = [0, self.size, 1].map(|back| self.before(i, back).a);
            [
                along(here.x, here.z) + along(below.x, below.z),
                along(here.z, here.x) + along(left.z, left.x),
                (here.x + here.z) / 6.0 + 0.5 * here.y,
                (left.x + left.z) / 6.0 - 0.5 * left.y,
            ]
        };
        (0..self.all.len()).into_par_iter().map(of).collect()
    }

    /// The sum of something over the four squares around every texel.
    fn by_texel(&self, of: impl Fn(&Metric) -> f32 + Sync) -> Vec<f32> {
        let around = [0, 1, self.size, self.size + 1];
        let sum = |i: usize| around.map(|back| of(&self.before(i, back))).iter().sum();
        (0..self.all.len()).into_par_iter().map(sum).collect()
    }

    fn before(&self, i: usize, back: usize) -> Metric {
        i.checked_sub(back).map_or(Metric::default(), |i| self.all[i])
    }
}

fn mean(all: [Metric; 4]) -> Metric {
    let sum = all
        .iter()
        .fold(Metric::default(), |sum, m| Metric { a: sum.a + m.a, area_mm2: sum.area_mm2 + m.area_mm2 });
    Metric { a: sum.a * 0.25, area_mm2: sum.area_mm2 * 0.25 }
}
