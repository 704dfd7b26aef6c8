//! What is counted of a batch of packets.

use super::lanes::{LANES, Lanes, bins, indices, splat};
use super::packets::Packets;
use super::rings::Rings;
use super::walk::{Exits, Record};

/// Weight below which a packet plays for its life.
const LIGHT: f64 = 1e-4;

/// How finely exits and absorption are counted. What lies beyond the last bin is counted in one bin more.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Rings around the beam.
    pub rings: Rings,
    /// Height of a sheet, mm.
    pub depth_step_mm: f64,
    /// Sheets.
    pub depth_bins: usize,
    /// Bins of the cosine of the angle to the normal at which light leaves, evenly from 0 to 1.
    pub cosine_bins: usize,
}

/// Weights by where they ended, for a batch; the beam has 1 for every packet.
#[derive(Debug, Clone, PartialEq)]
pub struct Tally {
    pub(super) grid: Grid,
    pub(super) packets: u64,
    /// All counters one after another; [`Slots`] says where.
    pub(super) values: Vec<f64>,
}

/// Where each counter begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Slots {
    pub(super) layers: usize,
    pub(super) reflectance_by_radius: usize,
    pub(super) transmittance_by_radius: usize,
    pub(super) reflectance_by_cosine: usize,
    pub(super) transmittance_by_cosine: usize,
    pub(super) absorption_by_depth: usize,
    pub(super) count: usize,
}

pub(super) const SPECULAR: usize = 0;
pub(super) const REFLECTANCE: usize = 1;
pub(super) const TRANSMITTANCE: usize = 2;
pub(super) const ROULETTE: usize = 3;
pub(super) const ABSORBED: usize = 4;
const FIXED: usize = 5;

impl Slots {
    pub(super) fn new(grid: &Grid, layers: usize) -> Self {
        let rings = grid.rings.count() + 1;
        let reflectance_by_radius = FIXED + layers;
        let transmittance_by_radius = reflectance_by_radius + rings;
        let reflectance_by_cosine = transmittance_by_radius + rings;
        let transmittance_by_cosine = reflectance_by_cosine + grid.cosine_bins;
        let absorption_by_depth = transmittance_by_cosine + grid.cosine_bins;
        let count = absorption_by_depth + grid.depth_bins + 1;
        Self {
            layers: FIXED,
            reflectance_by_radius,
            transmittance_by_radius,
            reflectance_by_cosine,
            transmittance_by_cosine,
            absorption_by_depth,
            count,
        }
    }
}

/// The counters that the walk writes to. Every number that is the sum of others is summed at the end.
pub(super) struct Counter {
    grid: Grid,
    layers: usize,
    roulette: f64,
    /// Reflectance, then transmittance, by ring.
    exits_by_radius: Vec<f64>,
    /// The same by cosine, empty if nobody asks.
    exits_by_cosine: Vec<f64>,
    /// Sheet by sheet for the first layer, then for the next.
    absorbed: Vec<f64>,
}

impl Counter {
    pub(super) fn new(grid: &Grid, layers: usize) -> Self {
        Self {
            grid: grid.clone(),
            layers,
            roulette: 0.0,
            exits_by_radius: vec![0.0; 2 * (grid.rings.count() + 1)],
            exits_by_cosine: vec![0.0; 2 * grid.cosine_bins],
            absorbed: vec![0.0; layers * (grid.depth_bins + 1)],
        }
    }

    /// Everything that was counted of so many packets.
    pub(super) fn tally(self, packets: u64, specular_reflectance: f64) -> Tally {
        let slots = Slots::new(&self.grid, self.layers);
        let mut values = vec![0.0; slots.count];
        let (reflected, transmitted) = self.exits_by_radius.split_at(self.grid.rings.count() + 1);
        values[SPECULAR] = specular_reflectance * packets as f64;
        values[REFLECTANCE] = reflected.iter().sum();
        values[TRANSMITTANCE] = transmitted.iter().sum();
        values[ROULETTE] = self.roulette;
        values[ABSORBED] = self.absorbed.iter().sum();
        values[slots.reflectance_by_radius..slots.reflectance_by_cosine]
            .copy_from_slice(&self.exits_by_radius);
        values[slots.reflectance_by_cosine..slots.absorption_by_depth].copy_from_slice(&self.exits_by_cosine);
        for (layer, sheets) in self.absorbed.chunks(self.grid.depth_bins + 1).enumerate() {
            values[slots.layers + layer] = sheets.iter().sum();
            let by_depth = values[slots.absorption_by_depth..].iter_mut().zip(sheets);
            by_depth.for_each(|(sum, sheet)| *sum += sheet);
        }
        Tally { grid: self.grid, packets, values }
    }
}

impl Record for Counter {
    fn enter(&mut self, _: Lanes) {}

    fn fly(&mut self, _: &Packets, _: Lanes) {}

    #[inline(always)]
    fn absorb(&mut self, packets: &Packets, weight: Lanes) {
        let last = splat(self.grid.depth_bins as f64);
        let sheet = bins(packets.position_mm[2] * splat(self.grid.depth_step_mm.recip()), last);
        let slots = indices(packets.layer.mul_add(last + splat(1.0), sheet));
        for (slot, weight) in slots.into_iter().zip(weight.to_array()) {
            self.absorbed[slot] += weight;
        }
    }

    #[inline(always)]
    fn light(&self, packets: &Packets) -> Lanes {
        packets.weight.simd_lt(splat(LIGHT))
    }

    fn roulette(&mut self, _: usize, weight: f64, new_weight: f64) {
        self.roulette += weight - new_weight;
    }

    #[inline(always)]
    fn leave(&mut self, exits: &Exits) {
        let weight = exits.weight.to_array();
        let half = splat((self.grid.rings.count() + 1) as f64);
        let ring = self.grid.rings.at_all(exits.r2_mm2.sqrt());
        let side = indices(exits.downwards & half);
        for lane in 0..LANES {
            self.exits_by_radius[side[lane] + ring[lane]] += weight[lane];
        }
        if self.grid.cosine_bins > 0 {
            let cosines = splat(self.grid.cosine_bins as f64);
            let bin = bins(exits.cos * cosines, cosines - splat(1.0));
            let bin = indices(bin + (exits.downwards & cosines));
            bin.into_iter().zip(weight).for_each(|(bin, weight)| self.exits_by_cosine[bin] += weight);
        }
    }
}
