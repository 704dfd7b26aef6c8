//! Rings around the beam: even where light leaves near it, and growing outwards, where little is left and nothing is fine.

use super::lanes::{LANES, Lanes, bins, indices, splat};

/// Edges of rings, from the beam outwards.
#[derive(Debug, Clone, PartialEq)]
pub struct Rings {
    edges_mm: Vec<f64>,
    /// Rings of the same width, and how many of them go into a millimetre.
    even: usize,
    per_mm: f64,
}

/// Why rings are refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{quantity} must be {range}, got {value}")]
pub struct RingError {
    /// The number at fault.
    quantity: &'static str,
    range: &'static str,
    value: f64,
}

impl Rings {
    /// `even` rings of the same width, then ever wider ones, each edge `growth` times as far as the one before, until the
    /// outermost edge lies at `outermost_mm` or beyond.
    ///
    /// # Errors
    /// If a number is out of its range.
    pub fn new(width_mm: f64, even: usize, growth: f64, outermost_mm: f64) -> Result<Self, RingError> {
        let check = |fine: bool, quantity, range, value| {
            if fine { Ok(()) } else { Err(RingError { quantity, range, value }) }
        };
        check((1e-9..=1e9).contains(&width_mm), "width_mm", "from 1e-9 to 1e9 mm", width_mm)?;
        check((1..=100_000).contains(&even), "even", "from 1 to 100000", even as f64)?;
        // 10,000 rings to each factor of 2.72 are more than anybody fills.
        check((1.0001..=10.0).contains(&growth), "growth", "from 1.0001 to 10", growth)?;
        check((0.0..=1e9).contains(&outermost_mm), "outermost_mm", "from 0 to 1e9 mm", outermost_mm)?;
        let mut edges_mm: Vec<f64> = (0..=even).map(|i| width_mm * i as f64).collect();
        let mut edge_mm = width_mm * even as f64;
        while edge_mm < outermost_mm {
            edge_mm *= growth;
            edges_mm.push(edge_mm);
        }
        Ok(Self { edges_mm, even, per_mm: width_mm.recip() })
    }

    /// So many rings of the same width.
    ///
    /// # Errors
    /// If a number is out of its range.
    pub fn even(width_mm: f64, count: usize) -> Result<Self, RingError> {
        Self::new(width_mm, count, 2.0, 0.0)
    }

    /// From 0.005 mm near the beam, a twenty-seventh of the transport mean free path in epidermis at 500 nm, to 30 mm.
    pub fn of_skin() -> Self {
        Self::new(0.005, 20, 1.2, 30.0).expect("the numbers are in their ranges")
    }

    /// The edges, the beam's 0 first.
    pub fn edges_mm(&self) -> &[f64] {
        &self.edges_mm
    }

    /// How many rings there are; beyond the last is everything else.
    pub fn count(&self) -> usize {
        self.edges_mm.len() - 1
    }

    /// The ring at this radius, [`Rings::count`] beyond the last.
    pub(super) fn at(&self, r_mm: f64) -> usize {
        let place = r_mm * self.per_mm;
        if place < self.even as f64 { place as usize } else { self.at_far(r_mm) }
    }

    /// The rings at eight radii.
    #[inline(always)]
    pub(super) fn at_all(&self, r_mm: Lanes) -> [usize; LANES] {
        let mut rings = indices(bins(r_mm * splat(self.per_mm), splat(self.even as f64)));
        if self.count() > self.even {
            self.find_far(&mut rings, r_mm);
        }
        rings
    }

    /// Out of the loop that most radii go through.
    #[inline(never)]
    fn find_far(&self, rings: &mut [usize; LANES], r_mm: Lanes) {
        for (ring, r_mm) in rings.iter_mut().zip(r_mm.to_array()) {
            if *ring == self.even {
                *ring = self.at_far(r_mm);
            }
        }
    }

    /// The ring at a radius beyond the even ones.
    fn at_far(&self, r_mm: f64) -> usize {
        self.even + self.edges_mm[self.even + 1..].partition_point(|&edge_mm| edge_mm <= r_mm)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;

    #[test]
    fn rings_are_even_then_grow_and_every_radius_has_one() {
        let rings = Rings::new(0.5, 2, 2.0, 3.0).unwrap();
        assert_eq!(rings.edges_mm(), [0.0, 0.5, 1.0, 2.0, 4.0]);
        let of = [0.0, 0.499, 0.5, 1.5, 2.0, 3.999, 4.0, f64::INFINITY].map(|r_mm| rings.at(r_mm));
        assert_eq!(of, [0, 0, 1, 2, 3, 3, 4, 4]);
        let radii_mm = [0.0, 0.499, 0.5, 1.5, 2.0, 3.999, 4.0, f64::INFINITY];
        assert_eq!(rings.at_all(Lanes::new(radii_mm)), of);
        let even = Rings::even(0.5, 2).unwrap();
        assert_eq!(even.at_all(Lanes::new(radii_mm)), radii_mm.map(|r_mm| even.at(r_mm)));
        assert_eq!(Rings::even(0.5, 3).unwrap().edges_mm(), [0.0, 0.5, 1.0, 1.5]);
        assert!(Rings::new(0.5, 2, 1.0, 3.0).unwrap_err().to_string().starts_with("growth must be"));
    }
}
