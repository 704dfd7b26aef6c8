//! Paths from the texels.

use super::Estimator;
use crate::passes::atlas::{Atlas, TexelSurface};
use crate::transport::estimate::Estimate;
use crate::transport::exitance::of_place;
use crate::transport::path::Transport;
use crate::transport::random::Random;
use cutis_scene::solids::Meeting;
use glam::DVec3;
use rayon::prelude::*;

/// Least weight of a corner where paths start.
const OFF_EDGE: f64 = 1e-3;

/// Where a path starts: on which triangle, and the place, mm.
type Place = (Meeting, DVec3);

/// Paths from the middle of each texel.
pub(super) struct FromTexels<'a, 'b> {
    transport: &'b Transport<'a>,
    places: Vec<Option<Place>>,
    estimates: Vec<Estimate>,
    seed: u64,
}

impl<'a, 'b> FromTexels<'a, 'b> {
    pub(super) fn new(transport: &'b Transport<'a>, atlas: &Atlas, seed: u64) -> Self {
        let place = |surface: &TexelSurface| {
            let weights = onto_triangle([f64::from(surface.b1), f64::from(surface.b2)]);
            transport.solids.place_on(0, surface.triangle, weights)
        };
        let places: Vec<_> = atlas.surface.iter().map(place).collect();
        Self { transport, estimates: vec![Estimate::default(); places.len()], places, seed }
    }
}

impl Estimator for FromTexels<'_, '_> {
    fn add(&mut self, first: u64, count: u64) -> u64 {
        let Self { transport, places, estimates, seed } = self;
        let texels = estimates.par_iter_mut().with_min_len(16).zip(places).enumerate();
        let add_to = |(texel, (estimate, place)): (usize, (&mut Estimate, &mut Option<Place>))| {
            let Some((meeting, place_mm)) = place else { return 0 };
            let one = |sample| {
                let mut random = Random::new(*seed, texel as u64, sample);
                let begin = random.clone();
                estimate.add(of_place(transport, *meeting, *place_mm, &mut random));
                random.drawn_since(&begin)
            };
            (first..first + count).map(one).sum()
        };
        texels.map(add_to).sum()
    }

    fn texel(&self, texel: usize) -> (DVec3, DVec3) {
        match self.places[texel] {
            Some(_) => (self.estimates[texel].mean(), self.estimates[texel].standard_error()),
            None => (DVec3::ZERO, DVec3::ZERO),
        }
    }

    fn state(&self) -> Vec<u8> {
        bytemuck::cast_slice(&self.estimates).to_vec()
    }

    fn restore(&mut self, _samples: u64, state: &[u8]) {
        bytemuck::cast_slice_mut(&mut self.estimates).copy_from_slice(state);
    }
}

/// The nearest weights within the triangle, a hair away from its edges: a texel at the border of a chart may have its middle
/// beside the surface, and a path that starts on an edge may miss the triangle beyond it.
fn onto_triangle([b1, b2]: [f64; 2]) -> [f64; 2] {
    let weights = [1.0 - b1 - b2, b1, b2].map(|weight| weight.max(OFF_EDGE));
    let sum: f64 = weights.iter().sum();
    [weights[1] / sum, weights[2] / sum]
}
