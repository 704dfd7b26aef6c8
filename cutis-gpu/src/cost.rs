//! What a frame moves through the memory of a graphics processor, and how long that takes at least.
//!
//! Every step is taken to read all that it binds once and to write its targets once: caches keep what neighbours share, and
//! what a step leaves out (tiles without a chart, opaque places, the picture's background) counts all the same. A frame
//! takes longer where a pass is bound by its reads of textures, of which there are [`Cost::taps`], or by too little work for
//! all units.

use crate::step::{Dispatch, Draw, Step};

/// The least that a step costs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cost {
    /// Name of the pass it belongs to.
    pub pass: &'static str,
    /// Bytes that are read.
    pub read_bytes: u64,
    /// Bytes that are written.
    pub written_bytes: u64,
    /// Reads of textures, by [`TAPS`].
    pub taps: u64,
}

/// Reads of textures by one invocation of every entry point but those of vertices, counted in its source: one light, as many
/// Gaussians as skin has at a size, loops as long as for most texels, the default bloom of 1080 rows.
pub const TAPS: [(&str, u64); 41] = [
    ("deform_vertices", 0),
    ("stretch_at_vertices", 0),
    ("unroll", 2),
    ("map_surface", 0),
    ("map_entry", 5),
    ("map_next", 1),
    ("look_around", 112),
    ("smooth_openness", 51),
    ("see_lights", 96),
    ("see_sharp_lights", 12),
    ("count_places", 29),
    ("light_texel", 19),
    ("share_lights", 6),
    ("lay_taps", 15),
    ("blur", 11),
    ("halve", 9),
    ("exchange", 17),
    ("exchange_alone", 12),
    ("add_up", 7),
    ("halve_heat", 32),
    ("keep_padding", 8),
    ("edge_exchange", 31),
    ("show_point", 0),
    ("begin_blur", 11),
    ("blur_seven", 17),
    ("come_through", 13),
    ("gather", 40),
    ("mark_thin", 176),
    ("transmit", 130),
    ("smooth_map", 51),
    ("shade", 36),
    ("show", 44),
    ("light_image", 26),
    ("sample_profile", 82),
    ("see_sky", 1),
    ("downsample", 4),
    ("reduce", 4),
    ("blur_along_rows", 89),
    ("blur_along_columns", 89),
    ("develop", 1),
    ("develop_with_glow", 2),
];

/// Reads of textures by one invocation of an entry point.
pub(crate) fn taps_of(entry: &str) -> u64 {
    TAPS.iter().find(|(name, _)| *name == entry).map_or(0, |(_, taps)| *taps)
}

impl Cost {
    /// Of one step.
    pub fn of(step: &Step) -> Self {
        match step {
            Step::Draw(draw) => of_draw(draw),
            Step::Compute(dispatch) => of_dispatch(dispatch),
        }
    }

    /// Time that a memory takes for it, in milliseconds, if it moves so many gigabytes (10⁹ bytes) in a second.
    pub fn milliseconds(&self, gigabytes_per_s: f64) -> f64 {
        (self.read_bytes + self.written_bytes) as f64 / (gigabytes_per_s * 1e6)
    }

    fn plus(self, other: Self) -> Self {
        Self {
            pass: self.pass,
            read_bytes: self.read_bytes + other.read_bytes,
            written_bytes: self.written_bytes + other.written_bytes,
            taps: self.taps + other.taps,
        }
    }
}

fn of_draw(draw: &Draw) -> Cost {
    let targets: u64 = draw.targets.iter().map(|view| view.bytes()).sum();
    let depth = draw.depth.as_ref().map_or(0, |(view, _)| view.bytes());
    let depth_kept = draw.depth.as_ref().is_some_and(|(_, clear)| !clear);
    let blended = draw.pipeline.additive && draw.clear.is_none();
    let bound: u64 = draw.bind_groups.iter().map(|group| group.bytes).sum();
    let fragments = draw.targets.first().map_or(0, |view| view.texels);
    Cost {
        pass: draw.pipeline.name,
        read_bytes: bound + if depth_kept { depth } else { 0 } + if blended { targets } else { 0 },
        written_bytes: targets + depth,
        taps: fragments * draw.pipeline.taps,
    }
}

/// Buffers that are written are among those that are bound.
fn of_dispatch(dispatch: &Dispatch) -> Cost {
    Cost { pass: dispatch.pipeline.name, read_bytes: dispatch.bind_group.bytes, written_bytes: 0, taps: 0 }
}

/// Costs added up pass by pass, in the order in which passes first come.
pub fn by_pass(costs: &[Cost]) -> Vec<Cost> {
    let mut passes: Vec<Cost> = Vec::new();
    for &cost in costs {
        match passes.iter_mut().find(|pass| pass.pass == cost.pass) {
            Some(pass) => *pass = pass.plus(cost),
            None => passes.push(cost),
        }
    }
    passes
}

/// All costs added up.
pub fn total(costs: &[Cost]) -> Cost {
    let nothing = Cost { pass: "total", read_bytes: 0, written_bytes: 0, taps: 0 };
    costs.iter().fold(nothing, |sum, &cost| sum.plus(cost))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_are_added_up_pass_by_pass() {
        let cost = |pass, n| Cost { pass, read_bytes: n, written_bytes: 2 * n, taps: 3 * n };
        let all = [cost("blur", 1), cost("gather", 10), cost("blur", 5)];
        assert_eq!(by_pass(&all), [cost("blur", 6), cost("gather", 10)]);
        assert_eq!(total(&all), cost("total", 16));
    }

    #[test]
    fn a_terabyte_a_second_moves_a_gigabyte_in_a_millisecond() {
        let cost = Cost { pass: "all", read_bytes: 600_000_000, written_bytes: 400_000_000, taps: 0 };
        assert!((cost.milliseconds(1000.0) - 1.0).abs() < 1e-12);
    }
}
