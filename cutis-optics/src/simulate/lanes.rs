//! Numbers of several packets side by side: what one processor instruction takes at once, twice over.
//!
//! Eight lanes are two registers of four on processors with AVX2. Two instructions that do not wait for each other hide
//! part of their latency; [`wide`] does the same work with smaller registers elsewhere.

use wide::{f64x8, u64x8};

/// One number of each packet; a mask when it is the result of a comparison.
pub(super) type Lanes = f64x8;

/// Packets side by side.
pub(super) const LANES: usize = 8;

/// The same number in all lanes.
#[inline(always)]
pub(super) fn splat(value: f64) -> Lanes {
    Lanes::splat(value)
}

/// Numbers of the lanes whose bit is set, lowest first.
#[inline(always)]
pub(super) fn lanes_of(mut bits: u32) -> impl Iterator<Item = usize> {
    core::iter::from_fn(move || {
        let lane = bits.trailing_zeros() as usize;
        bits &= bits.wrapping_sub(1);
        (lane < LANES).then_some(lane)
    })
}

/// The mask whose lanes are those of set bits.
#[inline(always)]
pub(super) fn mask_of(bits: u32) -> Lanes {
    Lanes::new(core::array::from_fn(
        |lane| if bits >> lane & 1 == 1 { f64::from_bits(u64::MAX) } else { 0.0 },
    ))
}

/// For each lane, how many lanes before it have their bit set.
#[inline(always)]
pub(super) fn ranks_of(bits: u32) -> u64x8 {
    const RANKS: [[u8; LANES]; 1 << LANES] = {
        let mut ranks = [[0; LANES]; 1 << LANES];
        let mut bits = 0;
        while bits < ranks.len() {
            let mut lane = 1;
            while lane < LANES {
                ranks[bits][lane] = ranks[bits][lane - 1] + (bits >> (lane - 1) & 1) as u8;
                lane += 1;
            }
            bits += 1;
        }
        ranks
    };
    u64x8::new(RANKS[bits as usize & (RANKS.len() - 1)].map(u64::from))
}

/// The integer part of a number from 0 to `last`; what is below is 0, what is above is `last`.
#[inline(always)]
pub(super) fn bins(value: Lanes, last: Lanes) -> Lanes {
    value.fast_max(splat(0.0)).fast_min(last).floor()
}

/// Whole numbers below 2^32, as indices.
#[inline(always)]
pub(super) fn indices(whole: Lanes) -> [usize; LANES] {
    /// 2^52: added to a smaller whole number, that number stands in the lowest bits of the sum.
    const SHIFT: f64 = 4_503_599_627_370_496.0;
    (whole + splat(SHIFT)).to_array().map(|sum| (sum.to_bits() & 0xFFFF_FFFF) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_are_integer_parts_and_the_last_takes_the_rest() {
        let values = [-1e-18, 0.999, 1.0, 7.5, 8.0, 9.0, 1e300, f64::INFINITY];
        assert_eq!(indices(bins(Lanes::new(values), splat(8.0))), [0, 0, 1, 7, 8, 8, 8, 8]);
    }

    #[test]
    fn lanes_are_those_whose_bits_are_set() {
        assert!(lanes_of(0b1010_0001).eq([0, 5, 7]));
        assert!(lanes_of(0b1111_1111).eq(0..LANES));
        assert_eq!(lanes_of(0).count(), 0);
        (0..256).for_each(|bits| assert_eq!(mask_of(bits).to_bitmask(), bits));
    }

    #[test]
    fn ranks_count_the_bits_before() {
        for bits in 0..256u32 {
            let ranks = ranks_of(bits).to_array();
            (0..LANES).for_each(|l| assert_eq!(ranks[l], u64::from((bits & ((1 << l) - 1)).count_ones())));
        }
    }
}
