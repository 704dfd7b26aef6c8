//! Who gives how much heat to whom: links between texels, the same in both directions, so that no energy is lost or made.
//!
//! Light is bilinear between texels; with S the energy of its slopes and M the area of each texel, it changes by -M⁻¹ S. Links are
//! what S couples: inside of charts those of a texel to its eight neighbours, at their edges those of a sparse matrix.

use super::cells::{Cell, Cells};
use super::coarse::Halving;
use super::elements::{CutCells, elements};
use super::gaps::{Gap, gaps};
use super::metric::{SMALLEST, best_conductivity, metrics, metrics_of_texels};
use super::padding::padding;
use super::pattern::Pattern;
use super::rows::Rows;
use super::shore::{Read, Shore};
use super::squares::Squares;
use super::strides::{Stride, narrow, strides};
use crate::passes::atlas::Atlas;
use cutis_scene::Object;
use rayon::prelude::*;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::OnceLock;

/// No wave may fall faster than this by the area of a usual texel: thin strips at the edges of charts would set the pace for all
/// others. It is what squares of the narrowest texels reach.
const FASTEST: f32 = 4.0 / (SMALLEST * SMALLEST);

/// Times that edges are weakened for that: on maps torn to pieces they miss it by a hundredth after so many, …
const ROUNDS: usize = 6;
/// … and by so much they always may.
const TOLERANCE: f32 = 1.0 + 1e-4;

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
    /// Triangles whose texels are narrow in the pose that the layout was made in, …
    narrow: Vec<bool>,
    /// … and the longer steps across them.
    pub strides: Vec<Stride>,
    /// Texels of the padding, and what they hold.
    pub padding: Vec<(u32, Read)>,
    /// The best that heat flows anywhere, by how it does in the medium itself.
    pub best_conductivity: f32,
    /// Which texels cells and gaps link.
    pattern: OnceLock<Pattern>,
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
    /// No wave of light falls faster, 1/mm².
    pub fastest_rate_per_mm2: f32,
    /// Nor does any in another pose fall faster than this, but for a hundredth, 1/mm².
    pub limit_per_mm2: f32,
}

impl Layout {
    /// Of an object and its atlas, whose texels are usually `texel_mm` wide.
    pub fn new(object: &Object, shore: &Shore, texel_mm: f32) -> Self {
        let size = shore.size();
        let whole: Vec<bool> = (0..size * size)
            .into_par_iter()
            .map(|i| i % size + 1 < size && i / size + 1 < size && shore.is_whole(i))
            .collect();
        let (cells, padding) = rayon::join(|| Cells::new(object, shore), || padding(object, shore));
        let gaps = gaps(shore, &cells, &whole);
        let narrow = narrow(object, size, texel_mm);
        let strides = strides(object, shore, &narrow, texel_mm);
        let cells = cells.all;
        let best_conductivity =
            cells.iter().map(Cell::conductivity).fold(best_conductivity(object, shore.atlas), f32::max);
        Self {
            size,
            whole,
            cells,
            gaps,
            narrow,
            strides,
            padding,
            best_conductivity,
            pattern: OnceLock::new(),
        }
    }
}

impl Exchange {
    /// For the pose of an object. Areas are those of what is halved; of the surface, where nothing is.
    pub fn new(
        object: &Object,
        atlas: &Atlas,
        layout: &Layout,
        halving: Option<&Halving>,
        texel_mm: f32,
    ) -> Self {
        let size = layout.size;
        let metrics = metrics(object, size, &layout.narrow, texel_mm);
        let mut squares = Squares::new(size, &layout.whole, &metrics_of_texels(object, atlas, &metrics));
        let mut own_mm2 = squares.areas_mm2();
        let cells = CutCells::new(&layout.cells, &metrics, &mut own_mm2);
        let areas_mm2 = halving.map_or(own_mm2, |halving| halving.areas_mm2.clone());
        // What is less is rounding, and its inverse beyond bounds.
        let least_mm2 = LEAST_AREA * texel_mm * texel_mm;
        let areas_mm2: Vec<f32> =
            areas_mm2.into_iter().map(|area| if area > least_mm2 { area } else { 0.0 }).collect();
        let inverse_areas_per_mm2: Vec<f32> =
            areas_mm2.iter().map(|&area| if area > 0.0 { area.recip() } else { 0.0 }).collect();
        let runs = areas_mm2.par_chunks(size).map(runs_of).collect();
        let limit_per_mm2 = FASTEST * layout.best_conductivity / (texel_mm * texel_mm);
        // By the surface's own areas no square is too fast.
        if halving.is_some() {
            squares.slow_down(&areas_mm2, limit_per_mm2);
        }
        let mut elements = elements(object, layout, &metrics, &squares, &cells);
        let across = |stride: &Stride| stride.element(object, size, texel_mm, &areas_mm2);
        elements.par_extend(layout.strides.par_iter().map(across));
        let strengths = squares.strengths();
        let pattern = layout.pattern.get_or_init(|| Pattern::new(&elements, size * size));
        let mut rows = pattern.filled(&elements, |_| 1.0, |strength| strength);
        let mut paces: HashMap<u32, f32> = HashMap::new();
        for round in 0..ROUNDS {
            let mut slower = pace(&rows, &areas_mm2, &strengths, limit_per_mm2);
            if slower.is_empty() {
                break;
            }
            let weakened = |texel: u32| paces.get(&texel).copied().unwrap_or(1.0);
            // Elements that cancel each other do so less once one of them is weakened: from then on nothing cancels.
            if round > 0 {
                let all = pattern.filled(&elements, weakened, f32::abs);
                let all = pace(&all, &areas_mm2, &strengths, limit_per_mm2);
                slower.iter_mut().for_each(|(texel, part)| *part = all.get(texel).copied().unwrap_or(*part));
            }
            slower.iter().for_each(|(&texel, part)| *paces.entry(texel).or_insert(1.0) *= part);
            let weakened = |texel: u32| paces.get(&texel).copied().unwrap_or(1.0);
            rows = pattern.filled(&elements, weakened, |strength| strength);
        }
        let fastest_rate_per_mm2 = bound_of_rates(&rows, &inverse_areas_per_mm2, strengths);
        Self {
            size,
            links: squares.links(),
            rows,
            areas_mm2,
            inverse_areas_per_mm2,
            runs,
            fastest_rate_per_mm2,
            limit_per_mm2,
        }
    }
}

/// What texels may keep of their links at the edges, so that their waves fall no faster than they may: a part of 1, where it is
/// less.
fn pace(rows: &Rows, areas_mm2: &[f32], strengths: &[f32], fastest_rate_per_mm2: f32) -> HashMap<u32, f32> {
    let part = |(texel, links): (usize, &[(u32, f32)])| {
        let outer = outer_strength(links);
        let most = (fastest_rate_per_mm2 * areas_mm2[texel] - strengths[texel]).max(0.0);
        (outer > TOLERANCE * most).then(|| (texel as u32, most / outer))
    };
    rows.iter().filter_map(part).collect()
}

/// What links to further texels make of a wave at most: twice their sum (Gershgorin 1931).
fn outer_strength(links: &[(u32, f32)]) -> f32 {
    2.0 * links.iter().map(|(_, link)| link.abs()).sum::<f32>()
}

/// No wave falls faster than all that is linked to a texel lets it fall there: with S the sum of the matrices of squares and of
/// those of edges, uᵀSu is at most the sum of what each makes of u at its own texels.
fn bound_of_rates(rows: &Rows, inverse_areas_per_mm2: &[f32], mut strengths: Vec<f32>) -> f32 {
    rows.iter().for_each(|(texel, links)| strengths[texel] += outer_strength(links));
    let rates =
        strengths.par_iter().zip(inverse_areas_per_mm2).map(|(strength, per_area)| strength * per_area);
    rates.reduce(|| f32::MIN_POSITIVE, f32::max)
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
