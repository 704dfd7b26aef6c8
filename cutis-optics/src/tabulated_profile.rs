//! A profile that is asked often: its values are computed once and looked up.
//!
//! Layers have no closed form over the radius: every value is an integral over all frequencies. Between nodes, which lie evenly
//! in x = ln(1 + r/scale), ln R is a cubic through the four nearest (Lagrange); R itself where one of them is not above 0, as
//! diffusion has it around layers thinner than a mean free path.

use crate::Profile;
use core::f64::consts::PI;

/// Distance of the nodes in x.
const STEP: f64 = 1.0 / 32.0;
/// Nodes at most: out to 10⁷ times the scale.
const NODES_MAX: usize = 512;
/// The table ends where so small a part of all light is left, by π r² R: less than any sampler draws from …
const NEGLIGIBLE: f64 = 1e-9;
/// … over so many nodes: R may pass through 0.
const NEGLIGIBLE_NODES: usize = 8;

/// A profile with a table of its values.
#[derive(Debug, Clone, PartialEq)]
pub struct TabulatedProfile<P> {
    profile: P,
    total: f64,
    scale_mm: f64,
    /// R at the nodes, 1/mm².
    values: Vec<f64>,
}

impl<P: Profile> TabulatedProfile<P> {
    /// The table of a profile that is finite under the beam; `scale_mm` is the shortest length in it, as the mean free path of
    /// the topmost layer.
    ///
    /// Values are within 1e-5 of themselves where R is above 0; beyond the table, where 1e-9 of the light is left, they are 0.
    pub fn new(profile: P, scale_mm: f64) -> Self {
        let total = profile.total();
        let mut values = Vec::new();
        let mut negligible = 0;
        while values.len() < NODES_MAX && negligible < NEGLIGIBLE_NODES {
            let r_mm = scale_mm * (STEP * values.len() as f64).exp_m1();
            let value = profile.at_mm(r_mm);
            let is_left = r_mm < scale_mm || PI * r_mm * r_mm * value.abs() > NEGLIGIBLE * total;
            negligible = if is_left { 0 } else { negligible + 1 };
            values.push(value);
        }
        Self { profile, total, scale_mm, values }
    }
}

impl<P: Profile> Profile for TabulatedProfile<P> {
    fn spectrum(&self, k_per_mm: f64) -> f64 {
        self.profile.spectrum(k_per_mm)
    }

    fn at_mm(&self, r_mm: f64) -> f64 {
        let x = (r_mm.max(0.0) / self.scale_mm).ln_1p() / STEP;
        let last = self.values.len() as f64 - 1.0;
        if x > last || last < 3.0 {
            return 0.0;
        }
        // The four nodes around x, or the outermost four.
        let first = (x as usize).saturating_sub(1).min(self.values.len() - 4);
        let nodes = [0, 1, 2, 3].map(|i| self.values[first + i]);
        let t = x - first as f64;
        if nodes.iter().all(|&value| value > 0.0) {
            cubic(nodes.map(f64::ln), t).exp()
        } else {
            cubic(nodes, t)
        }
    }

    fn total(&self) -> f64 {
        self.total
    }
}

/// The cubic through values at 0, 1, 2 and 3.
fn cubic([a, b, c, d]: [f64; 4], t: f64) -> f64 {
    let [u, v, w] = [t - 1.0, t - 2.0, t - 3.0];
    -a * u * v * w / 6.0 + b * t * v * w / 2.0 - c * t * u * w / 2.0 + d * t * u * v / 6.0
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::sample::{DipoleSampler, RadialSampler, TabulatedSampler};
    use crate::{Dipole, Medium, Stack, TissueLayer};

    /// The dipole has a closed form: nearly clear, usual and nearly opaque media, from under the beam to where nothing is left.
    #[test]
    fn values_are_those_of_the_closed_form() {
        for (sigma_a, sigma_s) in [(1e-4, 1.0), (0.05, 1.0), (1.0, 1.0), (1e-3, 80.0)] {
            let medium = Medium::new(sigma_a, sigma_s, 1.4).unwrap();
            let dipole = Dipole::new(&medium).unwrap();
            let table = TabulatedProfile::new(dipole, medium.transport_mean_free_path_mm());
            assert_eq!(table.total(), dipole.total());
            for i in 0..4000 {
                let r_mm = medium.transport_mean_free_path_mm() * 40.0 * (f64::from(i) / 4000.0).powi(2);
                let (found, exact) = (table.at_mm(r_mm), dipole.at_mm(r_mm));
                let left = core::f64::consts::PI * r_mm * r_mm * exact / dipole.total();
                assert!(
                    (found - exact).abs() < 1e-5 * exact || left < 2.0 * NEGLIGIBLE,
                    "{r_mm}: {found} {exact}"
                );
            }
            assert_eq!(table.at_mm(f64::MAX), 0.0);
            assert_eq!((table.at_mm(-1.0), table.at_mm(f64::NAN)), (table.at_mm(0.0), table.at_mm(0.0)));
        }
    }

    #[test]
    fn layers_are_met_between_the_nodes() {
        let layer =
            |a, s, thickness_mm| TissueLayer { medium: Medium::new(a, s, 1.4).unwrap(), thickness_mm };
        let stack = Stack::in_air(&[layer(0.25, 4.8, 0.3), layer(0.1, 2.4, f64::INFINITY)]).unwrap();
        let scale_mm = stack.shortest_mean_free_path_mm();
        let table = TabulatedProfile::new(stack.clone(), scale_mm);
        for r_mm in [0.003, 0.11, 0.52, 1.7, 4.1] {
            let (found, exact) = (table.at_mm(r_mm), stack.at_mm(r_mm));
            assert!((found / exact - 1.0).abs() < 1e-5, "{r_mm}: {found} {exact}");
        }
    }

    /// A layer of a quarter of its mean free path has a ring of negative R, with light beyond it.
    #[test]
    fn light_beyond_a_negative_ring_is_kept() {
        let layer =
            |a, s, thickness_mm| TissueLayer { medium: Medium::new(a, s, 1.4).unwrap(), thickness_mm };
        let stack = Stack::in_air(&[layer(0.05, 5.0, 0.05), layer(0.05, 1.0, f64::INFINITY)]).unwrap();
        let table = TabulatedProfile::new(stack.clone(), stack.shortest_mean_free_path_mm());
        assert!(stack.at_mm(0.4) < 0.0 && stack.at_mm(2.0) > 0.0);
        for i in 0..40 {
            let r_mm = 1e-3 * 1.26f64.powi(i);
            let exact = stack.at_mm(r_mm);
            let off = (table.at_mm(r_mm) - exact).abs();
            // Where R passes through 0, of the light within the radius.
            let light = PI * r_mm * r_mm * off / stack.total();
            assert!(off < 1e-5 * exact.abs() || light < 1e-5, "{r_mm}: {off} of {exact}");
        }
    }

    /// Radii that are drawn from the table are those that the dipole's own sampler draws.
    #[test]
    fn samplers_see_no_difference() {
        let medium = Medium::new(0.05, 1.0, 1.4).unwrap();
        let dipole = Dipole::new(&medium).unwrap();
        let l_mm = medium.transport_mean_free_path_mm();
        let table = TabulatedSampler::new(&TabulatedProfile::new(dipole, l_mm), l_mm).unwrap();
        let exact = DipoleSampler::new(&dipole);
        for i in 1..100 {
            let r_mm = 20.0 * l_mm as f32 * (i as f32 / 100.0).powi(2);
            let off = (table.cdf(r_mm) - exact.cdf(r_mm)).abs();
            assert!(off < 2e-5, "{r_mm}: {off}");
        }
    }
}
