//! Random numbers of one path: SplitMix64 (Steele, Lea & Flood 2014, doi:10.1145/2660193.2660195, not opened), whose state
//! is a counter. Where it starts depends on the seed and the path alone, so that any thread may walk any path.

use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// 2^64 divided by the golden ratio, odd: the counter's step.
const STEP: u64 = 0x9E37_79B9_7F4A_7C15;
/// What times the step is 1, modulo 2^64: how often the counter went on is its way times this.
const PER_STEP: u64 = 0xF1DE_83E1_9937_733D;

/// The random numbers of one path.
#[derive(Debug, Clone)]
pub struct Random {
    state: u64,
}

impl Random {
    /// The stream of a path (`sample` of a pixel, texel or packet numbered `place`).
    pub fn new(seed: u64, place: u64, sample: u64) -> Self {
        let mixed = mix(mix(seed.wrapping_add(STEP)) ^ place.wrapping_mul(STEP));
        Self { state: mix(mixed ^ sample.wrapping_add(1).wrapping_mul(STEP)) }
    }

    /// How many numbers were drawn since `begin`, a state of the same stream: what work the path was, whatever the machine.
    pub fn drawn_since(&self, begin: &Self) -> u64 {
        self.state.wrapping_sub(begin.state).wrapping_mul(PER_STEP)
    }

    fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(STEP);
        mix(self.state)
    }

    /// A number in (0, 1): 52 bits, and half a step away from both ends.
    pub fn unit(&mut self) -> f64 {
        ((self.bits() >> 12) as f64 + 0.5) * (1.0 / 4_503_599_627_370_496.0)
    }

    /// A number from 0 to `count - 1`.
    pub fn below(&mut self, count: usize) -> usize {
        ((self.unit() * count as f64) as usize).min(count - 1)
    }

    /// Two independent numbers with density e^(-x²)/sqrt(pi) each: normal, of variance 1/2 (Box & Muller 1958).
    pub fn gaussian_pair(&mut self) -> DVec2 {
        let radius = (-self.unit().ln()).sqrt();
        DVec2::from_angle(TAU * self.unit()) * radius
    }

    /// Any direction, all equally likely.
    pub fn direction(&mut self) -> DVec3 {
        let z = 1.0 - 2.0 * self.unit();
        let around = DVec2::from_angle(TAU * self.unit()) * (1.0 - z * z).max(0.0).sqrt();
        around.extend(z)
    }

    /// A direction around +z with density cos / pi.
    pub fn cosine_hemisphere(&mut self) -> DVec3 {
        let radius2 = self.unit();
        let around = DVec2::from_angle(2.0 * PI * self.unit()) * radius2.sqrt();
        around.extend((1.0 - radius2).sqrt())
    }
}

fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_splitmix64() {
        // First outputs for state 1234567 as its reference implementation prints them.
        let mut random = Random { state: 1_234_567 };
        assert_eq!([random.bits(), random.bits()], [6_457_827_717_110_365_317, 3_203_168_211_198_807_973]);
    }

    #[test]
    fn numbers_drawn_are_counted() {
        let begin = Random::new(1, 2, 3);
        let mut random = begin.clone();
        for _ in 0..1000 {
            random.unit();
        }
        random.direction();
        assert_eq!(random.drawn_since(&begin), 1002);
    }

    #[test]
    fn neighbouring_streams_are_unlike() {
        // The correlation of n pairs has a standard error of 1/sqrt(n): 5 of them fail once in 2 million runs.
        let n = 10_000;
        let pair = |i: u64, other: fn(u64) -> [u64; 3]| {
            let [seed, place, sample] = other(i);
            (Random::new(7, i, 0).unit() - 0.5, Random::new(seed, place, sample).unit() - 0.5)
        };
        let others: [fn(u64) -> [u64; 3]; 3] = [|i| [8, i, 0], |i| [7, i + 1, 0], |i| [7, i, 1]];
        for other in others {
            let correlation: f64 =
                (0..n).map(|i| pair(i, other)).map(|(a, b)| 12.0 * a * b).sum::<f64>() / n as f64;
            assert!(correlation.abs() < 5.0 / (n as f64).sqrt(), "{correlation}");
        }
    }

    #[test]
    fn directions_and_gaussians_have_their_moments() {
        let mut random = Random::new(1, 2, 3);
        let n = 40_000;
        let (mut even, mut cosine, mut normal) = (DVec3::ZERO, DVec3::ZERO, DVec2::ZERO);
        for _ in 0..n {
            let d = random.direction();
            even += d * d;
            cosine += random.cosine_hemisphere();
            let g = random.gaussian_pair();
            normal += g * g;
        }
        // Standard errors of the means: 0.3, 0.5 and 0.71 at most over sqrt(n) = 200; five of them.
        assert!((even / f64::from(n) - DVec3::splat(1.0 / 3.0)).abs().max_element() < 7.5e-3);
        assert!((cosine / f64::from(n) - DVec3::new(0.0, 0.0, 2.0 / 3.0)).abs().max_element() < 1.25e-2);
        assert!((normal / f64::from(n) - DVec2::splat(0.5)).abs().max_element() < 1.8e-2);
    }
}
