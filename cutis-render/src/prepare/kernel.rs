//! From a material's numbers to the one kernel all passes use: variances and a weight per channel.

use crate::RenderError;
use cutis_optics::presets::PresetMaterial;
use cutis_optics::{Medium, RgbGaussianSum, Stack, TissueLayer, fit_rgb, presets, rgb_kernel};
use cutis_scene::{Material, Scattering};
use glam::Vec3;
use std::error::Error;

/// The diffusion kernel as the passes want it.
#[derive(Debug, Clone, PartialEq)]
pub struct Kernel {
    /// Variances along one axis, growing, mm².
    pub variances_mm2: Vec<f32>,
    /// Weight per channel of each Gaussian.
    pub weights: Vec<Vec3>,
}

/// The kernel of a material, with `gaussians` terms where it has to be fitted.
///
/// A material with an albedo of its own gets its kernel scaled to white, so that the albedo is the colour seen
/// (d'Eon, Luebke & Enderton 2007, section 5.3); one with a white albedo shows the colour of its medium.
///
/// # Errors
/// If the preset is unknown, the medium unphysical, or the fit impossible.
pub fn kernel_of(material: &Material, gaussians: usize) -> Result<Kernel, RenderError> {
    let bad = |reason: String| RenderError::BadMaterial { material: material.name.clone(), reason };
    let sum = match &material.scattering {
        Scattering::Preset(name) => {
            let preset = presets::find(name).map_err(|e| bad(e.to_string()))?;
            preset.kernel(gaussians).map_err(|e| bad(in_full(&e)))?
        }
        Scattering::Medium(media) => rgb_kernel(media, gaussians).map_err(|e| bad(in_full(&e)))?,
        Scattering::Layers(channels) => layered_kernel(channels, gaussians).map_err(bad)?,
        Scattering::Kernel(sum) => sum.clone(),
    };
    let kernel = Kernel::new(&sum).checked(&material.name)?;
    let coloured = material.albedo.texture.is_some() || material.albedo.factor != Vec3::ONE;
    Ok(if coloured { kernel.normalised_to_white() } else { kernel })
}

/// The kernel of layers, seen through the multipole.
fn layered_kernel(channels: &[Vec<TissueLayer>; 3], gaussians: usize) -> Result<RgbGaussianSum, String> {
    let [red, green, blue] = stacks(channels)?;
    Ok(fit_rgb([&red, &green, &blue], gaussians).map_err(|e| in_full(&e))?.kernel)
}

/// An error and what caused it.
fn in_full(error: &dyn Error) -> String {
    let causes = std::iter::successors(error.source(), |&cause| cause.source());
    causes.fold(error.to_string(), |words, cause| format!("{words}: {cause}"))
}

/// Red, green and blue of layers.
///
/// # Errors
/// In words, if a layer cannot be.
pub fn stacks(channels: &[Vec<TissueLayer>; 3]) -> Result<[Stack; 3], String> {
    let stack = |channel: usize| Stack::in_air(&channels[channel]).map_err(|e| in_full(&e));
    Ok([stack(0)?, stack(1)?, stack(2)?])
}

/// The same scattering with free paths `factors` times as long in red, green and blue. A preset of no known name stays:
/// [`kernel_of`] names it.
pub fn stretched(scattering: &Scattering, factors: [f64; 3]) -> Scattering {
    let media = |media: &[Medium; 3]| {
        Scattering::Medium(std::array::from_fn(|channel| media[channel].stretched(factors[channel])))
    };
    let kernel = |sum: &RgbGaussianSum| Scattering::Kernel(sum.widened(factors));
    match scattering {
        Scattering::Medium(m) => media(m),
        Scattering::Layers(channels) => Scattering::Layers(std::array::from_fn(|channel| {
            channels[channel].iter().map(|layer| layer.stretched(factors[channel])).collect()
        })),
        Scattering::Kernel(sum) => kernel(sum),
        Scattering::Preset(name) => match presets::find(name).map(|preset| &preset.material) {
            Ok(PresetMaterial::Media(m)) => media(m),
            Ok(PresetMaterial::Kernel(sum)) => kernel(sum),
            Err(_) => scattering.clone(),
        },
    }
}

impl Kernel {
    /// The kernel of a sum of Gaussians: terms sorted by variance.
    pub fn new(sum: &RgbGaussianSum) -> Self {
        let mut terms: Vec<_> = sum.variances_mm2.iter().copied().zip(sum.weights.iter().copied()).collect();
        terms.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self {
            variances_mm2: terms.iter().map(|&(variance_mm2, _)| variance_mm2 as f32).collect(),
            weights: terms.iter().map(|&(_, weight)| Vec3::from_array(weight.map(|w| w as f32))).collect(),
        }
    }

    /// A kernel that leaves light where it falls: the opaque surface of the same colour.
    pub fn opaque(total: Vec3) -> Self {
        Self { variances_mm2: vec![0.0], weights: vec![total] }
    }

    /// Without some of its Gaussians, by their numbers; the others keep their weights.
    pub fn without(mut self, muted: &[usize]) -> Self {
        self.weights
            .iter_mut()
            .enumerate()
            .filter(|(i, _)| muted.contains(i))
            .for_each(|(_, w)| *w = Vec3::ZERO);
        self
    }

    /// Sum of the weights per channel: the diffuse reflectance.
    pub fn total(&self) -> Vec3 {
        self.weights.iter().copied().sum()
    }

    /// Scaled so that every channel's weights sum to 1 and the albedo alone gives the colour
    /// (d'Eon, Luebke & Enderton 2007, section 5.3).
    pub fn normalised_to_white(&self) -> Self {
        let total = self.total().max(Vec3::splat(f32::MIN_POSITIVE));
        let weights = self.weights.iter().map(|&w| w / total).collect();
        Self { variances_mm2: self.variances_mm2.clone(), weights }
    }

    /// Standard deviation of the widest Gaussian, mm.
    pub fn reach_mm(&self) -> f32 {
        self.variances_mm2.last().map_or(0.0, |v| v.sqrt())
    }

    /// Standard deviation along one axis of each channel's whole profile, mm: how far it spreads light.
    pub fn deviation_mm(&self) -> Vec3 {
        let moment: Vec3 = self.weights.iter().zip(&self.variances_mm2).map(|(&w, &v)| w * v).sum();
        (moment / self.total().max(Vec3::splat(f32::MIN_POSITIVE))).max(Vec3::ZERO).map(f32::sqrt)
    }

    /// Refuses kernels that no pass could use.
    ///
    /// # Errors
    /// If a variance or weight is not finite, a variance negative, or there is no term at all.
    pub fn checked(self, material: &str) -> Result<Self, RenderError> {
        let bad = |reason: String| RenderError::BadMaterial { material: material.to_owned(), reason };
        if self.weights.is_empty() || self.weights.len() != self.variances_mm2.len() {
            return Err(bad("its kernel has no Gaussian, or not one weight for each".to_owned()));
        }
        if let Some(v) = self.variances_mm2.iter().find(|v| !v.is_finite() || **v < 0.0) {
            return Err(bad(format!(
                "a variance of its kernel is {v} mm²; it must be finite and not negative"
            )));
        }
        if let Some(w) = self.weights.iter().find(|w| !w.is_finite()) {
            return Err(bad(format!("a weight of its kernel is {w}; it must be finite")));
        }
        Ok(self)
    }
}
