//! What a surface is made of: how it scatters, its colour, its relief and its shine.

use crate::texture::Texture;
use cutis_optics::{Medium, RgbGaussianSum, TissueLayer};
use glam::{Vec2, Vec3, Vec4};
use std::sync::Arc;

/// How light spreads under the surface.
#[derive(Debug, Clone)]
pub enum Scattering {
    /// A name from `cutis presets`.
    Preset(String),
    /// A homogeneous medium per channel (red, green, blue), seen through the dipole.
    Medium([Medium; 3]),
    /// Layers of media per channel, from the top, seen through the multipole (Donner & Jensen 2005); as many in each channel.
    Layers([Vec<TissueLayer>; 3]),
    /// A finished diffusion kernel.
    Kernel(RgbGaussianSum),
}

/// Linear colour: a factor, times a texture where there is one.
#[derive(Debug, Clone)]
pub struct ColourMap {
    /// Linear Rec. 709 factor.
    pub factor: Vec3,
    /// Texture whose rgb multiplies the factor.
    pub texture: Option<Arc<Texture>>,
}

/// One number over the surface: `offset + gain * tap[channel]`, or just `offset` without a texture.
#[derive(Debug, Clone)]
pub struct ScalarMap {
    /// Value where the texture is 0.
    pub offset: f32,
    /// Added where the texture is 1.
    pub gain: f32,
    /// Texture and the channel (0 red … 3 alpha) that is read.
    pub texture: Option<(Arc<Texture>, usize)>,
}

/// The space in which a normal map's vectors are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NormalSpace {
    /// Relative to the tangent frame of the mesh (MikkTSpace).
    Tangent,
    /// Relative to the mesh's own axes.
    Object,
}

/// A texture of unit vectors, stored as `0.5 + 0.5 n`.
#[derive(Debug, Clone)]
pub struct NormalMap {
    /// Linear texture; rgb is xyz, green points along +v of the *image flipped* (OpenGL convention, as in glTF).
    pub texture: Arc<Texture>,
    /// Space of the vectors.
    pub space: NormalSpace,
    /// Factor on x and y: 0 flat, 1 as stored.
    pub strength: f32,
}

/// A second medium within the first, such as veins in marble.
#[derive(Debug, Clone)]
pub struct SecondMedium {
    /// What it is: a medium, or a preset that is one.
    pub scattering: Scattering,
    /// Share of the volume that it fills, from 0 to 1, under every place of the surface.
    pub share: ScalarMap,
}

/// Everything a technique needs to know of a surface.
#[derive(Debug, Clone)]
pub struct Material {
    /// Name for messages.
    pub name: String,
    /// Diffusion under the surface.
    pub scattering: Scattering,
    /// Diffuse colour of the skin as seen (d'Eon et al. 2007, section 5.3): an absorbing film, passed twice.
    pub albedo: ColourMap,
    /// Exponent of the albedo on the way in; `1 - albedo_mix` on the way out. 0.5 in the paper.
    pub albedo_mix: f32,
    /// Relief finer than the mesh.
    pub normal: Option<NormalMap>,
    /// Specular intensity rho_s of the Kelemen–Szirmay-Kalos lobe.
    pub rho_s: ScalarMap,
    /// Beckmann roughness m of that lobe.
    pub roughness: ScalarMap,
    /// Fresnel reflectance at normal incidence; 0.028 for skin (index 1.4).
    pub f0: f32,
    /// Factor on distances through the body: 1 as thick as it is, above 1 less light comes through. An artist's number,
    /// which the real geometry does not know.
    pub thickness_scale: f32,
    /// Factor on the mean free path under every place, from [`Material::MEAN_FREE_PATH_SCALES`]: where it is 2, light spreads
    /// twice as far. Of the operators heat flow knows it.
    pub mean_free_path_scale: ScalarMap,
    /// Colours of layers under the surface, such as veins, the nearest to it first, at most [`Material::MAX_UNDER`]: each
    /// filters light that gets so deep. Green 2004 (GPU Gems, section 16.4.1) leaves them to the future; of the techniques
    /// `texture-blur` knows them.
    pub under: Vec<ColourMap>,
    /// A second medium, mixed with that of [`Material::scattering`] by a map (Mertens et al. 2003 vary the medium from pixel
    /// to pixel). Of the techniques `image-space` knows it.
    pub mixed_with: Option<SecondMedium>,
}

impl Default for Material {
    /// Plain skin: the three-layer kernel, a mid skin tone, no maps.
    fn default() -> Self {
        Self {
            name: "skin".to_owned(),
            scattering: Scattering::Preset("three-layer-skin".to_owned()),
            albedo: ColourMap { factor: Vec3::new(0.75, 0.48, 0.36), texture: None },
            albedo_mix: 0.5,
            normal: None,
            rho_s: ScalarMap::constant(1.0),
            roughness: ScalarMap::constant(0.3),
            f0: 0.028,
            thickness_scale: 1.0,
            mean_free_path_scale: ScalarMap::constant(1.0),
            under: Vec::new(),
            mixed_with: None,
        }
    }
}

impl ColourMap {
    /// Linear colour at `uv`.
    pub fn at(&self, uv: Vec2) -> Vec3 {
        match &self.texture {
            Some(texture) => self.factor * texture.sample(uv).truncate(),
            None => self.factor,
        }
    }
}

impl Material {
    /// What a mean free path may be multiplied by.
    pub const MEAN_FREE_PATH_SCALES: std::ops::RangeInclusive<f32> = 0.1..=10.0;
    /// Most layers under the surface.
    pub const MAX_UNDER: usize = 8;

    /// Its maps, by the keys that name them in a scene file.
    pub fn maps(&self) -> [(&'static str, Option<&Arc<Texture>>); 4] {
        [
            ("albedo", self.albedo.texture.as_ref()),
            ("normal", self.normal.as_ref().map(|map| &map.texture)),
            ("specular", self.rho_s.texture.as_ref().map(|(map, _)| map)),
            ("roughness", self.roughness.texture.as_ref().map(|(map, _)| map)),
        ]
    }

    /// Whether anything about it varies over the texture.
    pub fn has_maps(&self) -> bool {
        self.largest_map() > 0
    }

    /// Width or height of the largest of its maps, texels; 0 without any.
    pub fn largest_map(&self) -> u32 {
        let maps = self.maps().into_iter().filter_map(|(_, map)| map);
        let maps = maps.chain(self.under.iter().filter_map(|layer| layer.texture.as_ref()));
        let share = self.mixed_with.as_ref().and_then(|second| second.share.texture.as_ref());
        let maps = maps.chain(
            [share, self.mean_free_path_scale.texture.as_ref()].into_iter().flatten().map(|(map, _)| map),
        );
        maps.map(|map| map.width().max(map.height())).max().unwrap_or(0)
    }

    /// Makes it of another tissue alone.
    pub fn replace_tissue(&mut self, scattering: Scattering) {
        (self.scattering, self.mixed_with) = (scattering, None);
    }

    /// Whether the mean free path is the same, and as the medium has it, everywhere.
    pub fn has_one_mean_free_path(&self) -> bool {
        self.mean_free_path_scale.texture.is_none() && self.mean_free_path_scale.offset == 1.0
    }

    /// The least factor on the mean free path that its map can have.
    pub fn least_mean_free_path_scale(&self) -> f32 {
        let map = &self.mean_free_path_scale;
        let darkest = if map.texture.is_some() { map.gain.min(0.0) } else { 0.0 };
        let range = Self::MEAN_FREE_PATH_SCALES;
        (map.offset + darkest).clamp(*range.start(), *range.end())
    }

    /// Factor on the mean free path under a place.
    pub fn mean_free_path_scale_at(&self, uv: Vec2) -> f32 {
        let range = Self::MEAN_FREE_PATH_SCALES;
        self.mean_free_path_scale.at(uv).clamp(*range.start(), *range.end())
    }

    /// Share of the volume under a place that the second medium fills, 0 to 1; 0 without one.
    pub fn share_at(&self, uv: Vec2) -> f32 {
        self.mixed_with.as_ref().map_or(0.0, |second| second.share.at(uv).clamp(0.0, 1.0))
    }

    /// What the absorbing film leaves of light that falls in: `albedo^albedo_mix`.
    pub fn film_inwards(&self, uv: Vec2) -> Vec3 {
        power(self.albedo.at(uv), self.albedo_mix)
    }

    /// What it leaves of light on its way out: `albedo^(1 - albedo_mix)`.
    pub fn film_outwards(&self, uv: Vec2) -> Vec3 {
        power(self.albedo.at(uv), 1.0 - self.albedo_mix)
    }
}

/// `colour^exponent`, quick for the exponents that are common.
fn power(colour: Vec3, exponent: f32) -> Vec3 {
    let colour = colour.max(Vec3::ZERO);
    match exponent {
        0.0 => Vec3::ONE,
        0.5 => colour.map(f32::sqrt),
        1.0 => colour,
        _ => colour.powf(exponent),
    }
}

impl ScalarMap {
    /// The same value everywhere.
    pub fn constant(value: f32) -> Self {
        Self { offset: value, gain: 0.0, texture: None }
    }

    /// Specular intensity from a map of it: `rho_s = pi (0.18 + 0.16 red)`. Lee 2008 takes 0.18 + 0.16 red for a lobe
    /// whose Beckmann term lacks its 1/pi; the lobe here has it.
    pub fn measured_rho_s(texture: Arc<Texture>) -> Self {
        use std::f32::consts::PI;
        Self { offset: 0.18 * PI, gain: 0.16 * PI, texture: Some((texture, 0)) }
    }

    /// Beckmann roughness from a map of it: `m = 0.23 + 0.09 red` (Lee 2008).
    pub fn measured_roughness(texture: Arc<Texture>) -> Self {
        Self { offset: 0.23, gain: 0.09, texture: Some((texture, 0)) }
    }

    /// Value at `uv`.
    pub fn at(&self, uv: Vec2) -> f32 {
        match &self.texture {
            Some((texture, channel)) => self.offset + self.gain * texture.sample(uv)[*channel],
            None => self.offset,
        }
    }
}

impl NormalMap {
    /// Unit normal in world space at `uv`, given the interpolated frame of the mesh.
    pub fn at(&self, uv: Vec2, normal: Vec3, tangent: Vec4) -> Vec3 {
        let stored = self.texture.sample(uv).truncate() * 2.0 - Vec3::ONE;
        match self.space {
            NormalSpace::Object => normal.lerp(stored, self.strength).normalize_or(normal),
            NormalSpace::Tangent => {
                let t = tangent.truncate();
                let b = normal.cross(t) * tangent.w;
                let bent =
                    t * (stored.x * self.strength) + b * (stored.y * self.strength) + normal * stored.z;
                bent.normalize_or(normal)
            }
        }
    }
}
