//! Everything that is known about one object's surface once its light has been gathered and spread.

use crate::passes::ambient::Ambient;
use crate::passes::atlas::{Atlas, ChartMap};
use crate::passes::diffusion::Diffused;
use crate::passes::seam_map::Seams;
use crate::prepare::{Kernel, RhoDt};
use cutis_scene::Object;
use glam::{Vec2, Vec4};
use std::sync::Arc;

/// One object's textures and tables.
pub struct ObjectMaps {
    /// Its unrolled surface.
    pub atlas: Atlas,
    /// Its charts at half the size.
    pub half_charts: ChartMap,
    /// Millimetres per texel along u and v.
    pub stretch_mm: Vec<Vec2>,
    /// Its openness.
    pub ambient: Ambient,
    /// Light under its surface.
    pub diffused: Diffused,
    /// Fraction of each light that is seen.
    pub visibility: Vec<Vec<f32>>,
    /// Share of each light in the irradiance; empty for a single light.
    pub shares: Vec<Vec<f32>>,
    /// Places of all lights that were tried for a texel.
    pub tried: Vec<u32>,
    /// Its diffusion kernel.
    pub kernel: Kernel,
    /// What its surface lets through.
    pub rho_dt: RhoDt,
}

impl ObjectMaps {
    /// Millimetres per texel of the atlas at a place.
    pub fn stretch_at(&self, uv: Vec2) -> Vec2 {
        self.stretch_mm[self.texel_at(uv)]
    }

    /// The texel of the atlas that a place lies in.
    pub fn texel_at(&self, uv: Vec2) -> usize {
        let size = self.atlas.size;
        let texel = (uv * size as f32).clamp(Vec2::ZERO, Vec2::splat(size as f32 - 1.0));
        texel.y as usize * size + texel.x as usize
    }

    /// Where its charts meet, and how far the diffused light is apart there: see [`Seams::map`].
    pub fn seam_map(&self, object: &Object) -> Vec<Vec4> {
        let seams = Seams::of(object, Arc::clone(&self.atlas.charts));
        seams.map(|uv, chart| self.diffused.weighted_sum(&self.kernel.weights, uv, chart))
    }

    /// Texture distance of two places of one chart in millimetres, by the mean of the stretch at both.
    pub fn along_surface_mm(&self, a: Vec2, b: Vec2) -> f32 {
        let texels = (a - b) * self.atlas.size as f32;
        (texels * 0.5 * (self.stretch_at(a) + self.stretch_at(b))).length()
    }
}
