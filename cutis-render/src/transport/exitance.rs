//! Packets from the lights: radiant exitance of light that has been inside, texel by texel.
//!
//! A packet starts at a place of the surface, every square millimetre equally likely, with the light that a drawn light
//! throws there; it enters, walks, and wherever it leaves its share is counted. Where the interface has the normal of the
//! relief instead of that of the triangle, its flux is corrected by |i·n||o·f|/(|i·f||o·n|), with n the one and f the other,
//! i and o the directions it comes from and goes to (Veach 1997, section 5.3): else eye and light would not see the same.
//! From a texel the same number comes of paths: [`of_place`].

use super::body::Surface;
use super::path::{INSIDE_MAX, OUTSIDE_MAX, Transport};
use super::random::Random;
use super::walk::{Carried, Met, Walk};
use cutis_scene::solids::{Meeting, Ray64};
use glam::{DVec3, Vec2};
use rayon::prelude::*;
use std::f64::consts::PI;
use std::ops::Range;

/// Packets walked as one: each batch is added up in its own order.
const BATCH: u64 = 512;
/// Cosine below which light runs along a triangle.
const GRAZING: f64 = 1e-9;

/// Where and with how much flux a packet left, W (per W/m² of irradiance: mm²).
#[derive(Debug, Clone, Copy)]
pub struct Exit {
    /// Index of the object.
    pub object: u32,
    /// Index of the triangle.
    pub triangle: u32,
    /// The place in the maps of light.
    pub atlas_uv: Vec2,
    /// Flux, in W/m² times mm².
    pub flux: DVec3,
}

/// Places to start from: every part of all surfaces equally likely.
pub struct Entrances<'a, 'b> {
    transport: &'b Transport<'a>,
    /// Sums of the areas of the triangles up to each one, mm².
    sums_mm2: Vec<f64>,
}

impl<'a, 'b> Entrances<'a, 'b> {
    /// Measures the surfaces.
    pub fn new(transport: &'b Transport<'a>) -> Self {
        let areas = (0..transport.solids.len()).map(|id| transport.solids.area_mm2(id));
        let sums = areas.scan(0.0, |sum, area| {
            *sum += area;
            Some(*sum)
        });
        Self { transport, sums_mm2: sums.collect() }
    }

    /// Area of all surfaces, mm².
    pub fn area_mm2(&self) -> f64 {
        self.sums_mm2.last().copied().unwrap_or(0.0)
    }

    /// Walks packets `first` to `first + count - 1` and tells `counter` of every exit, in their order. Returns how many random
    /// numbers they took.
    pub fn walk(&self, seed: u64, first: u64, count: u64, mut counter: impl FnMut(&Exit)) -> u64 {
        let mut drawn = 0;
        let batches: Vec<u64> = (first..first + count).step_by(BATCH as usize).collect();
        for some in batches.chunks(64 * rayon::current_num_threads()) {
            let walked: Vec<(Vec<Exit>, u64)> = some
                .par_iter()
                .map(|&begin| self.batch(seed, begin..(begin + BATCH).min(first + count)))
                .collect();
            for (exits, work) in &walked {
                exits.iter().for_each(&mut counter);
                drawn += work;
            }
        }
        drawn
    }

    /// The exits of some packets, and how many random numbers they took.
    fn batch(&self, seed: u64, packets: Range<u64>) -> (Vec<Exit>, u64) {
        let mut exits = Vec::new();
        let mut drawn = 0;
        for number in packets {
            let mut random = Random::new(seed, number, 0);
            let begin = random.clone();
            self.packet(&mut random, &mut exits);
            drawn += random.drawn_since(&begin);
        }
        (exits, drawn)
    }

    /// A place, every part of all surfaces equally likely.
    pub fn place(&self, random: &mut Random) -> (Meeting, DVec3) {
        let wanted = random.unit() * self.area_mm2();
        let id = self.sums_mm2.partition_point(|&sum| sum <= wanted).min(self.sums_mm2.len() - 1);
        let root = random.unit().sqrt();
        let share = random.unit();
        self.transport.solids.place(id, [root * (1.0 - share), root * share])
    }

    /// One packet, from the light to where all of it has left or is absorbed.
    fn packet(&self, random: &mut Random, exits: &mut Vec<Exit>) {
        let Transport { solids, emitters, bodies, .. } = self.transport;
        let (meeting, place_mm) = self.place(random);
        // As the eye asks for it: from where the smooth surface is.
        let origin_mm = solids.surface(&meeting).lifted_position_mm.as_dvec3();
        let Some(draw) = emitters.draw(emitters.all(), origin_mm, random) else { return };
        let mut surface = bodies[meeting.object as usize].surface(solids, &meeting, draw.dir);
        // As for paths: light counts that the smooth surface faces, be the triangle turned away by a hair.
        surface.normal = surface.relief;
        let cos = draw.dir.dot(surface.normal);
        let shadow = Ray64 { origin_mm, dir: draw.dir, from: meeting.id };
        if cos <= 0.0 || solids.occluded(&shadow, draw.distance_mm) {
            return;
        }
        // Along the triangle itself nothing falls on it, whatever the smooth surface says.
        let slant = draw.dir.dot(surface.flat_normal).abs();
        if slant < GRAZING {
            return;
        }
        let irradiance = draw.light * slant;
        let mut packet = Packet {
            transport: self.transport,
            flux: irradiance * self.area_mm2(),
            carried: Carried::new(DVec3::ONE, random),
            ray: Ray64 { origin_mm: place_mm, dir: -draw.dir, from: meeting.id },
            random,
            exits,
        };
        packet.follow(meeting, surface);
    }
}

struct Packet<'a, 'b> {
    transport: &'b Transport<'a>,
    /// What it started with, W/m² times mm².
    flux: DVec3,
    /// The share of it that is left.
    carried: Carried,
    ray: Ray64,
    random: &'b mut Random,
    exits: &'b mut Vec<Exit>,
}

impl Packet<'_, '_> {
    /// From a surface met from outside until nothing is left.
    fn follow(&mut self, mut meeting: Meeting, mut surface: Surface) {
        for _ in 0..OUTSIDE_MAX {
            if self.turn(&meeting, &mut surface) {
                self.carried.scale(DVec3::splat(surface.rho_s));
            } else {
                self.carried.scale(surface.film_inwards);
                if !self.pass_through(meeting.object) {
                    return;
                }
            }
            if !self.carried.survives(self.random) {
                return;
            }
            let Some(next) = self.transport.solids.nearest(&self.ray, f64::INFINITY) else { return };
            self.ray.origin_mm += self.ray.dir * next.distance_mm;
            let from = -self.ray.dir;
            surface =
                self.transport.bodies[next.object as usize].surface(&self.transport.solids, &next, from);
            if from.dot(surface.flat_normal) <= 0.0 {
                return;
            }
            meeting = next;
        }
    }

    /// Through the inside and out; false if nothing comes out.
    fn pass_through(&mut self, object: u32) -> bool {
        let Self { transport, .. } = *self;
        let walk =
            Walk { solids: &transport.solids, tissue: &transport.bodies[object as usize].tissue, object };
        let mut within = 1;
        for _ in 0..INSIDE_MAX {
            let met = walk.to_surface(&mut self.ray, &mut self.carried, &mut within, self.random, |_, _| ());
            let Some(Met { meeting, .. }) = met else { return false };
            let body = &transport.bodies[meeting.object as usize];
            let mut surface = body.surface(&transport.solids, &meeting, -self.ray.dir);
            if self.turn(&meeting, &mut surface) {
                self.carried.scale(surface.film_outwards);
                let flux = self.flux * self.carried.light();
                self.exits.push(Exit {
                    object: meeting.object,
                    triangle: meeting.triangle,
                    atlas_uv: surface.point.atlas_uv,
                    flux,
                });
                return true;
            }
        }
        false
    }

    /// Reflects or refracts; true if the ray goes on outside.
    fn turn(&mut self, meeting: &Meeting, surface: &mut Surface) -> bool {
        let from = -self.ray.dir;
        let to = surface.sample(from, self.random);
        let slant = |dir: DVec3| (dir.dot(surface.normal) / dir.dot(surface.flat_normal)).abs();
        self.carried.scale(DVec3::splat(slant(from) / slant(to)));
        self.ray.dir = to;
        self.ray.from = meeting.id;
        to.dot(surface.flat_normal) > 0.0
    }
}

/// Radiant exitance of a place by one path, W/m²: what leaves towards a direction drawn by the cosine, reversed.
pub fn of_place(transport: &Transport, meeting: Meeting, place_mm: DVec3, random: &mut Random) -> DVec3 {
    let (u, v) = meeting.flat_normal.any_orthonormal_pair();
    let d = random.cosine_hemisphere();
    let to = (u * d.x + v * d.y + meeting.flat_normal * d.z).normalize();
    transport.leaving(meeting, place_mm, to, random).entered_at_once * PI
}
