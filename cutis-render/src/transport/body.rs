//! One object as light meets it: its tissue, and the surface at a point.

use super::interface::Interface;
use super::random::Random;
use super::tissue::Tissue;
use crate::RenderError;
use crate::passes::irradiance::shading_normal;
use cutis_optics::simulate::{Grid, Layer, LayeredSlab, Rings, Simulation};
use cutis_scene::solids::{Meeting, Solids};
use cutis_scene::{Material, Object, SurfacePoint};
use glam::{DMat3, DVec3, Vec3};

/// Packets per channel that tell the colour of a tissue, at first and at most, and the part of it that its standard error may
/// be. It is the same for all pixels, so that no standard error of a picture knows it.
const COLOUR_PACKETS: [u64; 2] = [1 << 16, 1 << 21];
const COLOUR_ERROR: f64 = 0.003;
/// Root-mean-square slope from which on refracted light spreads far enough to be aimed at.
const ROUGH_ENOUGH: f32 = 0.08;

/// An object filled with tissue.
pub struct Body {
    /// What fills it.
    pub tissue: Tissue,
    /// Reach within which scattered light asks for the lamps through the surface, mm; 0 where the surface is too smooth for it.
    pub connection_mm: f64,
    /// Colour of the bare tissue where the material's albedo is the colour seen; white where it is the tissue's own.
    colour: DVec3,
}

/// The surface at one place, as light from one side meets it.
pub struct Surface {
    /// Where it is.
    pub point: SurfacePoint,
    /// Unit normal that the interface has: that of the relief, or the flat one where the two are on different sides of the
    /// light.
    pub normal: DVec3,
    /// Unit normal of the relief.
    pub relief: DVec3,
    /// Unit normal of the flat triangle.
    pub flat_normal: DVec3,
    /// The interface.
    pub interface: Interface,
    /// Share of the light that the film on the surface leaves on its way in.
    pub film_inwards: DVec3,
    /// And on its way out.
    pub film_outwards: DVec3,
    /// Factor on what the outside reflects.
    pub rho_s: f64,
}

impl Body {
    /// The body of an object.
    ///
    /// # Errors
    /// If its material has no medium.
    pub fn new(object: &Object, seed: u64) -> Result<Self, RenderError> {
        let tissue = Tissue::of_material(&object.material)?;
        let colour =
            if has_colour(&object.material) { diffuse_reflectance(&tissue, seed) } else { DVec3::ONE };
        Ok(Self { connection_mm: connection_mm(&tissue, &object.material), tissue, colour })
    }

    /// The surface at a meeting, for light or sight from `from` (away from the surface).
    pub fn surface(&self, solids: &Solids, meeting: &Meeting, from: DVec3) -> Surface {
        let object = solids.object(meeting);
        let (point, material) = (solids.surface(meeting), &object.material);
        let relief = shading_normal(object, &point).as_dvec3().normalize();
        let same_side = relief.dot(from) * meeting.flat_normal.dot(from) > 0.0;
        let per_colour = |exponent: f32| self.colour.powf(-f64::from(exponent));
        Surface {
            point,
            normal: if same_side { relief } else { meeting.flat_normal },
            relief,
            flat_normal: meeting.flat_normal,
            interface: Interface {
                eta: self.tissue.refractive_index,
                roughness: f64::from(material.roughness.at(point.map_uv)),
            },
            film_inwards: material.film_inwards(point.map_uv).as_dvec3() * per_colour(material.albedo_mix),
            film_outwards: material.film_outwards(point.map_uv).as_dvec3()
                * per_colour(1.0 - material.albedo_mix),
            rho_s: f64::from(material.rho_s.at(point.map_uv)),
        }
    }
}

impl Surface {
    /// Where light or sight goes that comes from `from`; both point away from the surface.
    pub fn sample(&mut self, from: DVec3, random: &mut Random) -> DVec3 {
        let to = self.sample_with(from, random);
        if (to.dot(self.normal) > 0.0) == (to.dot(self.flat_normal) > 0.0) {
            return to;
        }
        // The relief would throw light through the surface: there, it is flat.
        self.normal = self.flat_normal;
        self.sample_with(from, random)
    }

    fn sample_with(&self, from: DVec3, random: &mut Random) -> DVec3 {
        let frame = self.frame();
        (frame * self.interface.sample(frame.transpose() * from, random)).normalize()
    }

    /// Estimated density of `to` from `from`, 1/sr (see [`Interface::eval_per_sr`]).
    pub fn eval_per_sr(&self, from: DVec3, to: DVec3, random: &mut Random) -> f64 {
        let frame = self.frame().transpose();
        self.interface.eval_per_sr(frame * from, frame * to, random)
    }

    /// About that density, 1/sr; none where the interface is sharp.
    pub fn rough_density_per_sr(&self, from: DVec3, to: DVec3) -> Option<f64> {
        let frame = self.frame().transpose();
        (!self.interface.is_sharp()).then(|| self.interface.rough_density_per_sr(frame * from, frame * to))
    }

    /// Local axes, as columns.
    fn frame(&self) -> DMat3 {
        let (u, v) = self.normal.any_orthonormal_pair();
        DMat3::from_cols(u, v, self.normal)
    }
}

/// How far from the surface light is scattered that still asks for lamps through it: six mean free paths. A smooth surface
/// lets one direction through, which the normal at the wrong place misses.
fn connection_mm(tissue: &Tissue, material: &Material) -> f64 {
    let roughness = material.roughness.offset + material.roughness.gain.min(0.0);
    let is_matched = tissue.refractive_index == 1.0;
    if roughness < ROUGH_ENOUGH || is_matched {
        0.0
    } else {
        6.0 / tissue.core().sigma_t_per_mm().min_element()
    }
}

/// Whether the albedo of a material is a colour of its own (see [`crate::prepare::kernel::kernel_of`]).
fn has_colour(material: &Material) -> bool {
    material.albedo.texture.is_some() || material.albedo.factor != Vec3::ONE
}

/// Diffuse reflectance of a flat, endless body of this tissue under light from straight above.
fn diffuse_reflectance(tissue: &Tissue, seed: u64) -> DVec3 {
    let of_channel = |channel: usize| {
        let layers = tissue.layers().iter().enumerate().map(|(i, layer)| Layer {
            sigma_a_per_mm: layer.sigma_a_per_mm[channel],
            sigma_s_per_mm: layer.sigma_s_per_mm[channel],
            g: layer.g,
            refractive_index: tissue.refractive_index,
            thickness_mm: if i + 1 < tissue.layers().len() { layer.thickness_mm } else { f64::INFINITY },
        });
        let slab = LayeredSlab::in_air(layers.collect()).ok()?;
        let grid =
            Grid { rings: Rings::even(1.0, 1).ok()?, depth_step_mm: 1.0, depth_bins: 1, cosine_bins: 1 };
        let simulation = Simulation { slab, grid, seed };
        let mut packets = COLOUR_PACKETS[0];
        loop {
            let colour = simulation.run(packets).diffuse_reflectance();
            if colour.standard_error <= COLOUR_ERROR * colour.value || packets >= COLOUR_PACKETS[1] {
                return Some(colour.value);
            }
            packets *= 4;
        }
    };
    // A tissue that cannot be simulated so was checked before; white changes nothing.
    DVec3::from_array([0, 1, 2].map(|channel| of_channel(channel).unwrap_or(1.0))).max(DVec3::splat(1e-6))
}
