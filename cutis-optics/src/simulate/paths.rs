//! Packets that nothing absorbs, and how far each flew in every layer before it left.
//!
//! Scattering decides where packets go, absorption only how much is left of them. A packet that flew L_j in layer j would
//! have kept e^(-Σ sigma_a,j L_j): one simulation without absorption serves every absorption (Lambert's law applied
//! afterwards, path by path). Without absorption a walk in a half-space need not end. So a packet plays Russian roulette
//! when even the least absorption that will be asked for would leave 1e-4 of it; its weight rises by what its chance was,
//! so that the mean is right for every absorption, and errors are small for all that are not below the least.

use super::lanes::{Lanes, lanes_of, splat};
use super::layers::LayeredSlab;
use super::packets::Packets;
use super::path_counter::PathCounter;
use super::path_lengths::PathLengths;
use super::rings::Rings;
use super::walk::{Exits, Record, SURVIVAL, Walk};
use super::{BATCH, Layer, LayerError};

/// Layers whose paths are kept apart: cells have one axis for each.
pub const MOST_LAYERS: usize = 4;
/// What the least absorption has left of a packet when it must play: e^-9.21 = 1e-4, as where absorption is simulated.
const LIGHT_OPTICAL_DEPTH: f64 = 9.210_340_371_976_182;
/// Longer paths, of light gone for good, are cut to this: nothing is left of them, and their squares are still numbers.
const LONGEST_MM: f64 = 1e9;

/// What is simulated.
#[derive(Debug, Clone)]
pub struct PathSimulation {
    slab: LayeredSlab,
    rings: Rings,
    least_absorption_per_mm: Vec<f64>,
    seed: u64,
}

/// Why paths are not simulated or not weighted.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PathError {
    /// The layers themselves are impossible.
    #[error(transparent)]
    Layers(#[from] LayerError),
    /// Too many axes.
    #[error("paths are kept for at most {MOST_LAYERS} layers, got {0}")]
    TooManyLayers(usize),
    /// One absorption coefficient belongs to each layer.
    #[error("there are {layers} layers, but {got} absorption coefficients")]
    WrongCount {
        /// Layers there are.
        layers: usize,
        /// Coefficients there are.
        got: usize,
    },
    /// Without any absorption a packet may walk for ever.
    #[error("layer {layer}: the least absorption must be above 0 and at most 1e9 1/mm, got {value}")]
    Least {
        /// Number of the layer, the top one is 1.
        layer: usize,
        /// What was given.
        value: f64,
    },
    /// No material has it.
    #[error("layer {layer}: absorption must be from 0 to 1e9 1/mm, got {value}")]
    Absorption {
        /// Number of the layer, the top one is 1.
        layer: usize,
        /// What was given.
        value: f64,
    },
}

/// Where and how packets of a batch left.
#[derive(Debug, Clone, PartialEq)]
pub struct PathBatch {
    pub(super) packets: u64,
    pub(super) exits: Vec<PathExit>,
}

/// One packet that left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PathExit {
    pub(super) downwards: bool,
    pub(super) r_mm: f64,
    /// 1, or what roulette raised it to.
    pub(super) weight: f64,
    /// In each layer; 0 in layers there are not.
    pub(super) path_mm: [f64; MOST_LAYERS],
}

impl PathSimulation {
    /// Layers in air, whose own absorption is set aside, and for each the smallest absorption coefficient that will be
    /// asked for.
    ///
    /// # Errors
    /// If the layers are impossible or too many, or a least absorption is missing or not above 0.
    pub fn in_air(
        layers: &[Layer],
        least_absorption_per_mm: &[f64],
        rings: Rings,
        seed: u64,
    ) -> Result<Self, PathError> {
        if layers.len() > MOST_LAYERS {
            return Err(PathError::TooManyLayers(layers.len()));
        }
        if layers.len() != least_absorption_per_mm.len() {
            return Err(PathError::WrongCount { layers: layers.len(), got: least_absorption_per_mm.len() });
        }
        for (i, &value) in least_absorption_per_mm.iter().enumerate() {
            let fine = value > 0.0 && value <= 1e9;
            if !fine {
                return Err(PathError::Least { layer: i + 1, value });
            }
        }
        let clear = layers.iter().map(|&layer| Layer { sigma_a_per_mm: 0.0, ..layer }).collect();
        let slab = LayeredSlab::in_air(clear)?;
        Ok(Self { slab, rings, least_absorption_per_mm: least_absorption_per_mm.to_vec(), seed })
    }

    /// Runs packets `first` to `first + count - 1`.
    pub fn batch(&self, first: u64, count: u64) -> PathBatch {
        let recorder = Recorder::new(&self.least_absorption_per_mm);
        let exits = Walk::new(&self.slab, 1.0, self.seed, first..first + count, recorder).run().exits;
        PathBatch { packets: count, exits }
    }

    /// Nothing counted yet; batches are added in their order.
    pub fn counter(&self) -> PathCounter {
        PathCounter::new(&self.rings, self.slab.layers().len(), self.slab.specular_reflectance())
    }

    /// Runs `packets` packets, one batch after the other. Programs with threads call [`PathSimulation::batch`] themselves
    /// and add the batches in order.
    pub fn run(&self, packets: u64) -> PathLengths {
        let mut counter = self.counter();
        for first in (0..packets).step_by(BATCH as usize) {
            counter.add(&self.batch(first, BATCH.min(packets - first)));
        }
        counter.path_lengths()
    }
}

/// Paths of the packets under way, and the exits so far.
struct Recorder {
    least_absorption_per_mm: [f64; MOST_LAYERS],
    layers: usize,
    path_mm: [Lanes; MOST_LAYERS],
    /// Optical depth of the least absorption along the path, less the logarithm of the weight.
    optical_depth: Lanes,
    exits: Vec<PathExit>,
}

impl Recorder {
    fn new(least_absorption_per_mm: &[f64]) -> Self {
        let mut least = [0.0; MOST_LAYERS];
        least[..least_absorption_per_mm.len()].copy_from_slice(least_absorption_per_mm);
        Self {
            least_absorption_per_mm: least,
            layers: least_absorption_per_mm.len(),
            path_mm: [splat(0.0); MOST_LAYERS],
            optical_depth: splat(0.0),
            exits: Vec::new(),
        }
    }
}

impl Record for Recorder {
    #[inline(always)]
    fn enter(&mut self, lanes: Lanes) {
        self.path_mm = self.path_mm.map(|path| !lanes & path);
        self.optical_depth = !lanes & self.optical_depth;
    }

    #[inline(always)]
    fn fly(&mut self, packets: &Packets, distance_mm: Lanes) {
        for layer in 0..self.layers {
            let here_mm = packets.layer.simd_eq(splat(layer as f64)) & distance_mm;
            self.path_mm[layer] += here_mm;
            let least_per_mm = splat(self.least_absorption_per_mm[layer]);
            self.optical_depth = here_mm.mul_add(least_per_mm, self.optical_depth);
        }
    }

    fn absorb(&mut self, _: &Packets, _: Lanes) {}

    #[inline(always)]
    fn light(&self, _: &Packets) -> Lanes {
        self.optical_depth.simd_gt(splat(LIGHT_OPTICAL_DEPTH))
    }

    fn roulette(&mut self, lane: usize, _: f64, _: f64) {
        self.optical_depth.as_mut_array()[lane] += SURVIVAL.ln();
    }

    #[inline(always)]
    fn leave(&mut self, exits: &Exits) {
        let [r2_mm2, weight] = [exits.r2_mm2, exits.weight].map(Lanes::to_array);
        let path_mm = self.path_mm.map(|path| path.fast_min(splat(LONGEST_MM)).to_array());
        let downwards = exits.downwards.to_bitmask();
        for lane in lanes_of(exits.weight.simd_gt(splat(0.0)).to_bitmask()) {
            self.exits.push(PathExit {
                downwards: downwards >> lane & 1 == 1,
                r_mm: r2_mm2[lane].sqrt(),
                weight: weight[lane],
                path_mm: path_mm.map(|path| path[lane]),
            });
        }
    }
}
