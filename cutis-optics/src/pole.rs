//! One pole of a dipole or multipole: a point source at some depth under, or mirrored over, a surface.
//!
//! Symbols: z depth, sigma_tr effective transport coefficient, q = sqrt(k² + sigma_tr²), v variance.
//! R(r) = z (1 + sigma_tr s) e^(-sigma_tr s) / (4 pi s³), s = sqrt(r² + z²); R(k) = e^(-z q)/2.
//! A pole *is* a sum of Gaussians, of all variances: diffusion is random walk, and what leaves at time t is a Gaussian of
//! variance v = 2 D t. From e^(-z q) = ∫ z/(2 sqrt(pi)) t^(-3/2) e^(-z²/4t) e^(-q² t) dt with t = v/2, the weight of the
//! Gaussians of variance v to v + dv is z/(2 sqrt(2 pi)) v^(-3/2) e^(-z²/2v - sigma_tr² v/2) dv. (The derivation is ours; that
//! diffusion profiles are such mixtures is the starting point of d'Eon & Irving 2011, doi:10.1145/1964921.1964951, not opened.)

use core::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

/// A pole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pole {
    /// Albedo, negative for a sink.
    pub power: f64,
    /// z, mm, positive.
    pub depth_mm: f64,
    /// sigma_tr, 1/mm.
    pub sigma_tr_per_mm: f64,
}

impl Pole {
    /// Exitance per area at distance `r_mm`, 1/mm².
    pub fn at_mm(&self, r_mm: f64) -> f64 {
        let s = r_mm.hypot(self.depth_mm);
        let x = self.sigma_tr_per_mm * s;
        self.power * self.depth_mm * (1.0 + x) * (-x).exp() / (4.0 * PI * s * s * s)
    }

    /// Total over the plane.
    pub fn total(&self) -> f64 {
        0.5 * self.power * (-self.sigma_tr_per_mm * self.depth_mm).exp()
    }

    /// Weight of the Gaussians around a variance, per mm² of it.
    pub fn weight_per_mm2(&self, variance_mm2: f64) -> f64 {
        let (z, v) = (self.depth_mm, variance_mm2);
        let exponent = -0.5 * (z * z / v + self.sigma_tr_per_mm * self.sigma_tr_per_mm * v);
        0.5 * self.power * z * exponent.exp() / (v * (TAU * v).sqrt())
    }

    /// Weight of all Gaussians wider than a variance.
    ///
    /// Its distribution is the inverse Gaussian one: with a = z/sqrt(v) - sigma_tr sqrt(v), b = z/sqrt(v) + sigma_tr sqrt(v),
    /// (e^(-sigma_tr z) erfc(-a/sqrt 2) - e^(sigma_tr z) erfc(b/sqrt 2)) / 4.
    pub fn weight_beyond(&self, variance_mm2: f64) -> f64 {
        let (near, far) = (self.depth_mm / variance_mm2.sqrt(), self.sigma_tr_per_mm * variance_mm2.sqrt());
        let x = self.sigma_tr_per_mm * self.depth_mm;
        let falling = (-x).exp() * libm::erfc((far - near) * FRAC_1_SQRT_2);
        let mirrored = libm::erfc((near + far) * FRAC_1_SQRT_2);
        // e^x overflows only where the other factor is nothing.
        let rising = if mirrored > 0.0 { (x + mirrored.ln()).exp() } else { 0.0 };
        0.25 * self.power * (falling - rising)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::simpson;

    const POLES: [Pole; 3] = [
        Pole { power: 0.9, depth_mm: 0.4, sigma_tr_per_mm: 1.3 },
        Pole { power: -0.5, depth_mm: 2.0, sigma_tr_per_mm: 0.05 },
        Pole { power: 1.0, depth_mm: 1.0, sigma_tr_per_mm: 0.0 },
    ];

    #[test]
    fn a_pole_is_the_sum_of_its_gaussians() {
        for pole in POLES {
            for r in [0.0, 0.3, 2.0] {
                // ∫ w(v) e^(-r²/2v)/(2 pi v) dv over ln v; beyond 1e8 mm² there is 1e-12 of it.
                let slow = simpson(1e-4f64.ln(), 1e8f64.ln(), 4000, |t| {
                    let v = t.exp();
                    v * pole.weight_per_mm2(v) * (-0.5 * r * r / v).exp() / (TAU * v)
                });
                assert!((pole.at_mm(r) - slow).abs() < 1e-9, "{pole:?} at {r}: {slow}");
            }
        }
    }

    #[test]
    fn weights_beyond_a_variance_are_their_integral() {
        for pole in &POLES[..2] {
            for v in [1e-3f64, 0.1, 1.0, 30.0] {
                let slow = simpson(v.ln(), 1e5f64.ln(), 4000, |t| t.exp() * pole.weight_per_mm2(t.exp()));
                assert!((pole.weight_beyond(v) - slow).abs() < 1e-10, "{pole:?} beyond {v}: {slow}");
            }
            assert!((pole.weight_beyond(1e-9) - pole.total()).abs() < 1e-15);
        }
        // Deep and absorbing: no overflow.
        let deep = Pole { power: 1.0, depth_mm: 1000.0, sigma_tr_per_mm: 10.0 };
        assert!(deep.weight_beyond(1.0).abs() < 1e-300);
    }
}
