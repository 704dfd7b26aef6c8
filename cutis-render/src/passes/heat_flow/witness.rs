//! Who tells the slope of light at a place of a seam: the cell there, or a better one beside it.

use super::cells::{Cell, Cells};
use super::shore::{Read, Shore, centre, corners};
use glam::Vec2;

/// Part of its square that a cell needs to be a good witness of slopes.
const GOOD_PART: f32 = 0.5;

/// Whose slopes count.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Witness {
    /// A cell, by its number.
    Cell(u32),
    /// A whole square, by its first texel.
    Square(u32),
}

impl Witness {
    /// The first texel of its square.
    pub fn first(self, cells: &[Cell]) -> usize {
        match self {
            Self::Cell(cell) => cells[cell as usize].first,
            Self::Square(first) => first as usize,
        }
    }

    /// What the corners of its square read, on a map of `size` texels.
    pub fn corners(self, cells: &[Cell], size: usize) -> [Read; 4] {
        match self {
            Self::Cell(cell) => cells[cell as usize].corners.clone(),
            Self::Square(first) => corners(first as usize, size).map(|texel| vec![(texel as u32, 1.0)]),
        }
    }

    fn middle(self, cells: &[Cell], size: usize) -> Vec2 {
        match self {
            Self::Cell(cell) => cells[cell as usize].middle(size),
            Self::Square(first) => centre(first as usize, size) + 0.5,
        }
    }
}

/// All who may be asked.
pub struct Witnesses<'a> {
    /// The edges of charts.
    pub shore: &'a Shore<'a>,
    /// Cells there.
    pub cells: &'a Cells,
    /// Squares that lie on one chart as a whole.
    pub whole: &'a [bool],
}

impl Witnesses<'_> {
    /// For a place of a triangle in a cell: the cell itself, if it is a good witness, else the nearest good one around it, of the same
    /// chart and in sight.
    pub fn at(&self, number: u32, triangle: u32, place: Vec2) -> Witness {
        let itself = Witness::Cell(number);
        if is_good(&self.cells.all[number as usize]) {
            return itself;
        }
        let middle = |witness: &Witness| witness.middle(&self.cells.all, self.shore.size());
        let mut around = self.around(number);
        // Lengths are ordered as their bits are.
        around.sort_by_cached_key(|witness| middle(witness).distance(place).to_bits());
        let in_sight = |witness: &Witness| {
            let arrival = self.shore.ground.walk(triangle, place, middle(witness) - place);
            !arrival.over_seam && !arrival.at_border
        };
        around.into_iter().find(in_sight).unwrap_or(itself)
    }

    /// Good ones of its chart in the squares around a cell.
    fn around(&self, number: u32) -> Vec<Witness> {
        let (size, own) = (self.shore.size(), &self.cells.all[number as usize]);
        let squares = (0..9).filter_map(|i| (own.first + i % 3 + i / 3 * size).checked_sub(size + 1));
        let good = |cell: &Cell| cell.chart == own.chart && is_good(cell);
        let in_square = |first: usize| {
            let whole = self.whole[first] && self.shore.chart(first) == own.chart;
            let cells = self.cells.at(first).filter(move |(_, cell)| good(cell));
            whole
                .then_some(Witness::Square(first as u32))
                .into_iter()
                .chain(cells.map(|(number, _)| Witness::Cell(number)))
        };
        squares.filter(|&first| first < self.whole.len()).flat_map(in_square).collect()
    }
}

fn is_good(cell: &Cell) -> bool {
    cell.part_of_square >= GOOD_PART
}
