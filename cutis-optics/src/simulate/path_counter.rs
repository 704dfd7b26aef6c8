//! Exits sorted into cells: by side, by ring, and by the logarithm of the path in every layer.
//!
//! A cell keeps the moments of its packets: Σ W, Σ W², Σ W L_j and Σ W L_j L_k. Only cells that hold something exist.

use super::path_lengths::PathLengths;
use super::paths::{MOST_LAYERS, PathBatch, PathExit};
use super::rings::Rings;
use std::collections::HashMap;

/// Cells to each factor of e in path: [`PathLengths`] derives what this width costs.
const CELLS_PER_E: f64 = 8.0;
/// Paths below this share a cell. The strongest absorber of skin, 40/mm, takes 0.4 % along it.
const SHORTEST_MM: f64 = 1e-4;
/// The last cell of an axis, beyond e^31 times the shortest path.
const LAST_CELL: f64 = 255.0;

/// Exits of all batches so far.
#[derive(Debug, Clone)]
pub struct PathCounter {
    rings: Rings,
    layers: usize,
    specular_reflectance: f64,
    packets: u64,
    numbers: HashMap<CellKey, usize>,
    /// Moments of one cell after the other, in the order in which they were met.
    moments: Vec<f64>,
}

/// Place of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct CellKey {
    /// The ring of reflectance, or of transmittance behind these.
    pub(super) ring: u32,
    path: [u8; MOST_LAYERS],
}

/// Moments that a cell has for so many layers: Σ W, Σ W², Σ W L_j, then Σ W L_j L_k for k ≤ j.
pub(super) fn moments_of(layers: usize) -> usize {
    2 + layers + layers * (layers + 1) / 2
}

impl PathCounter {
    pub(super) fn new(rings: &Rings, layers: usize, specular_reflectance: f64) -> Self {
        let (numbers, moments) = (HashMap::new(), Vec::new());
        Self { rings: rings.clone(), layers, specular_reflectance, packets: 0, numbers, moments }
    }

    /// Adds a batch.
    pub fn add(&mut self, batch: &PathBatch) {
        self.packets += batch.packets;
        batch.exits.iter().for_each(|exit| self.count(exit));
    }

    /// What can be weighted.
    pub fn path_lengths(&self) -> PathLengths {
        let stride = moments_of(self.layers);
        let mut cells: Vec<(CellKey, &[f64])> = self
            .numbers
            .iter()
            .map(|(&key, &n)| (key, &self.moments[n * stride..(n + 1) * stride]))
            .collect();
        cells.sort_unstable_by_key(|&(key, _)| key);
        PathLengths::new(&self.rings, self.layers, self.specular_reflectance, self.packets, &cells)
    }

    fn count(&mut self, exit: &PathExit) {
        let stride = moments_of(self.layers);
        let next = self.numbers.len();
        let number = *self.numbers.entry(key(&self.rings, self.layers, exit)).or_insert(next);
        if number == next {
            self.moments.resize((next + 1) * stride, 0.0);
        }
        let moments = &mut self.moments[number * stride..(number + 1) * stride];
        let path_mm = &exit.path_mm[..self.layers];
        let first = [exit.weight, exit.weight * exit.weight].into_iter();
        let paths = path_mm.iter().map(|l| exit.weight * l);
        let products = path_mm.iter().enumerate().flat_map(|(j, l)| path_mm[..=j].iter().map(move |m| l * m));
        let values = first.chain(paths).chain(products.map(|product| exit.weight * product));
        moments.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
    }
}

fn key(rings: &Rings, layers: usize, exit: &PathExit) -> CellKey {
    let side = if exit.downwards { rings.count() + 1 } else { 0 };
    let mut path = [0; MOST_LAYERS];
    for (cell, &path_mm) in path.iter_mut().zip(&exit.path_mm[..layers]) {
        // Casts saturate, and the logarithm of 0 is below every cell.
        *cell = (CELLS_PER_E * (path_mm / SHORTEST_MM).ln() + 1.0).clamp(0.0, LAST_CELL) as u8;
    }
    CellKey { ring: (side + rings.at(exit.r_mm)) as u32, path }
}
