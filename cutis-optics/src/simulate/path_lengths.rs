//! Path lengths by place of exit, weighted for any absorption.
//!
//! For absorption a_j the light that leaves a ring is Σ W e^(-a·L) over its packets. Over a cell with mean path m and
//! covariance C this is W e^(-a·m) (1 + a·C a/2 + third moments): with s = a·L, cells of width δ = 1/8 in ln L are narrow,
//! packets lie nearly evenly in them, and what is left out is the fourth moment, (δ s)⁴/1920 of the cell, and what the
//! slope of the density makes of the third, (δ s)³ δ/240 or so: at s = 2, where cells count most, 2e-6 and 8e-6; at s = 8,
//! where 3 in 10,000 are left, 5e-4 and 5e-4. Two layers add their s. Summed over all that skin
//! reflects it is below 1e-4, which a test holds it to.
//!
//! Every packet leaves once at most, so that the variance of a sum is Σ (W e^(-a·L))² less the square of the mean.

use super::Estimate;
use super::lanes::{LANES, Lanes, splat};
use super::path_counter::{CellKey, moments_of};
use super::paths::PathError;
use super::rings::Rings;
use crate::ring_profile::RingProfile;
use core::ops::Range;

/// Below this power of e nothing is left, and the exponential function stays a normal number.
const NOTHING_LEFT: f64 = -700.0;

/// How far light flew in each layer, by where it left.
#[derive(Debug, Clone)]
pub struct PathLengths {
    edges_mm: Vec<f64>,
    layers: usize,
    specular_reflectance: f64,
    packets: u64,
    /// Cells side by side: weights, squared weights, means and covariances of paths; stride as the moments.
    cells: Vec<Lanes>,
    /// Where the cells of a ring are: rings of reflectance and what is beyond them, then the same of transmittance.
    rings: Vec<Range<usize>>,
}

/// What leaves at one choice of absorption, as fractions of the light that entered.
#[derive(Debug, Clone)]
pub struct Absorbed {
    /// By radius, through the top.
    pub reflectance: RingProfile,
    /// By radius, through the bottom.
    pub transmittance: RingProfile,
    /// All of it.
    pub total_reflectance: Estimate,
    /// All of it.
    pub total_transmittance: Estimate,
}

/// Σ X and Σ X² of the packets of a ring.
type Sums = [f64; 2];

impl PathLengths {
    /// From cells sorted by ring.
    pub(super) fn new(
        rings: &Rings,
        layers: usize,
        specular_reflectance: f64,
        packets: u64,
        cells: &[(CellKey, &[f64])],
    ) -> Self {
        let mut lengths = Self {
            edges_mm: rings.edges_mm().to_vec(),
            layers,
            specular_reflectance,
            packets,
            cells: Vec::new(),
            rings: Vec::new(),
        };
        for ring in 0..2 * (rings.count() + 1) {
            let first = cells.partition_point(|(key, _)| (key.ring as usize) < ring);
            let last = cells.partition_point(|(key, _)| (key.ring as usize) <= ring);
            lengths.push_ring(&cells[first..last]);
        }
        lengths
    }

    fn push_ring(&mut self, cells: &[(CellKey, &[f64])]) {
        let begin = self.cells.len();
        for group in cells.chunks(LANES) {
            let mut lanes = vec![[0.0; LANES]; moments_of(self.layers)];
            for (lane, (_, moments)) in group.iter().enumerate() {
                let central = central_moments(self.layers, moments);
                lanes.iter_mut().zip(central).for_each(|(lanes, value)| lanes[lane] = value);
            }
            self.cells.extend(lanes.into_iter().map(Lanes::new));
        }
        self.rings.push(begin..self.cells.len());
    }

    /// Layers that have an absorption.
    pub fn layers(&self) -> usize {
        self.layers
    }

    /// Packets that were simulated.
    pub fn packets(&self) -> u64 {
        self.packets
    }

    /// Fraction of the beam that the top surface mirrors before anything enters.
    pub fn specular_reflectance(&self) -> f64 {
        self.specular_reflectance
    }

    /// Memory that the cells take.
    pub fn bytes(&self) -> usize {
        size_of_val(self.cells.as_slice()) + size_of_val(self.rings.as_slice())
    }

    /// What leaves when the layers absorb this much.
    ///
    /// # Errors
    /// If there is not one coefficient for every layer, or one is negative or above 1e9.
    pub fn with_absorption(&self, sigma_a_per_mm: &[f64]) -> Result<Absorbed, PathError> {
        if sigma_a_per_mm.len() != self.layers {
            return Err(PathError::WrongCount { layers: self.layers, got: sigma_a_per_mm.len() });
        }
        for (i, &value) in sigma_a_per_mm.iter().enumerate() {
            let fine = (0.0..=1e9).contains(&value);
            if !fine {
                return Err(PathError::Absorption { layer: i + 1, value });
            }
        }
        let sums: Vec<Sums> = self.rings.iter().map(|ring| self.ring(ring, sigma_a_per_mm)).collect();
        let (top, bottom) = sums.split_at(self.edges_mm.len());
        Ok(Absorbed {
            reflectance: self.profile(top),
            transmittance: self.profile(bottom),
            total_reflectance: self.total(top),
            total_transmittance: self.total(bottom),
        })
    }

    fn ring(&self, cells: &Range<usize>, sigma_a_per_mm: &[f64]) -> Sums {
        let mut sums = [splat(0.0); 2];
        for cell in self.cells[cells.clone()].chunks_exact(moments_of(self.layers)) {
            let (means, covariances) = cell[2..].split_at(self.layers);
            let mut depth = splat(0.0);
            let mut spread = splat(0.0);
            let mut covariance = covariances.iter();
            for (j, &sigma_a) in sigma_a_per_mm.iter().enumerate() {
                depth = means[j].mul_add(splat(sigma_a), depth);
                for (&other, &c) in sigma_a_per_mm[..=j].iter().zip(&mut covariance) {
                    spread = c.mul_add(splat(sigma_a * other), spread);
                }
            }
            let left = (-depth).fast_max(splat(NOTHING_LEFT)).exp();
            let one = splat(1.0);
            sums[0] = (cell[0] * left).mul_add(one + spread, sums[0]);
            // Squares fall twice as fast: four times the spread.
            sums[1] = (cell[1] * left * left).mul_add(splat(4.0).mul_add(spread, one), sums[1]);
        }
        sums.map(Lanes::reduce_add)
    }

    fn profile(&self, rings: &[Sums]) -> RingProfile {
        let shares: Vec<Estimate> = rings.iter().map(|ring| self.estimate(ring)).collect();
        RingProfile::from_shares(self.edges_mm.clone(), &shares)
    }

    fn total(&self, rings: &[Sums]) -> Estimate {
        self.estimate(&rings.iter().fold([0.0; 2], |sum, ring| [sum[0] + ring[0], sum[1] + ring[1]]))
    }

    fn estimate(&self, &[sum, squares]: &Sums) -> Estimate {
        let packets = self.packets as f64;
        let value = sum / packets;
        let variance = (squares / packets - value * value).max(0.0);
        Estimate { value, standard_error: (variance / packets).sqrt() }
    }
}

/// Σ W, Σ W², means, and covariances of which those between two layers are doubled and all are halved: what stands in
/// a·C a/2, each pair once.
fn central_moments(layers: usize, moments: &[f64]) -> Vec<f64> {
    let weight = moments[0];
    let means: Vec<f64> = moments[2..2 + layers].iter().map(|sum| sum / weight).collect();
    let pairs = (0..layers).flat_map(|j| (0..=j).map(move |k| (j, k)));
    let spreads = pairs.zip(&moments[2 + layers..]).map(|((j, k), sum)| {
        let covariance = sum / weight - means[j] * means[k];
        if j == k { 0.5 * covariance.max(0.0) } else { covariance }
    });
    moments[..2].iter().copied().chain(means.iter().copied()).chain(spreads).collect()
}
