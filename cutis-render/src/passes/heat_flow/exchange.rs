//! Who gives how much heat to whom: links between texels, the same in both directions, so that no energy is lost or made.
//!
//! Light is bilinear between texels; with S the energy of its slopes and M the area of each texel, it changes by -M⁻¹ S. Links are
//! what S couples: inside of charts those of a texel to its eight neighbours, at their edges those of a sparse matrix.

use super::cells::{Cell, Cells};
use super::elements::{elements, rows};
use super::gaps::{Gap, gaps};
use super::metric::Metric;
use super::padding::padding;
use super::rows::Rows;
use super::shore::{Read, Shore, corners};
use cutis_scene::Object;
use rayon::prelude::*;
use std::ops::Range;

/// What a texel at the edge of a chart may give, per time, by the area of a usual texel: thin strips would set the pace for all
/// others.
const FASTEST: f32 = 6.7;

/// Least area of a texel that holds light, by that of a usual one.
const LEAST_AREA: f32 = 1e-6;

/// What edges of charts need; it depends on the layout of the texture, and stays when the surface moves.
#[derive(Debug, Clone)]
pub struct Layout {
    /// Width and height of the atlas, texels.
    pub size: usize,
    /// Squares that lie on one chart as a whole.
    pub whole: Vec<bool>,
    /// Parts of squares at edges of charts.
    pub cells: Vec<Cell>,
    /// Places along seams.
    pub gaps: Vec<Gap>,
    /// Texels of the padding, and what they hold.
    pub padding: Vec<(u32, Read)>,
}

/// All links, for one pose.
#[derive(Debug, Clone)]
pub struct Exchange {
    /// Width and height of the atlas, texels.
    pub size: usize,
    /// Links of each texel to the next along u, the next along v, and the next along v to the right and to the left.
    pub links: Vec<[f32; 4]>,
    /// Further links.
    pub rows: Rows,
    /// Area that each texel stands for, mm²; 0 where there is no surface.
    pub areas_mm2: Vec<f32>,
    /// Its inverse, 1/mm²; 0 where there is no surface.
    pub inverse_areas_per_mm2: Vec<f32>,
    /// Where there is surface, row by row.
    pub runs: Vec<Vec<Range<usize>>>,
    /// Every wave of light falls more slowly, 1/mm².
    pub fastest_rate_per_mm2: f32,
}

impl Layout {
    /// Of an object and its atlas.
    pub fn new(object: &Object, shore: &Shore) -> Self {
        let size = shore.size();
        let whole = (0..size * size)
            .into_par_iter()
            .map(|i| i % size + 1 < size && i / size + 1 < size && shore.is_whole(i))
            .collect();
        let (cells, padding) = rayon::join(|| Cells::new(object, shore), || padding(object, shore));
        let gaps = gaps(shore, &cells);
        let cells = cells.all;
        Self { size, whole, cells, gaps, padding }
    }
}

impl Exchange {
    /// For the pose of an object: metrics of its triangles and of its texels. Areas follow from them, unless they are given.
    pub fn new(
        object: &Object,
        layout: &Layout,
        (metrics, of_texels): (&[Metric], &[Metric]),
        areas_mm2: Option<&[f32]>,
        texel_mm: f32,
    ) -> Self {
        let size = layout.size;
        let squares: Vec<Metric> = (0..size * size)
            .into_par_iter()
            .map(|i| {
                if layout.whole[i] { mean(corners(i, size).map(|t| of_texels[t])) } else { Metric::default() }
            })
            .collect();
        let at = |i: usize, back: usize| i.checked_sub(back).map_or(Metric::default(), |i| squares[i]);
        let links = (0..size * size)
            .into_par_iter()
            .map(|i| {
                let [here, below, left] = [squares[i], at(i, size), at(i, 1)];
                let along = |a: f32, b: f32| a / 3.0 - b / 6.0;
                let sum = (here.a.x + here.a.z) / 6.0;
                let sum_left = (left.a.x + left.a.z) / 6.0;
                [
                    along(here.a.x, here.a.z) + along(below.a.x, below.a.z),
                    along(here.a.z, here.a.x) + along(left.a.z, left.a.x),
                    sum + 0.5 * here.a.y,
                    sum_left - 0.5 * left.a.y,
                ]
            })
            .collect();
        let mut own_mm2: Vec<f32> = (0..size * size)
            .into_par_iter()
            .map(|i| [0, 1, size, size + 1].map(|back| at(i, back).area_mm2).iter().sum::<f32>() * 0.25)
            .collect();
        let elements = elements(object, layout, metrics, &mut own_mm2);
        let areas_mm2 = areas_mm2.map_or(own_mm2, <[f32]>::to_vec);
        // What is less is rounding, and its inverse beyond bounds.
        let least_mm2 = LEAST_AREA * texel_mm * texel_mm;
        let areas_mm2: Vec<f32> =
            areas_mm2.into_iter().map(|area| if area > least_mm2 { area } else { 0.0 }).collect();
        let inverse_areas_per_mm2 =
            areas_mm2.iter().map(|&area| if area > 0.0 { area.recip() } else { 0.0 }).collect();
        let runs = areas_mm2.par_chunks(size).map(runs_of).collect();
        let mut exchange = Self {
            size,
            links,
            rows: Rows::default(),
            areas_mm2,
            runs,
            inverse_areas_per_mm2,
            fastest_rate_per_mm2: 0.0,
        };
        let best = layout.cells.iter().map(Cell::conductivity).fold(0.0, f32::max);
        exchange.rows = rows(&elements, &vec![1.0; size * size]);
        exchange.rows = rows(&elements, &exchange.pace(FASTEST * best / (texel_mm * texel_mm)));
        exchange.fastest_rate_per_mm2 = exchange.bound_of_rates();
        exchange
    }

    /// What every texel may keep of its links at the edges, so that it gives at most that part of its light.
    fn pace(&self, fastest: f32) -> Vec<f32> {
        let mut part = vec![1.0f32; self.areas_mm2.len()];
        for (texel, links) in self.rows.iter() {
            let outer: f32 = links.iter().map(|(_, link)| link.abs()).sum();
            let most = (fastest * self.areas_mm2[texel] - self.inner_strength(texel)).max(0.0);
            part[texel] = if outer > most { most / outer } else { 1.0 };
        }
        part
    }

    /// Sum of a texel's links to its eight neighbours.
    fn inner_strength(&self, i: usize) -> f32 {
        let size = self.size;
        // Texels along the edges of the map have none.
        if i <= size || i + size + 1 >= self.links.len() {
            return 0.0;
        }
        let back = [
            self.links[i - 1][0],
            self.links[i - size][1],
            self.links[i - size - 1][2],
            self.links[i - size + 1][3],
        ];
        self.links[i].iter().chain(&back).map(|link| link.abs()).sum()
    }

    /// No wave is faster than twice what any texel gives (Gershgorin 1931).
    fn bound_of_rates(&self) -> f32 {
        let mut given: Vec<f32> =
            (0..self.links.len()).into_par_iter().map(|i| self.inner_strength(i)).collect();
        for (texel, links) in self.rows.iter() {
            given[texel] += links.iter().map(|(_, link)| link.abs()).sum::<f32>();
        }
        let rates = given
            .par_iter()
            .zip(&self.inverse_areas_per_mm2)
            .map(|(given, inverse_areas_per_mm2)| 2.0 * given * inverse_areas_per_mm2);
        rates.reduce(|| f32::MIN_POSITIVE, f32::max)
    }
}

/// Where areas of a row are not 0.
pub(super) fn runs_of(areas_mm2: &[f32]) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for x in (0..areas_mm2.len()).filter(|&x| areas_mm2[x] > 0.0) {
        match runs.last_mut() {
            Some(run) if run.end == x => run.end = x + 1,
            _ => runs.push(x..x + 1),
        }
    }
    runs
}

fn mean(all: [Metric; 4]) -> Metric {
    let sum = all
        .iter()
        .fold(Metric::default(), |sum, m| Metric { a: sum.a + m.a, area_mm2: sum.area_mm2 + m.area_mm2 });
    Metric { a: sum.a * 0.25, area_mm2: sum.area_mm2 * 0.25 }
}
