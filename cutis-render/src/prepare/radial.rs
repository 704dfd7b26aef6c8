//! A material's diffusion profile as image-space sampling wants it: a table over the distance, and places to look at.
//!
//! Symbols: R(r) profile per channel, 1/mm²; p(r) density of the samples, 1/mm², one for all channels: the mean of the
//! channels' own. Places that follow p and places that are spread over a disc are one set: each is weighed by how many of
//! all are to be expected there (balance heuristic, Veach & Guibas 1995, doi:10.1145/218380.218498, not opened).

use crate::RenderError;
use crate::prepare::Kernel;
use crate::prepare::kernel::{kernel_of, stacks};
use crate::prepare::mixtures::{media_of, mixtures};
use crate::settings::Settings;
use crate::technique::image_space::{ImageSpaceProfile, ImageSpaceSettings};
use cutis_optics::sample::{
    DipoleSampler, DiscPattern, GaussianSampler, INTERLEAVED_PIXELS, MixtureSampler, RadialSampler,
    TabulatedSampler, UniformDisc,
};
use cutis_optics::{Dipole, Gaussian, GaussianSum, Medium, Profile, Stack, TabulatedProfile};
use cutis_scene::{Material, Scattering};
use glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;
use std::sync::Arc;

/// Entries of the table.
pub const ENTRIES: usize = 1024;
/// Share of the light beyond the last entry.
const BEYOND: f32 = 1e-6;
/// The first entries lie this part of the radius that holds a hundredth of the light apart.
const FINE: f32 = 0.25;
/// Share of the light within the disc of uniform samples, where no radius is given.
const WITHIN_DISC: f32 = 0.95;

/// One channel's profile and what draws from it.
pub struct Channel {
    /// R, in any scale.
    pub profile: Box<dyn Profile + Send + Sync>,
    /// Draws radii by R.
    pub sampler: Box<dyn RadialSampler + Send + Sync>,
}

/// One material's profile.
#[derive(Debug, Clone)]
pub struct RadialKernel {
    /// R per channel in xyz and p in w at the entries, 1/mm².
    pub table: Vec<Vec4>,
    /// Distance up to which the entries are even, mm; beyond, they are so many for each factor of e.
    pub fine_mm: f32,
    /// Entries for a factor of e far out.
    pub entries_per_e: f32,
    /// Radius of the disc of uniform samples, mm.
    pub disc_mm: f32,
    /// How many samples follow the profile and how many fill the disc.
    pub counts: [u32; 2],
    /// Places to look at, as many for each of the pixels that complete each other.
    pub places: Vec<PlaceToLook>,
    /// Draws radii by p.
    sampler: Arc<MixtureSampler>,
}

/// A place on the tangent plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaceToLook {
    /// Along tangent and bitangent, mm.
    pub offset_mm: Vec2,
    /// Samples that are to be expected there, per mm².
    pub density_per_mm2: f32,
}

impl RadialKernel {
    /// Of a material, where a pixel is looked at once.
    ///
    /// # Errors
    /// If it has no profile that can be sampled.
    pub fn new(material: &Material, settings: &Settings) -> Result<Self, RenderError> {
        let bad = |reason: String| RenderError::BadMaterial { material: material.name.clone(), reason };
        let kernel = kernel_of(material, settings.gaussians)?;
        let image_space = &settings.techniques.image_space;
        let channels = channels(material, &kernel, image_space.profile).map_err(bad)?;
        Self::of_channels(channels, kernel.total(), image_space)
            .ok_or_else(|| bad("its profile has no light to be sampled".to_owned()))
    }

    /// Of so many mixtures of a material's media.
    ///
    /// # Errors
    /// If one has no profile that can be sampled.
    pub fn of_mixtures(
        material: &Material,
        settings: &Settings,
        count: u32,
    ) -> Result<Vec<Self>, RenderError> {
        mixtures(material, count)?.iter().map(|mixture| Self::new(mixture, settings)).collect()
    }

    /// Of any three profiles, scaled to the totals that are wanted. `None` if these are all 0.
    pub fn of_channels(channels: [Channel; 3], totals: Vec3, settings: &ImageSpaceSettings) -> Option<Self> {
        let (profiles, parts): (Vec<_>, Vec<_>) = channels
            .into_iter()
            .zip(totals.to_array())
            .map(|(c, total)| ((c.profile, total), (if total > 0.0 { 1.0 } else { 0.0 }, c.sampler)))
            .unzip();
        let mixture = MixtureSampler::new(parts)?;
        let fine_mm = (FINE * mixture.radius_holding(0.01)).max(f32::MIN_POSITIVE);
        let entries_per_e = (ENTRIES - 1) as f32 / (mixture.radius_holding(1.0 - BEYOND) / fine_mm).ln_1p();
        let entry = |i: usize| {
            let r_mm = f64::from(fine_mm) * (i as f64 / f64::from(entries_per_e)).exp_m1();
            let at = |(profile, total): &(Box<dyn Profile + Send + Sync>, f32)| match *total {
                0.0 => 0.0,
                total => (profile.at_mm(r_mm) * f64::from(total) / profile.total()) as f32,
            };
            Vec3::new(at(&profiles[0]), at(&profiles[1]), at(&profiles[2]))
                .extend(mixture.pdf_per_mm2(r_mm as f32))
        };
        let table = (0..ENTRIES).map(entry).collect();
        let (sampler, places) = (Arc::new(mixture), Vec::new());
        Self { table, fine_mm, entries_per_e, disc_mm: 0.0, counts: [0; 2], places, sampler }
            .sampled(settings, 1)
            .ok()
    }

    /// The same profile where a pixel is looked at `times` times, by the numbers and the round of settings.
    ///
    /// # Errors
    /// If the disc of the uniform samples has no radius.
    pub fn sampled(&self, settings: &ImageSpaceSettings, times: u32) -> Result<Self, RenderError> {
        let disc_mm = settings.uniform_radius_mm.unwrap_or_else(|| self.sampler.radius_holding(WITHIN_DISC));
        let counts = [settings.samples, settings.uniform_samples].map(|n| n.div_ceil(times.max(1)));
        let disc = UniformDisc::new(disc_mm).ok_or_else(|| RenderError::BadSetting {
            name: "radius of the uniform samples",
            range: "above 0 and finite, in mm",
            value: disc_mm.to_string(),
        })?;
        let mut this = Self { disc_mm, counts, ..self.clone() };
        this.places = this.all_places(disc, settings.round);
        Ok(this)
    }

    fn all_places(&self, disc: UniformDisc, round: u32) -> Vec<PlaceToLook> {
        let pattern = |count: u32, pixel: u32| {
            DiscPattern::interleaved(count as usize, pixel % 4, pixel / 4).in_round(round)
        };
        let of_pixel = |pixel: u32| {
            let followers = pattern(self.counts[0], pixel).samples(&*self.sampler);
            // Where the profile has a pixel look first, the disc has it look last.
            let fillers = pattern(self.counts[1], INTERLEAVED_PIXELS - 1 - pixel).samples(&disc);
            let place = |s: cutis_optics::sample::DiscSample| PlaceToLook {
                offset_mm: Vec2::from_array(s.offset_mm),
                density_per_mm2: self.density_per_mm2(s.radius_mm),
            };
            followers.map(place).chain(fillers.map(place)).collect::<Vec<_>>()
        };
        (0..INTERLEAVED_PIXELS).flat_map(of_pixel).collect()
    }

    /// R per channel in xyz and p in w at a distance, 1/mm²; nothing beyond the table.
    pub fn at_mm(&self, r_mm: f32) -> Vec4 {
        let x = (r_mm / self.fine_mm).ln_1p() * self.entries_per_e;
        if x >= (ENTRIES - 1) as f32 || x.is_nan() {
            return Vec4::ZERO;
        }
        let i = x as usize;
        self.table[i].lerp(self.table[i + 1], x - i as f32)
    }

    /// Samples that are to be expected at a distance, per mm².
    pub fn density_per_mm2(&self, r_mm: f32) -> f32 {
        let [followers, fillers] = self.counts.map(|n| n as f32);
        let on_disc = if r_mm <= self.disc_mm {
            fillers / (std::f32::consts::PI * self.disc_mm * self.disc_mm)
        } else {
            0.0
        };
        followers * self.at_mm(r_mm).w + on_disc
    }

    /// The places that a pixel looks at.
    pub fn places_of(&self, [x, y]: [u32; 2]) -> &[PlaceToLook] {
        let count = self.places.len() / INTERLEAVED_PIXELS as usize;
        &self.places[(x % 4 + 4 * (y % 4)) as usize * count..][..count]
    }
}

fn channels(material: &Material, kernel: &Kernel, choice: ImageSpaceProfile) -> Result<[Channel; 3], String> {
    let of_gaussians = || Ok([of_kernel(kernel, 0)?, of_kernel(kernel, 1)?, of_kernel(kernel, 2)?]);
    match (choice, &material.scattering, media_of(&material.scattering)) {
        (ImageSpaceProfile::Gaussians, ..) => of_gaussians(),
        (_, _, Some([r, g, b])) => Ok([of_medium(&r)?, of_medium(&g)?, of_medium(&b)?]),
        (_, Scattering::Layers(layers), _) => {
            let channels: Result<Vec<_>, _> = stacks(layers)?.into_par_iter().map(of_stack).collect();
            channels?.try_into().map_err(|_| "a profile has three channels".to_owned())
        }
        _ => of_gaussians(),
    }
}

/// A profile without its sign: where diffusion has negative light, around thin layers, samples have to look, too.
struct Absolute<'a, P>(&'a P);

impl<P: Profile> Profile for Absolute<'_, P> {
    fn spectrum(&self, k_per_mm: f64) -> f64 {
        self.0.spectrum(k_per_mm)
    }

    fn at_mm(&self, r_mm: f64) -> f64 {
        self.0.at_mm(r_mm).abs()
    }
}

/// Drawn from by a table, as any profile can be.
fn of_stack(stack: Stack) -> Result<Channel, String> {
    let mean_free_path_mm = stack.shortest_mean_free_path_mm();
    let profile = TabulatedProfile::new(stack, mean_free_path_mm);
    let sampler = TabulatedSampler::new(&Absolute(&profile), mean_free_path_mm).map_err(|e| e.to_string())?;
    Ok(Channel { profile: Box::new(profile), sampler: Box::new(sampler) })
}

fn of_medium(medium: &Medium) -> Result<Channel, String> {
    let dipole = Dipole::new(medium).map_err(|e| e.to_string())?;
    Ok(Channel { profile: Box::new(dipole), sampler: Box::new(DipoleSampler::new(&dipole)) })
}

fn of_kernel(kernel: &Kernel, channel: usize) -> Result<Channel, String> {
    // Narrower than any picture shows, wide enough to have a density: Gaussians of no width.
    const NARROWEST_MM2: f64 = 1e-12;
    let term = |(&v, w): (&f32, &Vec3)| Gaussian {
        weight: f64::from(w[channel]),
        variance_mm2: f64::from(v).max(NARROWEST_MM2),
    };
    let terms = kernel.variances_mm2.iter().zip(&kernel.weights).map(term);
    let mut sum = GaussianSum { terms: terms.filter(|t| t.weight != 0.0).collect() };
    if sum.terms.is_empty() {
        // A channel without light is never drawn from.
        sum.terms.push(Gaussian { weight: 1.0, variance_mm2: 1.0 });
    }
    let sampler = GaussianSampler::new(&sum).map_err(|e| e.to_string())?;
    Ok(Channel { profile: Box::new(sum), sampler: Box::new(sampler) })
}
