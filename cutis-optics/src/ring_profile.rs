//! A profile measured in rings around the beam, by simulation: what leaves each ring, and how far that may be off.
//!
//! Within a ring the light is taken as even, which makes the Hankel transform a finite sum: a disc of radius a and height 1
//! has 2 pi a J1(k a)/k, a ring the difference of two discs (J1 is the Bessel function of first order).
//! Light beyond the outermost ring is known as a number only; it is no part of the profile.

use crate::profile::Profile;
use crate::simulate::{Estimate, Estimates};
use core::f64::consts::{PI, TAU};

/// Rings and what leaves them, per flux that entered the surface.
#[derive(Debug, Clone, PartialEq)]
pub struct RingProfile {
    edges_mm: Vec<f64>,
    reflectance_per_mm2: Vec<f64>,
    standard_error_per_mm2: Vec<f64>,
    beyond: Estimate,
}

impl RingProfile {
    /// From the share of the light in every ring, and beyond the last.
    ///
    /// # Panics
    /// If there is not one share for every edge.
    pub(crate) fn from_shares(edges_mm: Vec<f64>, shares: &[Estimate]) -> Self {
        assert_eq!(edges_mm.len(), shares.len(), "a share for each ring and one for what is beyond");
        let density = |share: fn(&Estimate) -> f64| -> Vec<f64> {
            edges_mm.windows(2).zip(shares).map(|(ring, s)| share(s) / area_mm2(ring)).collect()
        };
        let reflectance_per_mm2 = density(|share| share.value);
        let standard_error_per_mm2 = density(|share| share.standard_error);
        Self { edges_mm, reflectance_per_mm2, standard_error_per_mm2, beyond: shares[shares.len() - 1] }
    }

    /// Reflectance of a simulation with absorption.
    pub fn from_estimates(estimates: &Estimates) -> Self {
        Self::per_entered(estimates, &estimates.reflectance_by_ring())
    }

    /// Transmittance of a simulation with absorption.
    pub fn transmittance_from_estimates(estimates: &Estimates) -> Self {
        Self::per_entered(estimates, &estimates.transmittance_by_ring())
    }

    fn per_entered(estimates: &Estimates, by_ring: &[Estimate]) -> Self {
        let entered = 1.0 - estimates.specular_reflectance();
        let share =
            |e: &Estimate| Estimate { value: e.value / entered, standard_error: e.standard_error / entered };
        let shares: Vec<Estimate> = by_ring.iter().map(share).collect();
        Self::from_shares(estimates.ring_edges_mm().to_vec(), &shares)
    }

    /// Edges of the rings, from 0 outwards: one more than there are rings.
    pub fn edges_mm(&self) -> &[f64] {
        &self.edges_mm
    }

    /// Mean exitance of every ring, 1/mm².
    pub fn reflectance_per_mm2(&self) -> &[f64] {
        &self.reflectance_per_mm2
    }

    /// Standard error of each, 1/mm².
    pub fn standard_error_per_mm2(&self) -> &[f64] {
        &self.standard_error_per_mm2
    }

    /// What leaves beyond the outermost ring.
    pub fn beyond(&self) -> Estimate {
        self.beyond
    }

    /// Radius in the middle of a ring, where 1/r is the ring's mean exactly, and a constant anyway.
    fn middle_mm(&self, ring: usize) -> f64 {
        0.5 * (self.edges_mm[ring] + self.edges_mm[ring + 1])
    }
}

impl Profile for RingProfile {
    fn spectrum(&self, k_per_mm: f64) -> f64 {
        let rings = self.edges_mm.windows(2).zip(&self.reflectance_per_mm2);
        if k_per_mm == 0.0 {
            return rings.map(|(ring, height)| area_mm2(ring) * height).sum();
        }
        // Each edge is the end of one ring and the beginning of the next.
        let disc = |edge_mm: f64| edge_mm * libm::j1(k_per_mm * edge_mm);
        let mut inner = 0.0;
        let sum: f64 = rings
            .map(|(ring, height)| {
                let outer = disc(ring[1]);
                height * (outer - core::mem::replace(&mut inner, outer))
            })
            .sum();
        TAU / k_per_mm * sum
    }

    /// A power of the radius between the middles of two rings (where one is empty, a straight line), and on towards the beam:
    /// never negative, and for light that goes as 1/r, as that scattered once does, with the mean of every ring. Beyond the
    /// outermost ring there is nothing; at the beam itself the profile may be infinite.
    fn at_mm(&self, r_mm: f64) -> f64 {
        let heights = &self.reflectance_per_mm2;
        if r_mm >= self.edges_mm[heights.len()] {
            return 0.0;
        }
        // The ring that holds the radius, and its middle too if that lies before it.
        let holding = self.edges_mm[1..].partition_point(|&edge_mm| edge_mm <= r_mm);
        let middles_passed = holding + usize::from(self.middle_mm(holding) <= r_mm);
        if middles_passed == heights.len() || heights.len() == 1 {
            return heights[heights.len() - 1];
        }
        let after = middles_passed.max(1);
        let [from, to] = [after - 1, after].map(|ring| self.middle_mm(ring));
        let [a, b] = [heights[after - 1], heights[after]];
        if a > 0.0 && b > 0.0 {
            // Towards the beam no steeper than 1/r, and never falling: two rings may differ by chance.
            let power = (b / a).ln() / (to / from).ln();
            let power = if middles_passed == 0 { power.clamp(-1.0, 0.0) } else { power };
            return a * (r_mm / from).powf(power);
        }
        (a + (b - a) * (r_mm - from) / (to - from)).max(0.0)
    }
}

fn area_mm2(ring: &[f64]) -> f64 {
    PI * (ring[1] - ring[0]) * (ring[1] + ring[0])
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::oracle::{bessel_j0, simpson};
    use crate::simulate::{Grid, Layer, LayeredSlab, Rings, Simulation};

    fn share(value: f64) -> Estimate {
        Estimate { value, standard_error: 0.1 * value }
    }

    fn profile() -> RingProfile {
        let shares = [0.1, 0.2, 0.05, 0.01].map(share);
        RingProfile::from_shares(vec![0.0, 0.1, 0.3, 1.0], &shares)
    }

    #[test]
    fn the_spectrum_meets_quadrature_and_begins_with_the_total() {
        let profile = profile();
        for k_per_mm in [1e-6, 0.3, 2.0, 17.0, 60.0] {
            let rings = profile.edges_mm.windows(2).zip(&profile.reflectance_per_mm2);
            let integral: f64 = rings
                .map(|(ring, height)| {
                    simpson(ring[0], ring[1], 2000, |r| TAU * height * bessel_j0(k_per_mm * r) * r)
                })
                .sum();
            assert!((profile.spectrum(k_per_mm) - integral).abs() < 1e-10, "k {k_per_mm}");
        }
        assert!((profile.total() - 0.35).abs() < 1e-15);
        assert!((profile.spectrum(1e-9) - 0.35).abs() < 1e-12);
    }

    #[test]
    fn values_between_rings_are_positive_and_near_their_means() {
        // A Gaussian whose exponent grows by s = 0.2 r over a ring: the mean is about 1 + s²/24 of the middle, 1.5 % at 3.
        let exact = |r: f64| (-r * r).exp();
        let edges_mm: Vec<f64> = (0..=30).map(|i| 0.1 * f64::from(i)).collect();
        let mut shares: Vec<Estimate> =
            edges_mm.windows(2).map(|e| share(PI * (exact(e[0]) - exact(e[1])))).collect();
        shares.push(share(0.0));
        let profile = RingProfile::from_shares(edges_mm, &shares);
        for r in [0.1, 0.33, 1.0, 2.2, 2.9] {
            // The power law between two middles bends the other way: half as much again.
            assert!((profile.at_mm(r) / exact(r) - 1.0).abs() < 0.025, "{r}: {}", profile.at_mm(r));
        }
        assert_eq!(profile.at_mm(3.0), 0.0);
    }

    #[test]
    fn light_that_goes_as_one_over_r_is_met_exactly() {
        let edges_mm: Vec<f64> = (0..=10).map(|i| 0.1 * f64::from(i)).collect();
        let mut shares: Vec<Estimate> = edges_mm.windows(2).map(|e| share(TAU * (e[1] - e[0]))).collect();
        shares.push(share(0.0));
        let profile = RingProfile::from_shares(edges_mm, &shares);
        for r in [1e-6, 0.01, 0.05, 0.12, 0.5, 0.94] {
            assert!((profile.at_mm(r) * r - 1.0).abs() < 1e-12, "{r}: {}", profile.at_mm(r));
        }
        // An empty ring, and the beam itself.
        let holes = RingProfile::from_shares(vec![0.0, 0.1, 0.2, 0.3], &[0.1, 0.0, 0.2, 0.0].map(share));
        assert!([0.0, 0.01, 0.08, 0.12, 0.2, 0.29].iter().all(|&r| holes.at_mm(r) >= 0.0));
        assert!(holes.at_mm(0.15) < 1e-12);
    }

    #[test]
    fn a_simulation_s_profile_is_per_light_that_entered() {
        let layer = Layer {
            sigma_a_per_mm: 0.1,
            sigma_s_per_mm: 5.0,
            g: 0.0,
            refractive_index: 1.5,
            thickness_mm: f64::INFINITY,
        };
        let grid =
            Grid { rings: Rings::even(0.1, 20).unwrap(), depth_step_mm: 1.0, depth_bins: 1, cosine_bins: 0 };
        let slab = LayeredSlab::in_air(vec![layer]).unwrap();
        let estimates = Simulation { slab, grid, seed: 1 }.run(20_000);
        let profile = RingProfile::from_estimates(&estimates);
        let all = profile.total() + profile.beyond().value;
        // Index 1.5 mirrors 4 %.
        assert!((all * 0.96 - estimates.diffuse_reflectance().value).abs() < 1e-12);
        assert!((profile.edges_mm()[20] - 2.0).abs() < 1e-12 && profile.beyond().value > 0.0);
    }
}
