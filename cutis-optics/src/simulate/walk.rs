//! The walk of a batch of packets, as many at a time as there are lanes.
//!
//! One step is one flight of every packet, to its next collision or interface. Both ways of going on are worked out for
//! all lanes and masks choose: what happens to a packet costs no branch that a processor could guess wrong. A lane whose
//! packet has ended takes the next one of the batch at once.

use super::lanes::{Lanes, lanes_of, mask_of, ranks_of, splat};
use super::layers::{Flight, LayeredSlab};
use super::packets::{Crossing, Landing, Packets};
use super::random::{Random, unit};
use bytemuck::cast;
use core::ops::Range;
use wide::{i64x8, u64x8};

/// Chance of a packet that plays for its life.
pub(super) const SURVIVAL: f64 = 0.1;

/// What is kept of the packets' ways.
pub(super) trait Record {
    /// The packets of the lanes in the mask begin.
    fn enter(&mut self, lanes: Lanes);

    /// Packets flew; in idle lanes the weight is 0.
    fn fly(&mut self, packets: &Packets, distance_mm: Lanes);

    /// Packets lost this much where they are; nothing in lanes that did not collide.
    fn absorb(&mut self, packets: &Packets, weight: Lanes);

    /// Mask of the packets that must play for their life, or go on.
    fn light(&self, packets: &Packets) -> Lanes;

    /// A packet of this weight played; the new one is 0 if it lost.
    fn roulette(&mut self, lane: usize, weight: f64, new_weight: f64);

    /// Packets left.
    fn leave(&mut self, exits: &Exits);
}

/// How packets leave; of lanes that do not, only the weight says anything: it is 0.
pub(super) struct Exits {
    /// Mask: through the bottom.
    pub(super) downwards: Lanes,
    /// Distance from the beam, squared; infinite for light that is gone for good.
    pub(super) r2_mm2: Lanes,
    /// Cosine of the angle to the normal outside.
    pub(super) cos: Lanes,
    pub(super) weight: Lanes,
}

/// Packets on their way through a slab.
pub(super) struct Walk<'a, R> {
    flights: &'a [Flight],
    entering: f64,
    random: Random,
    packets: Packets,
    /// Mask: the lane has a packet.
    alive: Lanes,
    waiting: Range<u64>,
    record: R,
}

impl<'a, R: Record> Walk<'a, R> {
    /// Before the first step; packets enter with this weight and get their numbers from the range.
    pub(super) fn new(
        slab: &'a LayeredSlab,
        entering: f64,
        seed: u64,
        numbers: Range<u64>,
        record: R,
    ) -> Self {
        let flights = slab.flights();
        Self {
            flights,
            entering,
            random: Random::new(seed),
            packets: Packets::none(&flights[0]),
            alive: splat(0.0),
            waiting: numbers,
            record,
        }
    }

    /// Follows every packet until it has ended.
    pub(super) fn run(mut self) -> R {
        self.replace(!splat(0.0));
        while self.alive.any() {
            let ended = self.step();
            if ended.any() {
                self.replace(ended);
            }
        }
        self.record
    }

    /// One flight of all packets. Returns the mask of those that have ended.
    #[inline(always)]
    fn step(&mut self) -> Lanes {
        let [flight, turn] = core::array::from_fn(|_| self.random.bits());
        let landing = self.packets.fly(unit(flight));
        self.record.fly(&self.packets, landing.distance_mm);
        self.absorb(&landing);
        let scattered = self.packets.scattered(turn);
        let crossing = self.packets.crossing(landing.downwards, turn);
        let left = self.cross(&landing, &crossing);
        self.packets.turn(landing.collides, scattered, &crossing);
        let light = self.record.light(&self.packets) & self.alive & !left;
        if light.any() { left | self.play(light.to_bitmask()) } else { left }
    }

    #[inline(always)]
    fn absorb(&mut self, landing: &Landing) {
        let absorbed = landing.collides & (self.packets.weight * self.packets.medium.absorbed);
        self.packets.weight -= absorbed;
        self.record.absorb(&self.packets, absorbed);
    }

    /// Lets packets that met an interface and were not thrown back pass. Returns the mask of those that have left.
    #[inline(always)]
    fn cross(&mut self, landing: &Landing, crossing: &Crossing) -> Lanes {
        let [zero, one, last] = [0.0, 1.0, (self.flights.len() - 1) as f64].map(splat);
        let passes = !(landing.collides | crossing.reflects) & self.alive;
        let layer = self.packets.layer + landing.downwards.select(one, -one);
        let leaves = passes & (layer.simd_lt(zero) | layer.simd_gt(last));
        if leaves.any() {
            let [x, y, _] = self.packets.position_mm;
            let gone = landing.distance_mm.simd_ge(splat(f64::MAX));
            let r2_mm2 = gone.select(splat(f64::INFINITY), x.mul_add(x, y * y));
            let cos = crossing.cos_beyond;
            let weight = leaves & self.packets.weight;
            self.record.leave(&Exits { downwards: landing.downwards, r2_mm2, cos, weight });
        }
        let goes_on = passes & !leaves;
        if goes_on.any() {
            self.packets.layer = goes_on.bitselect(layer, self.packets.layer);
            self.packets.change_medium(goes_on.to_bitmask(), self.flights);
        }
        leaves
    }

    /// Russian roulette for the packets of some lanes. Returns the mask of those that have lost.
    #[inline(never)]
    fn play(&mut self, lanes: u32) -> Lanes {
        let mut lost = 0;
        for lane in lanes_of(lanes) {
            let weight = &mut self.packets.weight.as_mut_array()[lane];
            let survives = *weight > 0.0 && self.random.unit_of(lane) < SURVIVAL;
            let new_weight = if survives { *weight / SURVIVAL } else { 0.0 };
            self.record.roulette(lane, *weight, new_weight);
            *weight = new_weight;
            lost |= u32::from(!survives) << lane;
        }
        mask_of(lost)
    }

    /// Gives lanes whose packets have ended the next ones, as long as there are any.
    #[inline(always)]
    fn replace(&mut self, ended: Lanes) {
        let bits = ended.to_bitmask();
        let numbers = ranks_of(bits) + u64x8::splat(self.waiting.start);
        self.waiting.start += u64::from(bits.count_ones());
        let end = u64x8::splat(self.waiting.end);
        // Numbers are below 2^63, so that signed comparison is good enough, and has an instruction.
        let exists: Lanes = cast(cast::<u64x8, i64x8>(numbers).simd_lt(cast::<u64x8, i64x8>(end)));
        self.alive = (self.alive & !ended) | (ended & exists);
        self.random.begin(ended, numbers);
        self.packets.enter(ended, exists & splat(self.entering), self.flights);
        self.record.enter(ended);
    }
}
