//! From our profiles to the parameters of other renderers, with what is lost on the way.
//!
//! Renderers disagree on what a "radius" is: a mean free path, a *diffuse* mean free path, the length of Burley's
//! exponential; in mm, cm, metres, or in no unit at all. Each translation says which length it writes, in which unit, and
//! measures ([`loss`]) the profile that the target will draw with it against ours. Two kinds of target:
//! - Burley engines ([`unreal`], [`hdrp`]) draw [`crate::Burley`]: the total becomes the albedo, the shape length is the one
//!   of least error.
//! - random walks ([`blender`], [`open_pbr`], drafts of [`gltf`]) draw a medium without Fresnel reflection at its inside
//!   ([`random_walk`]): the total becomes the colour, the mean free path is the one of least error.
//!
//! glTF as ratified draws no profile at all.

pub mod blender;
mod burley_fit;
pub mod gltf;
pub mod hdrp;
mod least;
pub mod loss;
pub mod open_pbr;
pub mod random_walk;
mod sheet;
pub mod unreal;

use crate::{Profile, RgbGaussianSum};
pub use gltf::GltfDraft;
pub use loss::ChannelLoss;

/// A renderer that materials are translated for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// Unreal Engine, subsurface profile with Burley's technique.
    Unreal,
    /// Unity HDRP, diffusion profile.
    Hdrp,
    /// Blender, Principled BSDF with the random walk.
    Blender,
    /// OpenPBR surface in a MaterialX document.
    OpenPbr,
    /// glTF 2.0 material.
    Gltf,
}

impl Target {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Unreal, Self::Hdrp, Self::Blender, Self::OpenPbr, Self::Gltf];
}

impl core::fmt::Display for Target {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Unreal => "unreal",
            Self::Hdrp => "hdrp",
            Self::Blender => "blender",
            Self::OpenPbr => "openpbr",
            Self::Gltf => "gltf",
        })
    }
}

/// What is translated: one profile for each of red, green, blue.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// Name of the material.
    pub name: &'a str,
    /// Profiles of red, green, blue.
    pub profiles: [&'a dyn Profile; 3],
    /// The same as sums of Gaussians: how much light a thickness lets through is read off them.
    pub kernel: &'a RgbGaussianSum,
    /// Refractive index relative to air.
    pub refractive_index: f64,
    /// Transport mean free paths, mm: they set the beams that errors are measured with ([`loss`]).
    pub mean_free_path_mm: [f64; 3],
}

/// A material in the words of another renderer.
#[derive(Debug, Clone, PartialEq)]
pub struct Translation {
    /// For whom.
    pub target: Target,
    /// Name of the material.
    pub material: String,
    /// Where to enter the fields.
    pub place: &'static str,
    /// The parameters.
    pub fields: Vec<Field>,
    /// Which length the target's radius is, and what else to know.
    pub notes: Vec<String>,
    /// What is lost in red, green, blue.
    pub loss: [ChannelLoss; 3],
    /// A file in the target's own form; a sheet to type in where it has none.
    pub text: String,
}

/// One parameter.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Field {
    /// In the target's spelling.
    pub name: &'static str,
    /// Six significant digits.
    pub value: Value,
    /// Unit, or "none".
    pub unit: &'static str,
    /// What it means, in a line.
    pub meaning: &'static str,
}

/// Value of a parameter.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[serde(untagged)]
pub enum Value {
    /// A switch.
    Flag(bool),
    /// A choice.
    Word(&'static str),
    /// A number.
    Number(f64),
    /// Red, green, blue.
    Rgb([f64; 3]),
}

/// Why there is no translation.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum TranslateError {
    /// Not a share of the light.
    #[error(
        "channel {channel} (0 red, 1 green, 2 blue): the total of the profile must lie above 0 and not above 1, got {total}"
    )]
    Total {
        /// Channel at fault.
        channel: usize,
        /// Its total.
        total: f64,
    },
    /// Not a length.
    #[error(
        "channel {channel} (0 red, 1 green, 2 blue): the mean free path must be finite and above 0 mm, got {value}"
    )]
    MeanFreePath {
        /// Channel at fault.
        channel: usize,
        /// What was given, mm.
        value: f64,
    },
}

/// Largest excess of a total over 1 that is rounding, not a mistake.
const ROUNDING: f64 = 1e-9;

/// Translates. `draft` counts for glTF alone.
pub fn translate(subject: &Subject, target: Target, draft: GltfDraft) -> Result<Translation, TranslateError> {
    subject.check()?;
    Ok(match target {
        Target::Unreal => unreal::translate(subject),
        Target::Hdrp => hdrp::translate(subject),
        Target::Blender => blender::translate(subject),
        Target::OpenPbr => open_pbr::translate(subject),
        Target::Gltf => gltf::translate(subject, draft),
    })
}

impl Subject<'_> {
    fn check(&self) -> Result<(), TranslateError> {
        for channel in 0..3 {
            let total = self.profiles[channel].total();
            if !(total > 0.0 && total <= 1.0 + ROUNDING) {
                return Err(TranslateError::Total { channel, total });
            }
            let value = self.mean_free_path_mm[channel];
            if !(value > 0.0 && value.is_finite()) {
                return Err(TranslateError::MeanFreePath { channel, value });
            }
        }
        Ok(())
    }

    /// Totals, none above 1.
    fn albedo(&self) -> [f64; 3] {
        self.profiles.map(|p| p.total().min(1.0))
    }

    /// Losses against what the target draws.
    fn loss(&self, drawn: [&dyn Profile; 3]) -> [ChannelLoss; 3] {
        [0, 1, 2].map(|c| ChannelLoss::between(self.profiles[c], drawn[c], self.mean_free_path_mm[c]))
    }
}

impl Field {
    fn number(name: &'static str, value: f64, unit: &'static str, meaning: &'static str) -> Self {
        Self { name, value: Value::Number(six_digits(value)), unit, meaning }
    }

    fn rgb(name: &'static str, value: [f64; 3], unit: &'static str, meaning: &'static str) -> Self {
        Self { name, value: Value::Rgb(value.map(six_digits)), unit, meaning }
    }

    fn flag(name: &'static str, value: bool, meaning: &'static str) -> Self {
        Self { name, value: Value::Flag(value), unit: "none", meaning }
    }

    fn word(name: &'static str, value: &'static str, meaning: &'static str) -> Self {
        Self { name, value: Value::Word(value), unit: "none", meaning }
    }
}

/// Six significant digits: all that a person types in, and more than the models are true to.
fn six_digits(value: f64) -> f64 {
    format!("{value:.5e}").parse().expect("a number was printed")
}

fn largest(values: [f64; 3]) -> f64 {
    values[0].max(values[1]).max(values[2])
}

#[cfg(test)]
mod tests;
