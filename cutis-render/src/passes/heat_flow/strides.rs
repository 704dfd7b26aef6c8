//! Across slivers heat takes longer steps.
//!
//! From one narrow texel to the next heat may flow no faster than between usual ones, or they would set the pace for all: what is
//! more is held back ([`Metric::cut`]). A step over several of them has the same slopes and a smaller rate, by the square of its
//! length. So what is held back flows from every narrow texel to a place about as far away as usual texels are from each other, in
//! the direction in which texels are narrow, across seams, too.

use super::elements::Element;
use super::metric::{Metric, SMALLEST, conductivity, derivatives_mm_per_texel};
use super::shore::{Read, Shore, centre};
use super::walk::Arrival;
use crate::passes::atlas::{TexelSurface, barycentric, inside};
use cutis_scene::Object;
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Texels narrower than this part of the usual one take longer steps, …
const NARROW: f32 = 0.3;
/// … by so many usual ones …
const STRIDE: f32 = 1.6;
/// … or this many times that, where texels differ, …
const ABOUT: std::ops::Range<f32> = 0.75..1.5;
/// … found within so many tries.
const TRIES: usize = 6;
/// One of so many texels takes them, for all.
const EVERY: usize = 2;
/// Most texels of a first try.
const MOST_TEXELS: f32 = 128.0;
/// Weight below which a texel is left out of a read, unless none has more: it would cost as much as others.
const NEGLIGIBLE: f32 = 0.3;
/// Part of the fastest rate that steps may take: each links its texel, and is read by others. The other half of that rate is for what
/// flows from texel to texel.
const BUDGET: f32 = 0.5;

/// A longer step.
#[derive(Debug, Clone)]
pub struct Stride {
    texel: u32,
    from: TexelSurface,
    to: TexelSurface,
    /// What is read there.
    read: Read,
    /// How much better heat flows here than by the medium.
    conductivity: f32,
}

/// Whether a triangle's texels are narrow in the pose of the object, for all triangles.
pub fn narrow(object: &Object, size: usize, texel_mm: f32) -> Vec<bool> {
    let is_narrow = |t: usize| {
        let metric = derivatives_mm_per_texel(object, t, size).map(Metric::new);
        metric.is_some_and(|metric| metric.narrowest_mm() < NARROW * texel_mm)
    };
    (0..object.mesh.triangles.len()).into_par_iter().map(is_narrow).collect()
}

/// Steps ahead from all texels on narrow triangles, and back where none comes from there, so that everywhere as many lead over every
/// line across.
pub fn strides(object: &Object, shore: &Shore, narrow: &[bool], texel_mm: f32) -> Vec<Stride> {
    let is_narrow = |i: &usize| shore.own[*i] && narrow[shore.atlas.surface[*i].triangle as usize];
    // Between them heat goes from texel to texel.
    let every_other = |i: &usize| (i % shore.size() + i / shore.size()).is_multiple_of(EVERY);
    let from = |i: usize| {
        let across = |triangle: u32| across(object, triangle, shore.size(), texel_mm);
        let own = across(shore.atlas.surface[i].triangle);
        let comes = |back: &Stride| {
            let there = across(back.to.triangle).filter(|_| narrow[back.to.triangle as usize]);
            own.zip(there).is_some_and(|((_, own_mm), (_, there_mm))| own_mm.dot(there_mm) > 0.0)
        };
        let step = |sign: f32| stride(object, shore, i, sign * own?.0, texel_mm);
        step(1.0).into_iter().chain(step(-1.0).filter(|back| !comes(back)))
    };
    (0..shore.own.len()).into_par_iter().filter(every_other).filter(is_narrow).flat_map_iter(from).collect()
}

/// A step across the narrow texels of a triangle, in texels, and where that leads, in mm.
fn across(object: &Object, triangle: u32, size: usize, texel_mm: f32) -> Option<(Vec2, Vec3)> {
    let [xu, xv] = derivatives_mm_per_texel(object, triangle as usize, size)?;
    let metric = Metric::new([xu, xv]);
    let texels = (STRIDE * texel_mm / metric.narrowest_mm()).min(MOST_TEXELS);
    let step = metric.narrow_direction() * texels;
    Some((step, xu * step.x + xv * step.y))
}

/// A step from a texel; none beyond open borders.
fn stride(object: &Object, shore: &Shore, texel: usize, step: Vec2, texel_mm: f32) -> Option<Stride> {
    let (arrival, to) = landing(object, shore, texel, step, texel_mm)?;
    let conductivity = conductivity(object, shore.atlas.map_uv_under(object, texel)?);
    let read = without_negligible(shore.read(&arrival)?);
    Some(Stride { texel: texel as u32, from: shore.atlas.surface[texel], to, read, conductivity })
}

/// Where a step from a texel leads, made longer or shorter until it is about as long as it should be.
fn landing(
    object: &Object,
    shore: &Shore,
    texel: usize,
    step: Vec2,
    texel_mm: f32,
) -> Option<(Arrival, TexelSurface)> {
    let size = shore.size();
    let from = shore.atlas.surface[texel];
    let (mut part, mut too_short, mut too_long) = (1.0, 0.0, f32::INFINITY);
    let mut best: Option<(f32, Arrival, TexelSurface)> = None;
    for _ in 0..TRIES {
        let arrival = shore.ground.walk(from.triangle, centre(texel, size), onto_the_grid(step * part));
        let corners = object.mesh.corner_atlas_uvs(arrival.triangle as usize);
        let [b1, b2] = inside(barycentric(corners, arrival.place / size as f32));
        let to = TexelSurface { triangle: arrival.triangle, b1, b2 };
        let length = place_mm(object, from).distance(place_mm(object, to)) / (STRIDE * texel_mm);
        let off = length.max(f32::MIN_POSITIVE).ln().abs();
        if !arrival.at_border && best.is_none_or(|(least, ..)| off < least) {
            best = Some((off, arrival, to));
        }
        if ABOUT.contains(&length) {
            break;
        }
        let end = if length < ABOUT.start && !arrival.at_border { &mut too_short } else { &mut too_long };
        *end = part;
        part =
            if too_long.is_finite() { 0.5 * (too_short + too_long) } else { (part / length).min(3.0 * part) };
    }
    best.map(|(_, arrival, to)| (arrival, to))
}

/// A read of its larger weights, which sum to 1 again.
fn without_negligible(mut read: Read) -> Read {
    let most = read.iter().map(|(_, weight)| *weight).fold(0.0, f32::max);
    read.retain(|(_, weight)| *weight >= NEGLIGIBLE.min(most));
    let sum: f32 = read.iter().map(|(_, weight)| weight).sum();
    read.iter_mut().for_each(|(_, weight)| *weight /= sum);
    read
}

/// The step as much longer or shorter as it takes to reach a row or a column of texels' centres: two texels are read there, not four.
fn onto_the_grid(step: Vec2) -> Vec2 {
    let longer = step.abs().max_element();
    step * (longer.round().max(1.0) / longer)
}

fn place_mm(object: &Object, at: TexelSurface) -> Vec3 {
    object.surface_point(at.triangle, at.b1, at.b2).position_mm
}

impl Stride {
    /// What it links in the pose of an object, by the areas of texels.
    pub fn element(&self, object: &Object, size: usize, texel_mm: f32, areas_mm2: &[f32]) -> Element {
        let area_mm2 = areas_mm2[self.texel as usize];
        // What a texel can bear, by the part of the step that it has.
        let bearable_mm2 = self.read.iter().map(|&(i, weight)| areas_mm2[i as usize] / weight);
        let least_mm2 = bearable_mm2.fold(area_mm2, f32::min);
        let x = derivatives_mm_per_texel(object, self.from.triangle as usize, size);
        let held_back = x.map_or(0.0, |x| held_back(&Metric::new(x), texel_mm));
        // The slope is the difference by the length; its square, on the texel's area, is what flows, …
        let strength = EVERY as f32 * held_back
            / place_mm(object, self.from).distance_squared(place_mm(object, self.to));
        // … as much as its rate allows.
        let most = BUDGET / (SMALLEST * texel_mm).powi(2);
        let strength = self.conductivity * (area_mm2 * strength).min(least_mm2 * most);
        let mut element = Element { links: Vec::new() };
        for (n, &(i, weight)) in self.read.iter().enumerate() {
            element.add(self.texel, i, strength * weight);
            self.read[..n].iter().for_each(|&(j, other)| element.add(i, j, -strength * weight * other));
        }
        element
    }
}

/// Part of what flows across narrow texels that does not flow from each to the next.
fn held_back(metric: &Metric, texel_mm: f32) -> f32 {
    let [whole, cut] = [*metric, metric.cut(true, texel_mm)].map(|metric| metric.strength());
    if whole > 0.0 { 1.0 - cut / whole } else { 0.0 }
}
