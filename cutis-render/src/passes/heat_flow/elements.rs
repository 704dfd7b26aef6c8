//! What cut cells and gaps link, put together into one matrix.

use super::cells::Cell;
use super::exchange::Layout;
use super::gaps::{Gap, Jump};
use super::metric::Metric;
use super::squares::Squares;
use super::witness::Witness;
use cutis_scene::Object;
use glam::{Mat4, Vec4};
use rayon::prelude::*;
use std::collections::HashMap;

/// What a cell or a gap links, of every pair of texels once.
pub struct Element {
    /// Both texels, the lower one first, and the strength.
    pub links: Vec<(u32, u32, f32)>,
}

/// What cells are in a pose.
pub struct CutCells {
    slopes: Vec<Mat4>,
}

impl CutCells {
    /// By the metrics of triangles; their areas are added to those of texels.
    pub fn new(cells: &[Cell], metrics: &[Metric], areas_mm2: &mut [f32]) -> Self {
        let (areas, slopes): (Vec<Vec4>, Vec<Mat4>) =
            cells.par_iter().map(|cell| cell.integrals(metrics)).unzip();
        for (cell, areas) in cells.iter().zip(&areas) {
            for (k, read) in cell.corners.iter().enumerate() {
                read.iter().for_each(|&(i, weight)| areas_mm2[i as usize] += weight * areas[k]);
            }
        }
        Self { slopes }
    }
}

/// Of cut cells and gaps.
pub fn elements(
    object: &Object,
    layout: &Layout,
    metrics: &[Metric],
    squares: &Squares,
    CutCells { slopes }: &CutCells,
) -> Vec<Element> {
    let cells = layout.cells.par_iter().zip(slopes);
    let mut all: Vec<Element> =
        cells.map(|(cell, slopes)| of_cell(cell, &slopes.to_cols_array_2d())).collect();
    let slopes_of = |witness: Witness| match witness {
        Witness::Cell(cell) => slopes[cell as usize],
        Witness::Square(first) => squares.slopes(first as usize),
    };
    let jump = |gap: &Gap| gap.jump(object, layout.size, metrics, &layout.cells, slopes_of);
    let jumps: Vec<Jump> = layout.gaps.par_iter().map(jump).collect();
    let mut loads: HashMap<Witness, f32> = HashMap::new();
    for jump in &jumps {
        jump.witnesses.iter().for_each(|&witness| *loads.entry(witness).or_insert(0.0) += jump.load);
    }
    all.par_extend(jumps.par_iter().map(|jump| {
        let load = jump.witnesses.iter().map(|witness| loads[witness]).fold(1.0, f32::max);
        of_jump(jump, load.sqrt().recip())
    }));
    all
}

fn of_cell(cell: &Cell, slopes: &[[f32; 4]; 4]) -> Element {
    let mut element = Element { links: Vec::new() };
    for (k, read) in cell.corners.iter().enumerate() {
        for (l, others) in cell.corners.iter().enumerate() {
            for &(i, own) in read {
                let further = others.iter().filter(|(j, _)| *j > i);
                further.for_each(|&(j, other)| element.add(i, j, -own * other * slopes[k][l]));
            }
        }
    }
    element
}

/// Of a gap, with as much of the flow as its witnesses can bear.
fn of_jump(jump: &Jump, part: f32) -> Element {
    let mut element = Element { links: Vec::new() };
    for (n, &(i, gap, flow)) in jump.terms.iter().enumerate() {
        for &(j, other_gap, other_flow) in &jump.terms[..n] {
            let strength =
                part * (gap * other_flow + flow * other_gap) - jump.spring_per_mm * gap * other_gap;
            // No texel comes twice in a jump.
            element.links.push((i.min(j), i.max(j), jump.length_mm * strength));
        }
    }
    element
}

impl Element {
    /// Adds to the link between two texels; none to itself.
    pub fn add(&mut self, one: u32, other: u32, strength: f32) {
        let (i, j) = (one.min(other), one.max(other));
        if i == j {
            return;
        }
        match self.links.iter_mut().find(|(a, b, _)| (*a, *b) == (i, j)) {
            Some((_, _, sum)) => *sum += strength,
            None => self.links.push((i, j, strength)),
        }
    }
}
