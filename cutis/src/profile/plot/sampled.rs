//! Curves of a channel, sampled where there is something to see.

use crate::profile::channel::Channel;
use cutis_optics::{GaussianSum, Profile};
use rayon::prelude::*;

/// Points of a curve.
const POINTS: usize = 480;
/// r R(r) below this part of its peak is left out to the right.
const TAIL: f64 = 0.004;
/// The logarithmic panel reaches this much farther than the linear ones, …
const FARTHER: f64 = 2.5;
/// … and starts at this part of a mean free path.
const NEAR: f64 = 0.02;

/// A curve.
pub type Points = Vec<(f64, f64)>;

/// Ranges that all channels share.
pub struct Ranges {
    /// Largest radius of the linear panels, mm.
    pub r_max_mm: f64,
    /// Radii of the logarithmic panel, mm.
    pub r_log_mm: (f64, f64),
    /// Frequencies, 1/mm.
    pub k_log_per_mm: (f64, f64),
}

/// What is drawn of a channel.
pub struct Sampled {
    pub r_profile: Points,
    pub profile: Points,
    /// T(r), times r and alone; empty where nothing comes out below.
    pub r_transmittance: Points,
    pub transmittance: Points,
    pub fit: Points,
    pub gaussians: Vec<Points>,
    pub residual: Points,
    pub spectrum: Points,
    pub spectrum_of_fit: Points,
}

impl Ranges {
    pub fn of(channels: &[Channel]) -> Self {
        let farthest = |c: &Channel| farthest_mm(c.sum.sum());
        let r_max_mm = channels.iter().map(farthest).fold(0.0, f64::max);
        let finest_mm = channels.iter().map(Channel::mean_free_path_mm).fold(f64::INFINITY, f64::min);
        let near_mm = (NEAR * finest_mm).min(0.01 * r_max_mm);
        Self {
            r_max_mm,
            r_log_mm: (near_mm, FARTHER * r_max_mm),
            k_log_per_mm: (0.05 / r_max_mm, 5.0 / finest_mm),
        }
    }
}

/// Where r times the sum has fallen to a small part of its peak, mm.
fn farthest_mm(sum: &GaussianSum) -> f64 {
    let widest = sum.terms.iter().map(|g| g.variance_mm2.sqrt()).fold(0.0, f64::max);
    let radii = || (1..=400).map(|i| 8.0 * widest * f64::from(i) / 400.0);
    let peak = radii().map(|r| r * sum.at_mm(r)).fold(0.0, f64::max);
    radii().filter(|&r| r * sum.at_mm(r) > TAIL * peak).fold(widest, f64::max)
}

impl Sampled {
    pub fn new(channel: &Channel, ranges: &Ranges) -> Self {
        let (profile, sum) = (&channel.profile, channel.sum.sum());
        let linear = linear(ranges.r_max_mm);
        let logarithmic = logarithmic(ranges.r_log_mm);
        let waves = self::logarithmic(ranges.k_log_per_mm);
        let at = |radii: &[f64]| -> Vec<f64> { radii.par_iter().map(|&r| profile.at_mm(r)).collect() };
        let exact = at(&linear);
        let below = |radii: &[f64]| -> Points {
            let transmitted = channel.transmitted.as_ref();
            transmitted.map_or_else(Vec::new, |t| radii.par_iter().map(|&r| (r, t.at_mm(r))).collect())
        };
        let curve = |x: &[f64], f: &dyn Fn(f64) -> f64| -> Points { x.iter().map(|&x| (x, f(x))).collect() };
        let pairs = || linear.iter().zip(&exact);
        Self {
            r_profile: pairs().map(|(&r, p)| (r, r * p)).collect(),
            residual: pairs().map(|(&r, p)| (r, r * (p - sum.at_mm(r)))).collect(),
            r_transmittance: below(&linear).into_iter().map(|(r, t)| (r, r * t)).collect(),
            transmittance: below(&logarithmic),
            profile: logarithmic.iter().copied().zip(at(&logarithmic)).collect(),
            fit: curve(&logarithmic, &|r| sum.at_mm(r)),
            gaussians: sum.terms.iter().map(|g| curve(&logarithmic, &|r| g.at_mm(r))).collect(),
            spectrum: curve(&waves, &|k| profile.spectrum(k)),
            spectrum_of_fit: curve(&waves, &|k| sum.spectrum(k)),
        }
    }
}

/// Radii from just above 0, where profiles may be infinite.
fn linear(max: f64) -> Vec<f64> {
    (1..=POINTS).map(|i| max * (i as f64 - 0.5) / (POINTS as f64 - 0.5)).collect()
}

fn logarithmic((from, to): (f64, f64)) -> Vec<f64> {
    let ratio = (to / from).ln();
    (0..=POINTS).map(|i| from * (ratio * i as f64 / POINTS as f64).exp()).collect()
}

/// Largest value of some curves.
pub fn highest<'a>(curves: impl Iterator<Item = &'a Points>) -> f64 {
    curves.flatten().map(|p| p.1).filter(|y| y.is_finite()).fold(0.0, f64::max)
}

/// Largest absolute value of some curves.
pub fn largest_deviation<'a>(curves: impl Iterator<Item = &'a Points>) -> f64 {
    curves.flatten().map(|p| p.1.abs()).filter(|y| y.is_finite()).fold(0.0, f64::max)
}
