//! Monte Carlo of light in layered slabs: a pencil beam falls on the top, and what comes out is counted.
//!
//! It solves the radiative transfer equation without diffusion theory's approximations, so it is what every other source
//! of profiles is held to. Packets carry a weight that absorption lowers at every collision; at an interface a packet is
//! reflected or refracted whole, by chance; light packets play Russian roulette (Wang, Jacques & Zheng 1995,
//! doi:10.1016/0169-2607(95)01640-F, not opened; the method is that of their program MCML).
//! Not modelled: polarisation, fluorescence, interference, anything that is not flat.
//!
//! Packets run in batches of [`BATCH`], eight at a time in the lanes of the processor's registers. Every packet has random
//! numbers of its own, so that batches may run on any thread in any order. Added up in their order they give the same bits. Standard errors come from how batches differ.

mod estimate;
mod fresnel;
mod henyey_greenstein;
mod lanes;
mod layers;
mod packets;
mod path_counter;
mod path_lengths;
mod paths;
mod random;
mod rings;
mod tally;
mod walk;

pub use estimate::{Estimate, Estimates};
pub use fresnel::fresnel_reflectance;
pub use henyey_greenstein::scattered_one_minus_cos;
pub use layers::{Layer, LayerError, LayeredSlab};
pub use path_counter::PathCounter;
pub use path_lengths::{Absorbed, PathLengths};
pub use paths::{MOST_LAYERS, PathBatch, PathError, PathSimulation};
pub use rings::{RingError, Rings};
pub use tally::{Grid, Tally};

use tally::Counter;
use walk::Walk;

/// Packets of a batch.
pub const BATCH: u64 = 1024;

/// What is simulated.
#[derive(Debug, Clone)]
pub struct Simulation {
    /// The slab.
    pub slab: LayeredSlab,
    /// How finely exits are counted.
    pub grid: Grid,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl Simulation {
    /// Runs packets `first` to `first + count - 1`.
    pub fn batch(&self, first: u64, count: u64) -> Tally {
        let counter = Counter::new(&self.grid, self.slab.layers().len());
        let specular = self.slab.specular_reflectance();
        let counter = Walk::new(&self.slab, 1.0 - specular, self.seed, first..first + count, counter).run();
        counter.tally(count, specular)
    }

    /// Runs `packets` packets, one batch after the other. Programs with threads call [`Simulation::batch`] themselves and
    /// add the tallies in order.
    pub fn run(&self, packets: u64) -> Estimates {
        let mut estimates = Estimates::new(&self.grid, self.slab.layers().len());
        let mut first = 0;
        while first < packets {
            let count = BATCH.min(packets - first);
            estimates.add(&self.batch(first, count));
            first += count;
        }
        estimates
    }
}

#[cfg(test)]
mod path_tests;
#[cfg(test)]
mod slow_tests;
#[cfg(test)]
mod tests;
