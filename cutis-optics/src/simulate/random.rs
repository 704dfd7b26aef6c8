//! Random numbers that are functions of seed, packet and how many were drawn before: SplitMix64 (Steele, Lea & Flood 2014,
//! doi:10.1145/2660193.2660195, not opened), whose state is a counter, with a stream of its own for every packet.

use core::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// The random numbers of one packet.
pub(super) struct Random {
    state: u64,
}

/// 2^64 divided by the golden ratio, odd: the counter's step.
const STEP: u64 = 0x9E37_79B9_7F4A_7C15;

impl Random {
    /// The stream of packet `number`.
    pub(super) fn new(seed: u64, number: u64) -> Self {
        // Mixed twice, so that streams of neighbouring packets and seeds start anywhere on the counter's cycle.
        Self { state: mix(mix(seed.wrapping_add(STEP)) ^ mix(number.wrapping_mul(STEP))) }
    }

    #[inline(always)]
    fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(STEP);
        mix(self.state)
    }

    /// A number in (0, 1): 52 bits, and half a step away from both ends.
    #[inline(always)]
    pub(super) fn unit(&mut self) -> f64 {
        ((self.bits() >> 12) as f64 + 0.5) * (1.0 / 4_503_599_627_370_496.0)
    }

    /// A point on the unit circle. Two bits choose the quarter and the rest the place on it: no branch to guess wrong.
    #[inline(always)]
    pub(super) fn on_circle(&mut self) -> [f64; 2] {
        let bits = self.bits();
        // From -pi/4 to pi/4.
        let angle_rad = ((bits >> 12) as f64 + 0.5) * (FRAC_PI_2 / 4_503_599_627_370_496.0) - FRAC_PI_4;
        let [cos, sin] = cos_sin_within_an_eighth(angle_rad);
        let [x, y] = if bits & 1 == 0 { [cos, sin] } else { [sin, cos] };
        if bits & 2 == 0 { [x, y] } else { [-x, -y] }
    }
}

/// Cosine and sine of an angle of at most pi/4, by Taylor's series: what is left out is below 3e-14.
#[inline(always)]
fn cos_sin_within_an_eighth(angle_rad: f64) -> [f64; 2] {
    let x2 = angle_rad * angle_rad;
    let mut cos = 1.0;
    let mut sin = 1.0;
    // Horner's scheme: each factor is 1 - x²/((n - 1) n) times what follows.
    for n in [14.0, 12.0, 10.0, 8.0, 6.0, 4.0, 2.0f64] {
        cos = 1.0 - x2 * (1.0 / ((n - 1.0) * n)) * cos;
    }
    for n in [13.0, 11.0, 9.0, 7.0, 5.0, 3.0f64] {
        sin = 1.0 - x2 * (1.0 / ((n - 1.0) * n)) * sin;
    }
    [cos, angle_rad * sin]
}

#[inline(always)]
fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::tests::chi_square_is_plausible;

    #[test]
    fn it_is_splitmix64() {
        // First outputs for state 1234567 as its reference implementation prints them.
        let mut random = Random { state: 1_234_567 };
        assert_eq!([random.bits(), random.bits()], [6_457_827_717_110_365_317, 3_203_168_211_198_807_973]);
    }

    #[test]
    fn the_circle_is_met_to_the_stated_error() {
        for i in -100..=100 {
            let angle_rad = FRAC_PI_4 * f64::from(i) / 100.0;
            let [cos, sin] = cos_sin_within_an_eighth(angle_rad);
            assert!(
                (cos - angle_rad.cos()).abs() < 3e-14 && (sin - angle_rad.sin()).abs() < 3e-14,
                "{angle_rad}"
            );
        }
    }

    #[test]
    fn units_and_angles_are_even_within_and_across_streams() {
        let bins = 64;
        let mut counts = [vec![0u64; bins], vec![0; bins], vec![0; bins]];
        for packet in 0..20_000 {
            let mut random = Random::new(7, packet);
            counts[0][(random.unit() * bins as f64) as usize] += 1;
            for _ in 0..10 {
                counts[1][(random.unit() * bins as f64) as usize] += 1;
            }
            let [x, y] = random.on_circle();
            let turn = y.atan2(x) / core::f64::consts::TAU + 0.5;
            counts[2][((turn * bins as f64) as usize).min(bins - 1)] += 1;
        }
        for counts in counts {
            chi_square_is_plausible(&counts, &vec![1.0 / bins as f64; bins]);
        }
    }
}
