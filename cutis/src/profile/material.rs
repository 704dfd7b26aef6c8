//! What the profile is made of: a preset, a file of layers, or layers in words.

use super::layer_file;
use crate::cli::ProfileArgs;
use crate::layer_words::parse_layer;
use cutis_optics::presets::{self, PresetMaterial};
use cutis_optics::{Medium, RgbGaussianSum, TissueLayer};
use miette::{Result, bail, miette};
use std::path::Path;

/// Most layers that are accepted; tissue has a dozen.
pub const LAYERS_MAX: usize = 64;
/// Refractive index told for a kernel that comes without one: that of skin.
const KERNEL_INDEX: f64 = 1.4;

/// A material with its name.
#[derive(Debug)]
pub struct Material {
    pub name: String,
    /// Where its numbers come from.
    pub origin: String,
    pub substance: Substance,
}

/// What is known of it.
#[derive(Debug)]
pub enum Substance {
    /// The same layers in every channel.
    Grey(Vec<TissueLayer>),
    /// Layers of red, green, blue.
    Coloured([Vec<TissueLayer>; 3]),
    /// No layers: a finished kernel.
    Kernel(RgbGaussianSum),
}

impl Material {
    /// The material that the arguments name.
    pub fn from_args(args: &ProfileArgs) -> Result<Self> {
        match &args.material {
            Some(name) if is_file_name(name) => layer_file::read(Path::new(name)),
            Some(name) => Self::preset(name),
            None if args.layer.is_empty() => Err(miette!(
                help = "cutis presets lists the names",
                "give a MATERIAL, or layers with --layer"
            )),
            None => Self::from_words(&args.layer),
        }
    }

    /// Refractive index of the top layer.
    pub fn refractive_index(&self) -> f64 {
        match &self.substance {
            Substance::Grey(layers) | Substance::Coloured([layers, ..]) => layers[0].medium.refractive_index,
            Substance::Kernel(_) => KERNEL_INDEX,
        }
    }

    /// A material that ships inside.
    pub fn preset(name: &str) -> Result<Self> {
        let preset = presets::find(name).map_err(|error| {
            miette!(help = "cutis presets lists the names; a file of layers ends in .toml", "{error}")
        })?;
        let endless = |medium: &Medium| vec![TissueLayer { medium: *medium, thickness_mm: f64::INFINITY }];
        let substance = match &preset.material {
            PresetMaterial::Media(media) => Substance::Coloured(media.each_ref().map(endless)),
            PresetMaterial::Kernel(kernel) => Substance::Kernel(kernel.clone()),
        };
        Ok(Self { name: preset.name.to_owned(), origin: preset.source.to_owned(), substance })
    }

    fn from_words(words: &[String]) -> Result<Self> {
        check_count(words.len())?;
        let layers = words.iter().enumerate().map(|(i, words)| {
            let layer = parse_layer(words)?;
            let reduced_per_mm = layer.sigma_s_per_mm * (1.0 - layer.g);
            let medium = Medium::new(layer.sigma_a_per_mm, reduced_per_mm, layer.refractive_index)
                .map_err(|error| miette!("layer {}: {error}", i + 1))?;
            Ok(TissueLayer { medium, thickness_mm: layer.thickness_mm })
        });
        Ok(Self {
            name: "layers".to_owned(),
            origin: "command line".to_owned(),
            substance: Substance::Grey(layers.collect::<Result<_>>()?),
        })
    }
}

/// Refuses no layers and too many.
pub fn check_count(layers: usize) -> Result<()> {
    if !(1..=LAYERS_MAX).contains(&layers) {
        bail!("there must be 1 to {LAYERS_MAX} layers, got {layers}");
    }
    Ok(())
}

fn is_file_name(name: &str) -> bool {
    Path::new(name).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"))
}
