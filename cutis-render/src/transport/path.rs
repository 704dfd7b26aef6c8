//! Paths from the eye: radiance along a ray, by what is met on the way.
//!
//! At every meeting with a rough surface, from outside or from within, a light is drawn and its share thrown towards the eye
//! is added; a light that the path happens to meet is added too, and the two are weighed by how likely each was
//! (multiple importance sampling, Veach 1997, the balance heuristic).

use super::body::{Body, Surface};
use super::emitter::{Draw, Emitters};
use super::random::Random;
use super::walk::{Carried, Met, Scattering, Walk};
use crate::RenderError;
use cutis_scene::Scene;
use cutis_scene::solids::{Meeting, NOWHERE, Ray64, Solids};
use glam::DVec3;
use std::ops::Range;

/// Times that light may leave one body and meet another surface.
pub(super) const OUTSIDE_MAX: u32 = 256;
/// Times that light may be thrown back by a surface from within.
pub(super) const INSIDE_MAX: u32 = 1_000_000;

/// Everything that paths need to know.
pub struct Transport<'a> {
    /// Surfaces.
    pub solids: Solids<'a>,
    /// What is under them, per object.
    pub bodies: Vec<Body>,
    /// Lights.
    pub emitters: Emitters<'a>,
    /// The scene itself.
    pub scene: &'a Scene,
}

/// What came along one path.
#[derive(Debug, Clone, Copy, Default)]
pub struct PathSample {
    /// Radiance of light that has been inside a body, W/(m² sr).
    pub diffuse: DVec3,
    /// Radiance of light that has not, but was reflected by one.
    pub specular: DVec3,
    /// Radiance of what is behind everything.
    pub background: DVec3,
    /// Whether the ray met anything.
    pub covered: bool,
    /// The part of `diffuse` that entered at the first surface met, instead of being reflected onto another one.
    pub entered_at_once: DVec3,
    /// Steps inside bodies.
    pub events: u64,
}

/// A path on its way.
struct Path<'a, 'b> {
    transport: &'b Transport<'a>,
    random: &'b mut Random,
    carried: Carried,
    ray: Ray64,
    /// About the density of the ray's direction, 1/sr; none where a light in it could not have been drawn.
    density_per_sr: Option<f64>,
    /// Lights that the last surface asked for, and that count where the ray meets them.
    lights: Range<usize>,
    /// Whether it has been inside a body …
    entered: bool,
    /// … and whether it was reflected before.
    reflected: bool,
    sum: PathSample,
}

impl<'a> Transport<'a> {
    /// Fills the bodies of a scene.
    ///
    /// # Errors
    /// If a material has no medium. Whether bodies are closed and lights can be found is for the caller to ask.
    pub fn new(scene: &'a Scene, seed: u64) -> Result<Self, RenderError> {
        let bodies = scene.objects.iter().map(|object| Body::new(object, seed)).collect::<Result<_, _>>()?;
        let solids = Solids::new(&scene.objects);
        Ok(Self { solids, bodies, emitters: Emitters::new(scene), scene })
    }

    /// Radiance that arrives at `origin_mm`, outside of all bodies, from direction `dir`.
    pub fn radiance(&self, origin_mm: DVec3, dir: DVec3, random: &mut Random) -> PathSample {
        let ray = Ray64 { origin_mm, dir, from: NOWHERE };
        let Some(meeting) = self.solids.nearest(&ray, f64::INFINITY) else {
            return PathSample { background: self.background(dir), ..PathSample::default() };
        };
        let mut path = self.path(ray, random);
        path.sum.covered = true;
        path.ray.origin_mm += dir * meeting.distance_mm;
        path.follow(meeting);
        path.sum
    }

    /// Radiance that leaves a place on the surface towards `to`.
    pub fn leaving(&self, meeting: Meeting, place_mm: DVec3, to: DVec3, random: &mut Random) -> PathSample {
        let mut path = self.path(Ray64 { origin_mm: place_mm, dir: -to, from: meeting.id }, random);
        path.sum.covered = true;
        path.follow(meeting);
        path.sum
    }

    fn path<'b>(&'b self, ray: Ray64, random: &'b mut Random) -> Path<'b, 'b> {
        let carried = Carried::new(DVec3::ONE, random);
        let sum = PathSample::default();
        Path {
            transport: self,
            random,
            carried,
            ray,
            density_per_sr: None,
            lights: self.emitters.all(),
            entered: false,
            reflected: false,
            sum,
        }
    }

    /// Whether something lies between a place on triangle `id` and a light.
    pub(super) fn is_shaded(&self, origin_mm: DVec3, id: u32, draw: &Draw) -> bool {
        self.solids.occluded(&Ray64 { origin_mm, dir: draw.dir, from: id }, draw.distance_mm)
    }

    /// What a ray of the camera sees that meets nothing.
    pub fn background(&self, dir: DVec3) -> DVec3 {
        match &self.scene.environment {
            Some(environment) if environment.visible => environment.radiance(dir.as_vec3()).as_dvec3(),
            _ => self.scene.background.map_or(DVec3::ZERO, |radiance| radiance.as_dvec3()),
        }
    }
}

impl Path<'_, '_> {
    /// Goes on from a meeting at the ray's origin until nothing is met or carried any more.
    fn follow(&mut self, mut meeting: Meeting) {
        for _ in 0..OUTSIDE_MAX {
            if !self.reflect_or_pass(&meeting) || !self.carried.survives(self.random) {
                return;
            }
            let next = self.transport.solids.nearest(&self.ray, f64::INFINITY);
            self.meet_lights(next.as_ref());
            let Some(next) = next else { return };
            self.ray.origin_mm += self.ray.dir * next.distance_mm;
            meeting = next;
        }
    }

    /// From outside onto the surface and, reflected or by way of the inside, out again; false if nothing comes out.
    fn reflect_or_pass(&mut self, meeting: &Meeting) -> bool {
        let body = &self.transport.bodies[meeting.object as usize];
        let from = -self.ray.dir;
        let mut surface = body.surface(&self.transport.solids, meeting, from);
        // The back of a surface, from outside: the body is open, or turned inside out there.
        if from.dot(surface.flat_normal) <= 0.0 {
            return false;
        }
        self.lights = self.transport.emitters.all();
        self.ask_light(&surface, meeting, from, DVec3::splat(surface.rho_s));
        let to = surface.sample(from, self.random);
        self.ray = Ray64 { dir: to, from: meeting.id, ..self.ray };
        if to.dot(surface.flat_normal) > 0.0 {
            self.reflected |= !self.entered;
            self.carried.scale(DVec3::splat(surface.rho_s));
            self.density_per_sr = surface.rough_density_per_sr(from, to);
            return true;
        }
        self.entered = true;
        self.carried.scale(surface.film_inwards);
        self.pass_through(meeting.object, surface)
    }

    /// Through the inside and out; false if nothing comes out.
    fn pass_through(&mut self, object: u32, mut last: Surface) -> bool {
        let transport = self.transport;
        let (solids, body) = (&transport.solids, &transport.bodies[object as usize]);
        let walk = Walk { solids, tissue: &body.tissue, object };
        let mut within = 1;
        for _ in 0..INSIDE_MAX {
            let (mut lamps, mut events) = (DVec3::ZERO, 0);
            let met = walk.to_surface(
                &mut self.ray,
                &mut self.carried,
                &mut within,
                self.random,
                |scattering: &Scattering, random: &mut Random| {
                    events += 1;
                    lamps +=
                        transport.lamps_through_surface(&walk, body.connection_mm, &last, scattering, random);
                },
            );
            self.sum.events += events;
            self.add(lamps);
            let Some(Met { meeting, flown_mm }) = met else { return false };
            let from = -self.ray.dir;
            // Where bodies overlap, light may leave through the other one's skin.
            let mut surface = transport.bodies[meeting.object as usize].surface(solids, &meeting, from);
            // Lamps that were asked for where the light was scattered last are not asked again.
            let asked = flown_mm.is_some_and(|flown_mm| flown_mm <= body.connection_mm)
                && !surface.interface.is_sharp();
            self.lights = if asked { transport.emitters.surroundings() } else { transport.emitters.all() };
            self.ask_light(&surface, &meeting, from, surface.film_outwards);
            let to = surface.sample(from, self.random);
            self.ray.dir = to;
            if to.dot(surface.flat_normal) > 0.0 {
                self.carried.scale(surface.film_outwards);
                self.density_per_sr = surface.rough_density_per_sr(from, to);
                return true;
            }
            last = surface;
        }
        false
    }

    /// Adds the light of one drawn light that the surface throws back along the path.
    fn ask_light(&mut self, surface: &Surface, meeting: &Meeting, from: DVec3, factor: DVec3) {
        if surface.interface.is_sharp() {
            return;
        }
        // From where the smooth surface is, so that coarse triangles do not shade their neighbours.
        let origin_mm = surface.point.lifted_position_mm.as_dvec3();
        let transport = self.transport;
        let Some(draw) = transport.emitters.draw(self.lights.clone(), origin_mm, self.random) else { return };
        if draw.dir.dot(surface.normal) <= 0.0 {
            return;
        }
        let thrown = surface.eval_per_sr(from, draw.dir, self.random);
        if thrown <= 0.0 || transport.is_shaded(origin_mm, meeting.id, &draw) {
            return;
        }
        let weight = match (draw.density_per_sr, surface.rough_density_per_sr(from, draw.dir)) {
            (Some(drawn), Some(met)) => drawn / (drawn + met),
            _ => 1.0,
        };
        self.add(self.carried.light() * factor * draw.light * (thrown * weight));
    }

    /// Adds the lights that the ray meets before `next`.
    fn meet_lights(&mut self, next: Option<&Meeting>) {
        let end_mm = next.map_or(f64::INFINITY, |meeting| meeting.distance_mm);
        let mut met = DVec3::ZERO;
        for seen in self.transport.emitters.seen(self.lights.clone(), self.ray.origin_mm, self.ray.dir) {
            if seen.distance_mm < end_mm || next.is_none() {
                let weight =
                    self.density_per_sr.map_or(1.0, |density| density / (density + seen.density_per_sr));
                met += seen.radiance * weight;
            }
        }
        self.add(self.carried.light() * met);
    }

    fn add(&mut self, radiance: DVec3) {
        if self.entered {
            self.sum.diffuse += radiance;
            if !self.reflected {
                self.sum.entered_at_once += radiance;
            }
        } else {
            self.sum.specular += radiance;
        }
    }
}
