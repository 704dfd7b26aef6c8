//! One row of texels of the next polynomial, by the links inside of charts.

use super::exchange::Exchange;
use super::row::Light;
use std::ops::Range;

/// How a polynomial follows from the two before it: so many times x of the one, less a part of the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recurrence {
    factor: f32,
    part: f32,
}

impl Recurrence {
    /// T_1 = x T_0.
    pub const FIRST: Self = Self { factor: 1.0, part: 0.0 };
    /// T_{k+1} = 2 x T_k - T_{k-1}.
    pub const LATER: Self = Self { factor: 2.0, part: 1.0 };

    /// What heat that flows to a texel, per time, is in the next polynomial, for x = 1 - 2 L/λ.
    pub fn speed(self, exchange: &Exchange) -> f32 {
        2.0 * self.factor / exchange.fastest_rate_per_mm2
    }

    fn still<L: Light>(self, now: L, before: L) -> L {
        now.times(self.factor) - before.times(self.part)
    }
}

/// Turns a row of the polynomial before into the next, of which the row `under`, `here`, and `above` are given; no edges of charts
/// are in it yet. Rows along the edges of the map need no neighbours.
pub fn turn<L: Light>(
    exchange: &Exchange,
    recurrence: Recurrence,
    y: usize,
    [under, here, above]: [&[L]; 3],
    row: &mut [L],
) {
    let size = exchange.size;
    for run in &exchange.runs[y] {
        // Inner squares link no texel along the edges of the map.
        let inner = if y == 0 || y + 1 == size {
            run.start..run.start
        } else {
            run.start.max(1)..run.end.min(size - 1)
        };
        for x in (run.start..inner.start).chain(inner.end..run.end) {
            row[x] = recurrence.still(here[x], row[x]);
        }
        if !inner.is_empty() {
            turn_inner(exchange, recurrence, y, [under, here, above], row, inner);
        }
    }
}

/// [`turn`] where texels have eight neighbours.
fn turn_inner<L: Light>(
    exchange: &Exchange,
    recurrence: Recurrence,
    y: usize,
    rows: [&[L]; 3],
    row: &mut [L],
    run: Range<usize>,
) {
    let (size, count) = (exchange.size, run.len());
    let speed = recurrence.speed(exchange);
    // All of known lengths, so that no index is checked in the loop.
    let around = run.start - 1..run.end + 1;
    let [under, here, above] = rows.map(|row| &row[around.clone()][..count + 2]);
    let links = |y: usize| &exchange.links[y * size..][around.clone()][..count + 2];
    let (own, below) = (links(y), links(y - 1));
    let inverse_areas_per_mm2 = &exchange.inverse_areas_per_mm2[y * size..][run.clone()][..count];
    let row = &mut row[run][..count];
    for x in 0..count {
        let light = here[x + 1];
        let beside = (here[x + 2] - light).times(own[x + 1][0]) + (here[x] - light).times(own[x][0]);
        let over = (above[x + 1] - light).times(own[x + 1][1])
            + (above[x + 2] - light).times(own[x + 1][2])
            + (above[x] - light).times(own[x + 1][3]);
        let under = (under[x + 1] - light).times(below[x + 1][1])
            + (under[x] - light).times(below[x][2])
            + (under[x + 2] - light).times(below[x + 2][3]);
        let flow = beside + over + under;
        // The product of both factors in 32 bits would be rounded, and the transpose only near to one.
        row[x] = recurrence.still(light, row[x]) + flow.times(inverse_areas_per_mm2[x]).times(speed);
    }
}
