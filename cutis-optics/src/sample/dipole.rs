//! Radii of the dipole, by inversion of its cumulative distribution.
//!
//! Symbols: z depth of a source, a = sigma_tr z, u = s/z with s = sqrt(r² + z²), w = u - 1.
//! One source sends the share e^(-a w)/u of its light beyond r. A source is chosen by its total, e^(-a); then
//! a w + ln(1 + w) = -ln(1 - xi) is solved for w, and r = z sqrt(w (w + 2)).
//! Source: Mertens et al. 2003 (as restated in the project's theory notes); in w instead of u nothing cancels near the beam.
//! The solution is Lambert's function, W(a e^a/(1 - xi)) = a u. The step is Newton's with two more terms of the series, of
//! fourth order: Fritsch, Shafer & Crowley 1973, doi:10.1145/361952.361970 (not opened).

use super::{RadialSampler, in_lanes, odds, unit};
use crate::Dipole;
use core::f64::consts::TAU;
use wide::f32x8;

/// Steps to f32 precision, from the start that [`excess`] takes, for every `xi` and every medium: a third step moves less
/// than rounding does.
const STEPS: usize = 2;

/// Draws from a [`Dipole`]: no table, 5e-6 of the radius at most from the exact inverse of either source.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DipoleSampler {
    sources: [Source; 2],
    share_real: f32,
}

/// One source of the dipole.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Source {
    /// Of all light, what comes from it.
    share: f64,
    depth_mm: f64,
    /// a = sigma_tr z.
    sigma_tr_depth: f64,
}

impl Source {
    /// w at a radius; r²/(1 + sqrt(1 + r²)) in units of z, which does not cancel.
    fn excess_at(&self, r_mm: f64) -> f64 {
        // Farther than any f32 there is nothing, and at infinity 0 times infinity.
        let ratio = (r_mm / self.depth_mm).min(1e60);
        // Far out 1 + w = r/z.
        if ratio > 1e8 { ratio } else { ratio * ratio / (1.0 + ratio.hypot(1.0)) }
    }

    /// Density over the plane, 1/mm²: (1 + a u) e^(-a w)/(2 pi z² u³).
    fn density_per_mm2(&self, r_mm: f64) -> f64 {
        let (a, w) = (self.sigma_tr_depth, self.excess_at(r_mm));
        let u = 1.0 + w;
        (1.0 + a * u) * (-a * w).exp() / (TAU * self.depth_mm * self.depth_mm * u * u * u)
    }

    /// Share of its light within a radius.
    fn share_within(&self, r_mm: f64) -> f64 {
        let w = self.excess_at(r_mm);
        -(-self.sigma_tr_depth * w - w.ln_1p()).exp_m1()
    }
}

impl DipoleSampler {
    /// The sampler of a dipole: one for each channel.
    pub fn new(dipole: &Dipole) -> Self {
        let sigma_tr_per_mm = dipole.sigma_tr_per_mm();
        let depths_mm = [dipole.depth_real_mm(), dipole.height_virtual_mm()];
        let share_real = 1.0 / (1.0 + (-sigma_tr_per_mm * (depths_mm[1] - depths_mm[0])).exp());
        let source = |depth_mm: f64, share: f64| Source {
            share,
            depth_mm,
            sigma_tr_depth: sigma_tr_per_mm * depth_mm,
        };
        let sources = [source(depths_mm[0], share_real), source(depths_mm[1], 1.0 - share_real)];
        Self { sources, share_real: share_real as f32 }
    }

    #[inline(always)]
    fn radii(&self, xi: f32x8) -> f32x8 {
        let xi = unit(xi);
        let share_real = f32x8::splat(self.share_real);
        let is_real = xi.simd_lt(share_real);
        let [real, mirrored] = &self.sources;
        let of_chosen = |of: fn(&Source) -> f64| {
            is_real.select(f32x8::splat(of(real) as f32), f32x8::splat(of(mirrored) as f32))
        };
        let odds = odds(xi, is_real.select(f32x8::ZERO, share_real), is_real.select(share_real, f32x8::ONE));
        let w = excess(of_chosen(|s| s.sigma_tr_depth), odds);
        of_chosen(|s| s.depth_mm) * (w * (w + f32x8::splat(2.0))).sqrt()
    }
}

/// The root w ≥ 0 of a w + ln(1 + w) = ln(1 + odds).
#[inline(always)]
fn excess(a: f32x8, odds: f32x8) -> f32x8 {
    let one = f32x8::ONE;
    let target = odds.ln_1p();
    // The left side is concave, so that Newton's step from either end of [0, odds] falls short of the root: take the longer.
    let from_0 = target / (one + a);
    let from_odds = odds / (one + a * (one + odds));
    (0..STEPS).fold(from_0.fast_max(from_odds), |w, _| step(a, target, w))
}

/// One step of fourth order towards the root.
#[inline(always)]
fn step(a: f32x8, target: f32x8, w: f32x8) -> f32x8 {
    let (one, two) = (f32x8::ONE, f32x8::splat(2.0));
    let left = target - a * w - w.ln_1p();
    let slope = one + a * (one + w);
    let third = two * slope * (slope + f32x8::splat(2.0 / 3.0) * left);
    let newton = (one + w) * left / slope;
    (w + newton * (third - left) / (third - two * left)).fast_max(f32x8::ZERO)
}

impl RadialSampler for DipoleSampler {
    fn radius_mm(&self, xi: f32) -> f32 {
        self.radii(f32x8::splat(xi)).to_array()[0]
    }

    fn pdf_per_mm2(&self, radius_mm: f32) -> f32 {
        let r_mm = f64::from(radius_mm);
        self.sources.iter().map(|s| s.share * s.density_per_mm2(r_mm)).sum::<f64>() as f32
    }

    fn cdf(&self, radius_mm: f32) -> f32 {
        let r_mm = f64::from(radius_mm);
        self.sources.iter().map(|s| s.share * s.share_within(r_mm)).sum::<f64>() as f32
    }

    fn radii_mm(&self, xi: &[f32], radii_mm: &mut [f32]) {
        in_lanes(xi, radii_mm, |xi| self.radii(xi));
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::sample::XI_MAX;

    /// Every a that a real source can have (at most sqrt 3), and those of strongly reflecting boundaries.
    const SIGMA_TR_DEPTHS: [f32; 9] = [0.0, 1e-9, 1e-5, 1e-3, 0.03, 0.3, 1.732, 10.0, 100.0];

    /// Every multiple of 2^-24 in [0, 1), and floats down to the smallest: eight at a time.
    fn all_xi() -> impl Iterator<Item = f32x8> {
        let even = (0..1u32 << 21).map(|i| {
            f32x8::new(core::array::from_fn(|lane| (8 * i + lane as u32) as f32 * 0.5 * f32::EPSILON))
        });
        let tiny =
            (0..149).map(|e| f32x8::new(core::array::from_fn(|i| 0.1 * (i + 1) as f32 * 2f32.powi(-e))));
        even.chain(tiny)
    }

    #[test]
    fn every_xi_meets_the_equation_after_two_steps() {
        for a in SIGMA_TR_DEPTHS {
            let mut worst = 0.0_f64;
            for xi in all_xi() {
                let w = excess(f32x8::splat(a), odds(xi, f32x8::ZERO, f32x8::ONE)).to_array();
                for (xi, w) in xi.to_array().into_iter().zip(w) {
                    let (a, w, target) = (f64::from(a), f64::from(w), -f64::from(-xi).ln_1p());
                    // Left in the equation, over its slope in ln w: how far w is off, relative to itself.
                    let left = target - a * w - w.ln_1p();
                    let off = left / (w.max(1e-45) * (a + 1.0 / (1.0 + w)));
                    // Below 1e-37 floats have fewer digits.
                    worst = if xi > 1e-36 { worst.max(off.abs()) } else { worst };
                    assert!(w.is_finite() && w >= 0.0, "a {a}, xi {xi}: {w}");
                }
            }
            eprintln!("a {a}: w off by {worst:.2e} of itself at most");
            // ln(1 + odds) reaches 16.6, whose last digit is 1e-6 and whose rounding adds up from four terms, while
            // d ln w = d ln(1 + odds) at most (1 + 1/w near 0, where the logarithms are exact to their own last digit).
            assert!(worst < 5e-6, "a {a}: {worst}");
        }
    }

    #[test]
    fn a_third_step_moves_less_than_rounding() {
        for a in SIGMA_TR_DEPTHS.map(f32x8::splat) {
            for xi in all_xi().step_by(7) {
                let odds = odds(xi, f32x8::ZERO, f32x8::ONE);
                let (two, three) = (excess(a, odds), step(a, odds.ln_1p(), excess(a, odds)));
                for (two, three) in two.to_array().into_iter().zip(three.to_array()) {
                    assert!((three - two).abs() <= 5e-6 * two + 1e-44, "{two} and then {three}");
                }
            }
        }
    }

    #[test]
    fn the_ends_of_all_media_are_numbers() {
        for (sigma_a, sigma_s) in
            [(0.0, 1e9), (1e9, 1e9), (1e9, 1e-9), (0.0, 1e-9), (1e-9, 1e-9), (1e-9, 1.0)]
        {
            for n in [0.5, 1.0, 1.4, 3.0] {
                let medium = crate::Medium::new(sigma_a, sigma_s, n).unwrap();
                let sampler = DipoleSampler::new(&Dipole::new(&medium).unwrap());
                for xi in [f32::NAN, -1.0, 0.0, 1e-45, 1e-20, 0.5, XI_MAX, 1.0, 2.0] {
                    let r = sampler.radius_mm(xi);
                    let (pdf, cdf) = (sampler.pdf_per_mm2(r), sampler.cdf(r));
                    assert!(r.is_finite() && r >= 0.0, "{medium:?}, xi {xi}: {r} mm");
                    assert!(pdf.is_finite() && pdf > 0.0, "{medium:?}, {r} mm: {pdf}");
                    assert!((0.0..=1.0).contains(&cdf), "{medium:?}, {r} mm: {cdf}");
                }
                assert_eq!([f32::NAN, -1.0, 0.0].map(|xi| sampler.radius_mm(xi)), [0.0; 3]);
                assert_eq!(sampler.radius_mm(1.0), sampler.radius_mm(XI_MAX));
                assert_eq!(sampler.pdf_per_mm2(f32::INFINITY), 0.0);
                assert_eq!(sampler.cdf(f32::INFINITY), 1.0);
            }
        }
    }
}
