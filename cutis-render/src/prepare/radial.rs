//! A material's diffusion profile as image-space sampling wants it: a table over the distance, and places to look at.

use crate::RenderError;
use crate::prepare::Kernel;
use crate::prepare::kernel::kernel_of;
use crate::settings::Settings;
use crate::technique::image_space::ImageSpaceProfile;
use cutis_optics::presets::PresetMaterial;
use cutis_optics::sample::{
    DipoleSampler, DiscPattern, DiscSample, GaussianSampler, INTERLEAVED_PIXELS, MixtureSampler,
    RadialSampler,
};
use cutis_optics::{Dipole, Gaussian, GaussianSum, Medium, Profile, presets};
use cutis_scene::{Material, Scattering};
use glam::Vec3;

/// Entries of the table.
pub const ENTRIES: usize = 1024;
/// Share of the light beyond the last entry.
const BEYOND: f32 = 1e-6;
/// The first entries are this part of the radius that holds a hundredth of the light apart.
const FINE: f32 = 0.25;

/// One material's profile.
pub struct RadialKernel {
    /// R at the entries, per channel, 1/mm².
    pub table: Vec<Vec3>,
    /// Distance at which the table turns from even to logarithmic steps, mm.
    pub fine_mm: f32,
    /// Entries for a factor of e far out.
    pub entries_per_e: f32,
    /// Places to look at, one list for each of the pixels that complete each other.
    pub patterns: Vec<Vec<DiscSample>>,
}

impl RadialKernel {
    /// Of a material.
    ///
    /// # Errors
    /// If it has no profile that can be sampled.
    pub fn new(material: &Material, settings: &Settings) -> Result<Self, RenderError> {
        let bad = |reason: String| RenderError::BadMaterial { material: material.name.clone(), reason };
        let kernel = kernel_of(material, settings.gaussians)?;
        let channels = channels(material, &kernel, settings.techniques.image_space.profile).map_err(bad)?;
        let total = kernel.total().to_array();
        let parts = channels.iter().zip(total).filter(|(_, total)| *total > 0.0);
        let parts =
            parts.map(|(c, _)| c.sampler().map(|s| (1.0, s))).collect::<Result<Vec<_>, _>>().map_err(bad)?;
        let mixture = MixtureSampler::new(parts).ok_or_else(|| bad("its profile has no light".to_owned()))?;
        let number = settings.techniques.image_space.samples as usize;
        let pattern = |i: u32| DiscPattern::interleaved(number, i % 4, i / 4).samples(&mixture).collect();
        let radius_mm = |xi| mixture.radius_mm(xi);
        let fine_mm = (FINE * radius_mm(0.01)).max(f32::MIN_POSITIVE);
        let entries_per_e = (ENTRIES - 1) as f32 / (radius_mm(1.0 - BEYOND) / fine_mm).ln_1p();
        let mut this = Self {
            table: Vec::new(),
            fine_mm,
            entries_per_e,
            patterns: (0..INTERLEAVED_PIXELS).map(pattern).collect(),
        };
        let entry = |i: usize| {
            let r_mm = f64::from(this.fine_mm) * (i as f64 / f64::from(this.entries_per_e)).exp_m1();
            let at = |c: usize| {
                (channels[c].profile.at_mm(r_mm) * f64::from(total[c]) / channels[c].profile.total()) as f32
            };
            Vec3::new(at(0), at(1), at(2))
        };
        let table = (0..ENTRIES).map(entry).collect();
        this.table = table;
        Ok(this)
    }

    /// R at a distance, 1/mm²; nothing beyond the table.
    pub fn at_mm(&self, r_mm: f32) -> Vec3 {
        let x = (r_mm / self.fine_mm).ln_1p() * self.entries_per_e;
        if x >= (ENTRIES - 1) as f32 || x.is_nan() {
            return Vec3::ZERO;
        }
        let i = x as usize;
        self.table[i].lerp(self.table[i + 1], x - i as f32)
    }

    /// The places that a pixel looks at.
    pub fn pattern(&self, [x, y]: [u32; 2]) -> &[DiscSample] {
        &self.patterns[(x % 4 + 4 * (y % 4)) as usize]
    }
}

/// One channel's profile.
struct Channel {
    profile: Box<dyn Profile>,
    source: Source,
}

enum Source {
    Dipole(Dipole),
    Gaussians(GaussianSum),
}

impl Channel {
    fn sampler(&self) -> Result<Box<dyn RadialSampler + Send + Sync>, String> {
        Ok(match &self.source {
            Source::Dipole(dipole) => Box::new(DipoleSampler::new(dipole)),
            Source::Gaussians(sum) => Box::new(GaussianSampler::new(sum).map_err(|e| e.to_string())?),
        })
    }
}

fn channels(material: &Material, kernel: &Kernel, choice: ImageSpaceProfile) -> Result<[Channel; 3], String> {
    let media = media_of(material).filter(|_| choice == ImageSpaceProfile::Medium);
    let of_medium = |medium: &Medium| -> Result<Channel, String> {
        let dipole = Dipole::new(medium).map_err(|e| e.to_string())?;
        Ok(Channel { profile: Box::new(dipole), source: Source::Dipole(dipole) })
    };
    let of_kernel = |c: usize| {
        let term = |(&v, w): (&f32, &Vec3)| Gaussian { weight: f64::from(w[c]), variance_mm2: f64::from(v) };
        let terms = kernel.variances_mm2.iter().zip(&kernel.weights).map(term);
        let sum = GaussianSum { terms: terms.filter(|t| t.weight != 0.0).collect() };
        Channel { profile: Box::new(sum.clone()), source: Source::Gaussians(sum) }
    };
    match media {
        Some([r, g, b]) => Ok([of_medium(&r)?, of_medium(&g)?, of_medium(&b)?]),
        None => Ok(std::array::from_fn(of_kernel)),
    }
}

fn media_of(material: &Material) -> Option<[Medium; 3]> {
    match &material.scattering {
        Scattering::Medium(media) => Some(*media),
        Scattering::Preset(name) => match presets::find(name).ok()?.material {
            PresetMaterial::Media(media) => Some(media),
            PresetMaterial::Kernel(_) => None,
        },
        Scattering::Kernel(_) => None,
    }
}
