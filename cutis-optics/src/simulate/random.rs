//! Random numbers that are functions of seed, packet and how many were drawn before: SplitMix64 (Steele, Lea & Flood 2014,
//! doi:10.1145/2660193.2660195, not opened), whose state is a counter, with a stream of its own for every packet.

use super::lanes::{LANES, Lanes, splat};
use bytemuck::cast;
use core::f64::consts::{FRAC_PI_2, FRAC_PI_4};
use wide::{i64x8, u64x8};

/// 2^64 divided by the golden ratio, odd: the counter's step.
const STEP: u64 = 0x9E37_79B9_7F4A_7C15;

/// The random numbers of the packets in all lanes.
pub(super) struct Random {
    seed: u64,
    state: u64x8,
}

impl Random {
    /// Streams that [`Random::begin`] has not chosen yet.
    pub(super) fn new(seed: u64) -> Self {
        Self { seed: mix(seed.wrapping_add(STEP)), state: u64x8::splat(0) }
    }

    /// Gives the lanes of the mask the streams of packets with these numbers.
    #[inline(always)]
    pub(super) fn begin(&mut self, lanes: Lanes, numbers: u64x8) {
        // Mixed, so that streams of neighbouring packets and seeds start anywhere on the counter's cycle.
        let start = mix_lanes(u64x8::splat(self.seed) ^ times(numbers, STEP));
        self.state = cast::<Lanes, u64x8>(lanes).bitselect(start, self.state);
    }

    /// The next 64 bits of every lane.
    #[inline(always)]
    pub(super) fn bits(&mut self) -> u64x8 {
        self.state += u64x8::splat(STEP);
        mix_lanes(self.state)
    }

    /// A number in (0, 1) for one lane only.
    #[inline(always)]
    pub(super) fn unit_of(&mut self, lane: usize) -> f64 {
        let state = &mut self.state.as_mut_array()[lane];
        *state = state.wrapping_add(STEP);
        ((mix(*state) >> 12) as f64 + 0.5) * (1.0 / 4_503_599_627_370_496.0)
    }
}

/// Numbers in (0, 1): 52 bits, and half a step away from both ends.
#[inline(always)]
pub(super) fn unit(bits: u64x8) -> Lanes {
    // The bits become the fraction of a number in [1, 2); less 1, plus half a step of 2^-52: no digit is lost.
    const ONE: u64 = 0x3FF0_0000_0000_0000;
    const ONE_LESS_HALF_A_STEP: f64 = 1.0 - 0.5 * f64::EPSILON;
    cast::<u64x8, Lanes>((bits >> 12) | u64x8::splat(ONE)) - splat(ONE_LESS_HALF_A_STEP)
}

/// Numbers in (0, 1) from the upper half of the bits, half a step of 2^-32 away from both ends.
#[inline(always)]
pub(super) fn half_unit(bits: u64x8) -> Lanes {
    whole_and_a_half(bits >> 32) * splat(1.0 / 4_294_967_296.0)
}

/// Points on the unit circle, from the lower half of the bits, so that one draw gives both angles of a turn: two choose
/// the quarter and the rest the place on it, to 1.5e-9 rad. No branch to guess wrong.
#[inline(always)]
pub(super) fn on_circle(bits: u64x8) -> [Lanes; 2] {
    const STEP_RAD: f64 = FRAC_PI_2 / 1_073_741_824.0;
    // From -pi/4 to pi/4.
    let place = whole_and_a_half((bits & u64x8::splat(0xFFFF_FFFF)) >> 2);
    let angle_rad = place.mul_sub(splat(STEP_RAD), splat(FRAC_PI_4));
    let [cos, sin] = cos_sin_within_an_eighth(angle_rad);
    let zero = i64x8::splat(0);
    let swap: Lanes = cast(cast::<u64x8, i64x8>(bits << 63).simd_lt(zero));
    let sign: Lanes = cast((bits << 62) & u64x8::splat(1 << 63));
    [swap.select(sin, cos) ^ sign, swap.select(cos, sin) ^ sign]
}

/// Half more than whole numbers below 2^52.
#[inline(always)]
fn whole_and_a_half(whole: u64x8) -> Lanes {
    // The bits of 2^52, to which a smaller whole number is added by writing it into the lowest bits.
    const SHIFT: f64 = 4_503_599_627_370_496.0;
    cast::<u64x8, Lanes>(whole | u64x8::splat(SHIFT.to_bits())) - splat(SHIFT - 0.5)
}

/// Cosine and sine of an angle of at most pi/4, by Taylor's series: what is left out is below 3e-14.
#[inline(always)]
fn cos_sin_within_an_eighth(angle_rad: Lanes) -> [Lanes; 2] {
    /// 1/n! with the signs of the series, highest power first.
    const COS: [f64; 8] = [
        -1.0 / 87_178_291_200.0,
        1.0 / 479_001_600.0,
        -1.0 / 3_628_800.0,
        1.0 / 40_320.0,
        -1.0 / 720.0,
        1.0 / 24.0,
        -0.5,
        1.0,
    ];
    const SIN: [f64; 7] = [
        1.0 / 6_227_020_800.0,
        -1.0 / 39_916_800.0,
        1.0 / 362_880.0,
        -1.0 / 5_040.0,
        1.0 / 120.0,
        -1.0 / 6.0,
        1.0,
    ];
    let x2 = angle_rad * angle_rad;
    let horner =
        |series: &[f64]| series[1..].iter().fold(splat(series[0]), |sum, &next| sum.mul_add(x2, splat(next)));
    [horner(&COS), angle_rad * horner(&SIN)]
}

#[inline(always)]
fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[inline(always)]
fn mix_lanes(mut z: u64x8) -> u64x8 {
    z = times(z ^ (z >> 30), 0xBF58_476D_1CE4_E5B9);
    z = times(z ^ (z >> 27), 0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// The product modulo 2^64, lane by lane.
#[inline(always)]
fn times(a: u64x8, b: u64) -> u64x8 {
    let a = a.to_array();
    u64x8::new(core::array::from_fn::<u64, LANES, _>(|i| a[i].wrapping_mul(b)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::chi_square_is_plausible;
    use crate::simulate::lanes::{mask_of, ranks_of};

    #[test]
    fn it_is_splitmix64() {
        // First outputs for state 1234567 as its reference implementation prints them.
        let outputs = [6_457_827_717_110_365_317u64, 3_203_168_211_198_807_973];
        let mut random = Random { seed: 0, state: u64x8::splat(1_234_567) };
        assert_eq!([random.bits(), random.bits()].map(|b| b.to_array()), outputs.map(|o| [o; LANES]));
        let mut random = Random { seed: 0, state: u64x8::splat(1_234_567) };
        for output in outputs {
            assert_eq!(random.unit_of(3), unit(u64x8::splat(output)).to_array()[0]);
        }
    }

    /// Streams of eight packets in a row.
    fn row(seed: u64, first: u64) -> Random {
        let mut random = Random::new(seed);
        random.begin(mask_of(0xFF), ranks_of(0xFF) + u64x8::splat(first));
        random
    }

    #[test]
    fn lanes_draw_what_their_packet_draws_alone() {
        let mut many = row(9, 100);
        let drawn = [many.bits(), many.bits()].map(|b| b.to_array());
        for lane in 0..LANES {
            // Packets begin in lane 5, and the other lanes go on with what they had.
            let mut one = row(9, 100);
            one.begin(mask_of(1 << 5), u64x8::splat(100 + lane as u64));
            let again = [one.bits(), one.bits()].map(|b| b.to_array());
            for (drawn, again) in drawn.iter().zip(&again) {
                assert_eq!([drawn[lane], drawn[2]], [again[5], again[2]], "lane {lane}");
            }
        }
    }

    #[test]
    fn units_stay_off_both_ends() {
        let ends = unit(u64x8::new([0, u64::MAX, 1 << 12, 0, 0, 0, 0, 0])).to_array();
        assert_eq!(ends[..3], [0.5 * f64::EPSILON, 1.0 - 0.5 * f64::EPSILON, 1.5 * f64::EPSILON]);
    }

    #[test]
    fn the_circle_is_met_to_the_stated_error() {
        for i in -100..=100 {
            let angle_rad = FRAC_PI_4 * f64::from(i) / 100.0;
            let [cos, sin] = cos_sin_within_an_eighth(splat(angle_rad)).map(|v| v.to_array()[0]);
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
        let bin = |share: f64| ((share * bins as f64) as usize).min(bins - 1);
        for packets in 0..2_500 {
            let mut random = row(7, packets * LANES as u64);
            unit(random.bits()).to_array().iter().for_each(|&u| counts[0][bin(u)] += 1);
            for _ in 0..10 {
                unit(random.bits()).to_array().iter().for_each(|&u| counts[1][bin(u)] += 1);
            }
            let [x, y] = on_circle(random.bits()).map(Lanes::to_array);
            for lane in 0..LANES {
                counts[2][bin(y[lane].atan2(x[lane]) / core::f64::consts::TAU + 0.5)] += 1;
            }
        }
        for counts in counts {
            chi_square_is_plausible(&counts, &vec![1.0 / bins as f64; bins]);
        }
    }
}
