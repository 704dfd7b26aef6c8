//! Means and standard errors from many batches.

use super::tally::{ABSORBED, Grid, REFLECTANCE, ROULETTE, SPECULAR, Slots, TRANSMITTANCE, Tally};
use core::f64::consts::PI;

/// A number and how far it may be off by chance.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Estimate {
    /// The mean.
    pub value: f64,
    /// Standard deviation of the mean; infinite for a single batch, which tells nothing.
    pub standard_error: f64,
}

/// Everything that was counted, as fractions of the beam.
#[derive(Debug, Clone)]
pub struct Estimates {
    grid: Grid,
    slots: Slots,
    packets: u64,
    batches: u64,
    /// Σ s, Σ s², Σ s n over batches of n packets whose counter ended at s.
    sums: Vec<[f64; 3]>,
    /// Σ n².
    packets_squared: f64,
}

impl Estimates {
    /// Nothing counted yet.
    pub fn new(grid: &Grid, layers: usize) -> Self {
        let slots = Slots::new(grid, layers);
        let sums = vec![[0.0; 3]; slots.count];
        Self { grid: grid.clone(), slots, packets: 0, batches: 0, sums, packets_squared: 0.0 }
    }

    /// Adds a batch.
    ///
    /// # Panics
    /// If the batch was counted on another grid.
    pub fn add(&mut self, batch: &Tally) {
        assert_eq!(batch.grid, self.grid, "all batches are counted on one grid");
        let n = batch.packets as f64;
        for (sums, &s) in self.sums.iter_mut().zip(&batch.values) {
            *sums = [sums[0] + s, sums[1] + s * s, sums[2] + s * n];
        }
        self.packets += batch.packets;
        self.packets_squared += n * n;
        self.batches += 1;
    }

    /// Packets counted.
    pub fn packets(&self) -> u64 {
        self.packets
    }

    /// Fraction that the top surface mirrors at once.
    pub fn specular_reflectance(&self) -> f64 {
        self.at(SPECULAR, 1.0).value
    }

    /// Fraction that comes back out of the layers, without the specular part.
    pub fn diffuse_reflectance(&self) -> Estimate {
        self.at(REFLECTANCE, 1.0)
    }

    /// Fraction that leaves through the bottom, what was never scattered included.
    pub fn transmittance(&self) -> Estimate {
        self.at(TRANSMITTANCE, 1.0)
    }

    /// Fraction absorbed in each layer.
    pub fn absorbed_by_layer(&self) -> Vec<Estimate> {
        (self.slots.layers..self.slots.reflectance_by_radius).map(|i| self.at(i, 1.0)).collect()
    }

    /// Fraction absorbed in all layers.
    pub fn absorbed(&self) -> Estimate {
        self.at(ABSORBED, 1.0)
    }

    /// Fraction that Russian roulette took more than it gave: 0 but for chance. With it, everything adds up to 1.
    pub fn roulette(&self) -> f64 {
        self.at(ROULETTE, 1.0).value
    }

    /// Reflectance per area around the beam, 1/mm², ring by ring: R(r) averaged over each ring.
    pub fn reflectance_per_mm2(&self) -> Vec<Estimate> {
        self.rings(self.slots.reflectance_by_radius)
    }

    /// The same for the light that leaves through the bottom.
    pub fn transmittance_per_mm2(&self) -> Vec<Estimate> {
        self.rings(self.slots.transmittance_by_radius)
    }

    /// Fractions that leave through the top by cosine, bin by bin.
    pub fn reflectance_by_cosine(&self) -> Vec<Estimate> {
        self.range(self.slots.reflectance_by_cosine, self.grid.cosine_bins)
    }

    /// The same for the bottom.
    pub fn transmittance_by_cosine(&self) -> Vec<Estimate> {
        self.range(self.slots.transmittance_by_cosine, self.grid.cosine_bins)
    }

    /// Fractions absorbed sheet by sheet, and beyond the last.
    pub fn absorbed_by_depth(&self) -> Vec<Estimate> {
        self.range(self.slots.absorption_by_depth, self.grid.depth_bins + 1)
    }

    /// Fraction that leaves through the top of each ring, and beyond the last.
    pub fn reflectance_by_ring(&self) -> Vec<Estimate> {
        self.range(self.slots.reflectance_by_radius, self.grid.rings.count() + 1)
    }

    /// The same for the bottom.
    pub fn transmittance_by_ring(&self) -> Vec<Estimate> {
        self.range(self.slots.transmittance_by_radius, self.grid.rings.count() + 1)
    }

    /// Edges of the rings from 0 outwards, mm.
    pub fn ring_edges_mm(&self) -> &[f64] {
        self.grid.rings.edges_mm()
    }

    /// Middle of each ring, mm.
    pub fn ring_radii_mm(&self) -> Vec<f64> {
        self.ring_edges_mm().windows(2).map(|ring| 0.5 * (ring[0] + ring[1])).collect()
    }

    fn rings(&self, first: usize) -> Vec<Estimate> {
        let area_mm2 = |ring: &[f64]| PI * (ring[1] * ring[1] - ring[0] * ring[0]);
        let rings = self.ring_edges_mm().windows(2).enumerate();
        rings.map(|(i, ring)| self.at(first + i, 1.0 / area_mm2(ring))).collect()
    }

    fn range(&self, first: usize, count: usize) -> Vec<Estimate> {
        (first..first + count).map(|i| self.at(i, 1.0)).collect()
    }

    /// The mean of a counter for one packet, and the standard error from how far batches are from that mean.
    fn at(&self, slot: usize, scale: f64) -> Estimate {
        let [sum, squares, with_packets] = self.sums[slot];
        let (packets, batches) = (self.packets as f64, self.batches as f64);
        let mean = sum / packets;
        // Σ (s - n mean)², opened up.
        let scatter = squares - 2.0 * mean * with_packets + mean * mean * self.packets_squared;
        let standard_error = if self.batches > 1 {
            (scatter.max(0.0) * batches / (batches - 1.0)).sqrt() / packets
        } else {
            f64::INFINITY
        };
        Estimate { value: scale * mean, standard_error: scale * standard_error }
    }
}
