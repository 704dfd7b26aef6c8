//! Lamps, asked for through the surface from where light is scattered.

use super::body::Surface;
use super::emitter::Draw;
use super::interface::Interface;
use super::path::Transport;
use super::random::Random;
use super::walk::{Scattering, Walk};
use cutis_scene::solids::{NOWHERE, Ray64};
use glam::{DMat3, DVec3};
use std::f64::consts::PI;

/// Shares of directions that are drawn evenly, outwards and over all, lest a bent surface or another one be missed.
const OUTWARDS: f64 = 0.2;
const ANYWHERE: f64 = 0.1;
/// Probability with which lamps are asked for however deep light is scattered.
const ASK_AT_LEAST: f64 = 0.2;
/// What the guessed surface is rougher than the one the path met: it may be bent.
const BENT: f64 = 0.2;
/// Cosine to the lamp from which on a surface counts as facing it.
const FACING: f64 = 0.1;

/// A surface that may lie between scattered light and a lamp.
struct Guess {
    normal: DVec3,
    interface: Interface,
    /// Way to it, mm.
    way_mm: f64,
}

impl Guess {
    /// The tangent plane of the surface the path met last, if the lamp shines on it.
    fn new(last: &Surface, draw: &Draw, at_mm: DVec3) -> Option<Self> {
        let cos = last.normal.dot(draw.dir);
        let depth_mm = (last.point.position_mm.as_dvec3() - at_mm).dot(last.normal);
        let interface = Interface { roughness: last.interface.roughness + BENT, ..last.interface };
        (cos > FACING && depth_mm > 0.0).then_some(Self { normal: last.normal, interface, way_mm: depth_mm })
    }

    fn frame(&self) -> DMat3 {
        let (u, v) = self.normal.any_orthonormal_pair();
        DMat3::from_cols(u, v, self.normal)
    }

    /// A direction against which light from `light` may come through it; now and then any direction outwards, or any at all,
    /// where the guess is wrong.
    fn draw(&self, light: DVec3, random: &mut Random) -> Option<DVec3> {
        let kind = random.unit();
        if kind < OUTWARDS + ANYWHERE {
            let dir = random.direction();
            let outwards = 1f64.copysign(dir.dot(self.normal));
            return Some(if kind < OUTWARDS { dir * outwards } else { dir });
        }
        let frame = self.frame();
        Some(-(frame * self.interface.refract_once(frame.transpose() * light, random)?))
    }

    /// The density of such directions, 1/sr.
    fn density_per_sr(&self, light: DVec3, towards: DVec3) -> f64 {
        let frame = self.frame().transpose();
        let refracted = self.interface.refraction_density_per_sr(frame * light, frame * -towards);
        let outwards = if towards.dot(self.normal) > 0.0 { OUTWARDS / (2.0 * PI) } else { 0.0 };
        (1.0 - OUTWARDS - ANYWHERE) * refracted + outwards + ANYWHERE / (4.0 * PI)
    }
}

impl Transport<'_> {
    /// Light of one lamp that is refracted in and scattered along the path: how much of it `scattering` carries on.
    ///
    /// Asked at the surface, a lamp would nearly always be missed: the surface lets through what comes from a narrow
    /// cone inside. Here the lamp is refracted by the surface that likely lies between: that through which the path came,
    /// or, where that faces away, the one in the lamp's direction. A ray against the refracted direction finds where the light
    /// comes in; what was guessed wrong, the weight makes good. Only light within `reach_mm` counts.
    pub(super) fn lamps_through_surface(
        &self,
        walk: &Walk,
        reach_mm: f64,
        last: &Surface,
        scattering: &Scattering,
        random: &mut Random,
    ) -> DVec3 {
        if reach_mm <= 0.0 || self.emitters.lamps().is_empty() {
            return DVec3::ZERO;
        }
        let at_mm = scattering.point_mm;
        let mut same = random.clone();
        // None where no lamp shines here; where the light comes in, one may.
        let draw = self.emitters.draw(self.emitters.lamps(), at_mm, random);
        let out = |dir| {
            let ray = Ray64 { origin_mm: at_mm, dir, from: NOWHERE };
            self.solids.way_out(&ray, reach_mm, &mut scattering.within.clone())
        };
        let guess = draw.and_then(|draw| {
            let guess = Guess::new(last, &draw, at_mm).or_else(|| {
                let met = out(draw.dir)?;
                let surface = self.bodies[met.object as usize].surface(&self.solids, &met, draw.dir);
                let roughness = surface.interface.roughness.max(BENT);
                let interface = Interface { roughness, ..surface.interface };
                Some(Guess { normal: surface.normal, interface, way_mm: met.distance_mm })
            });
            Some((guess?, draw.dir))
        });
        // The deeper, the less comes through, and the less often it is asked for.
        let sigma_t = walk.tissue.core().sigma_t_per_mm().min_element();
        let likely =
            guess.as_ref().map_or(0.0, |(guess, _)| (-sigma_t * guess.way_mm).exp()).max(ASK_AT_LEAST);
        if random.unit() >= likely {
            return DVec3::ZERO;
        }
        let towards = match &guess {
            Some((guess, light)) => guess.draw(*light, random),
            None => Some(random.direction()),
        };
        let Some(towards) = towards else { return DVec3::ZERO };
        let Some(meeting) = out(towards) else { return DVec3::ZERO };
        let evenly = 1.0 / (4.0 * PI);
        let density = guess.map_or(evenly, |(guess, light)| guess.density_per_sr(light, towards));
        let surface = self.bodies[meeting.object as usize].surface(&self.solids, &meeting, -towards);
        let origin_mm = surface.point.lifted_position_mm.as_dvec3();
        // The same part of the lamp, as seen from where its light comes in.
        let Some(draw) = self.emitters.draw(self.emitters.lamps(), origin_mm, &mut same) else {
            return DVec3::ZERO;
        };
        if draw.dir.dot(surface.normal) <= 0.0 {
            return DVec3::ZERO;
        }
        let thrown = surface.eval_per_sr(-towards, draw.dir, random);
        if thrown <= 0.0 || self.is_shaded(origin_mm, meeting.id, &draw) {
            return DVec3::ZERO;
        }
        let passed = walk.passed(at_mm, towards, meeting.distance_mm, random);
        let scattered = scattering.density_per_sr(towards) / density / likely;
        scattering.light * passed * surface.film_outwards * draw.light * (thrown * scattered)
    }
}
