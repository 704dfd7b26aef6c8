//! What the texels around charts hold, for those who read there: values by which both sides of a seam show the same light.
//!
//! To begin with a texel of the padding reads what lies across the seam. Bilinear reads from both sides then nearly meet; texels of
//! the padding, which no heat flows through, are moved until they do (Kaczmarz 1937, place by place along the seams). Both
//! sides give way alike: by their texels' size, finer sides would be truer near coarse ones, and seams show three times as much.

use super::seam_edges::{SeamEdge, seam_edges};
use super::shore::{Read, Shore};
use cutis_scene::Object;
use glam::Vec2;
use rayon::prelude::*;
use std::collections::HashMap;

/// Rounds over all places.
const ROUNDS: usize = 5;
/// Places along a seam per texel.
const PLACES_PER_TEXEL: f32 = 3.0;
/// Reluctance to be moved for a place: where three charts meet, texels that hardly show would else be moved by many times what they
/// differ.
const RELUCTANCE: f32 = 0.5;
/// Weights below this are left out.
const NEGLIGIBLE: f32 = 1e-3;

/// What a bilinear read takes at a place of a seam, from one side.
type Seen = Vec<Part>;

/// A texel in such a read.
struct Part {
    texel: u32,
    weight: f32,
    /// Its number, if it is one of the padding.
    padding: Option<usize>,
}

/// Texels of the padding and what they read.
pub fn padding(object: &Object, shore: &Shore) -> Vec<(u32, Read)> {
    let mut all = shore.padding();
    let numbers: HashMap<u32, usize> = (0..).zip(&all).map(|(n, (texel, _))| (*texel, n)).collect();
    let places: Vec<[Seen; 2]> = seam_edges(&shore.ground)
        .par_iter()
        .flat_map_iter(|edge| along_edge(object, shore, &numbers, edge))
        .collect();
    for _ in 0..ROUNDS {
        places.iter().for_each(|sides| meet(&mut all, sides));
    }
    all
}

/// Places along a seam from both sides.
fn along_edge(
    object: &Object,
    shore: &Shore,
    numbers: &HashMap<u32, usize>,
    edge: &SeamEdge,
) -> Vec<[Seen; 2]> {
    let charts = edge.sides.map(|(triangle, _)| object.charts.of_triangle[triangle as usize]);
    let part = |(texel, weight): (u32, f32)| Part { texel, weight, padding: numbers.get(&texel).copied() };
    let from = |place: Vec2, chart: u32| shore.seen_at(place, chart).into_iter().map(part).collect::<Seen>();
    let places = edge.places(edge.place_count(PLACES_PER_TEXEL, shore.size()));
    let seen = places.map(|[here, beyond]| [from(here, charts[0]), from(beyond, charts[1])]);
    seen.filter(|sides| sides.iter().all(|side| !side.is_empty())).collect()
}

/// Moves the padding so that one place looks the same from both sides.
fn meet(all: &mut [(u32, Read)], sides: &[Seen; 2]) {
    let mut apart = Read::new();
    let mut give = RELUCTANCE;
    for (side, sign) in sides.iter().zip([1.0, -1.0]) {
        for &Part { texel, weight, padding } in side {
            if let Some(n) = padding {
                all[n].1.iter().for_each(|&(own, part)| add(&mut apart, own, sign * weight * part));
                give += weight * weight;
            } else {
                add(&mut apart, texel, sign * weight);
            }
        }
    }
    for (side, sign) in sides.iter().zip([1.0, -1.0]) {
        for &Part { weight, padding, .. } in side {
            let Some(n) = padding else { continue };
            let (read, by) = (&mut all[n].1, -sign * weight / give);
            for &(own, part) in apart.iter().filter(|(_, part)| part.abs() > NEGLIGIBLE) {
                add(read, own, by * part);
            }
            // Even light stays even.
            let sum: f32 = read.iter().map(|(_, part)| part).sum();
            read.iter_mut().for_each(|(_, part)| *part /= sum);
        }
    }
}

fn add(read: &mut Read, texel: u32, weight: f32) {
    match read.iter_mut().find(|(known, _)| *known == texel) {
        Some((_, sum)) => *sum += weight,
        None => read.push((texel, weight)),
    }
}
