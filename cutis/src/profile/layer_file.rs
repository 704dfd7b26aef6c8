//! A file of layers, top first:
//!
//! ```toml
//! name = "two layers"          # may be left out
//! [[layer]]
//! sigma_a_per_mm = [0.1, 0.2, 0.5]    # red, green, blue; or one number for all
//! sigma_s_reduced_per_mm = 4.8        # or sigma_s_per_mm and g
//! refractive_index = 1.4
//! thickness_mm = 0.25                 # left out in the last layer: endless
//! ```

use super::material::{Material, Substance, check_count};
use cutis_optics::{Medium, TissueLayer};
use miette::{Result, bail, miette};
use serde::Deserialize;
use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

/// Longest file read: sixty-four layers with remarks are a hundredth of it.
const BYTES_MAX: u64 = 1 << 20;
/// Longest name kept.
const NAME_CHARS_MAX: usize = 64;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LayerFile {
    name: Option<String>,
    #[serde(default)]
    layer: Vec<Entry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    sigma_a_per_mm: Coefficient,
    sigma_s_per_mm: Option<Coefficient>,
    g: Option<Coefficient>,
    sigma_s_reduced_per_mm: Option<Coefficient>,
    refractive_index: Coefficient,
    thickness_mm: Option<f64>,
}

#[derive(Deserialize, Clone, Copy)]
#[serde(untagged, expecting = "expected a number, or an array of three (red, green, blue)")]
enum Coefficient {
    Same(f64),
    Each([f64; 3]),
}

impl Coefficient {
    fn of(self, channel: usize) -> f64 {
        match self {
            Self::Same(value) => value,
            Self::Each(values) => values[channel],
        }
    }

    fn is_coloured(self) -> bool {
        matches!(self, Self::Each(_))
    }
}

/// Reads the file; every complaint names it.
pub fn read(path: &Path) -> Result<Material> {
    let place = path.display();
    let text = text_of(path).map_err(|reason| miette!("{place}: {reason}"))?;
    let file: LayerFile = toml::from_str(&text).map_err(|error| {
        let line =
            error.span().map_or(1, |span| 1 + text[..span.start.min(text.len())].matches('\n').count());
        let message = error.message().lines().collect::<Vec<_>>().join(" ");
        miette!("{place}, line {line}: {message}")
    })?;
    material(&file, path).map_err(|reason| miette!("{place}: {reason}"))
}

fn text_of(path: &Path) -> Result<String> {
    let about = fs::metadata(path).map_err(|_| miette!("there is no such file"))?;
    // A pipe or a device would be read for ever.
    if !about.is_file() {
        bail!("is not a file");
    }
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(|reason| miette!("cannot be read: {reason}"))?;
    file.take(BYTES_MAX + 1).read_to_end(&mut bytes).map_err(|reason| miette!("cannot be read: {reason}"))?;
    if bytes.len() as u64 > BYTES_MAX {
        bail!("is longer than {BYTES_MAX} bytes");
    }
    String::from_utf8(bytes).map_err(|_| miette!("is not text in UTF-8"))
}

fn material(file: &LayerFile, path: &Path) -> Result<Material> {
    check_count(file.layer.len())?;
    let layers = |channel: usize| -> Result<Vec<TissueLayer>> {
        let numbered = file.layer.iter().enumerate();
        numbered
            .map(|(i, e)| e.layer(channel).map_err(|reason| miette!("layer {}: {reason}", i + 1)))
            .collect()
    };
    let substance = if file.layer.iter().any(Entry::is_coloured) {
        Substance::Coloured([layers(0)?, layers(1)?, layers(2)?])
    } else {
        Substance::Grey(layers(0)?)
    };
    let stem = || path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let name: String = file.name.clone().unwrap_or_else(stem);
    let plain = name.chars().map(|c| if c.is_control() { ' ' } else { c });
    let origin = format!("file {}", path.file_name().unwrap_or_default().to_string_lossy());
    Ok(Material { name: plain.take(NAME_CHARS_MAX).collect(), origin, substance })
}

impl Entry {
    fn is_coloured(&self) -> bool {
        let optional = [self.sigma_s_per_mm, self.g, self.sigma_s_reduced_per_mm];
        let all =
            [self.sigma_a_per_mm, self.refractive_index].into_iter().chain(optional.into_iter().flatten());
        all.into_iter().any(Coefficient::is_coloured)
    }

    fn layer(&self, channel: usize) -> Result<TissueLayer> {
        let reduced_per_mm = self.sigma_s_reduced_per_mm(channel)?;
        let (sigma_a, index) = (self.sigma_a_per_mm.of(channel), self.refractive_index.of(channel));
        let medium = Medium::new(sigma_a, reduced_per_mm, index).map_err(|error| miette!("{error}"))?;
        Ok(TissueLayer { medium, thickness_mm: self.thickness_mm.unwrap_or(f64::INFINITY) })
    }

    fn sigma_s_reduced_per_mm(&self, channel: usize) -> Result<f64> {
        match (self.sigma_s_reduced_per_mm, self.sigma_s_per_mm, self.g) {
            (Some(reduced), None, None) => Ok(reduced.of(channel)),
            (None, Some(sigma_s), Some(g)) => {
                let g = g.of(channel);
                if !(-1.0..1.0).contains(&g) {
                    bail!("g must lie from -1 to below 1, got {g}");
                }
                Ok(sigma_s.of(channel) * (1.0 - g))
            }
            _ => Err(miette!("give either sigma_s_reduced_per_mm, or sigma_s_per_mm and g")),
        }
    }
}
