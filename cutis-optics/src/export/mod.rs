//! Kernels as text: constants and one function for shaders, rows for everything else.
//!
//! Every text carries the material, where its profile comes from, the units, the energy and the error of the fit. Names are
//! the same in all languages: `CUTIS_GAUSSIANS`, `CUTIS_VARIANCES_MM2`, `CUTIS_WEIGHTS`,
//! `cutis_diffuse_reflectance_per_mm2(r_mm)`.
//! The WGSL and the GLSL are parsed and validated in the tests; HLSL is not checked by a machine.

mod glsl;
mod hlsl;
mod rows;
mod wgsl;

use crate::{Fit, GaussianSum, RgbFit, RgbGaussianSum};

/// A kernel with what belongs beside it.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct KernelTable {
    /// Name of the material.
    pub material: String,
    /// Where the profile comes from: its model, and the data behind it.
    pub source: String,
    /// Variances along one axis, growing, mm².
    pub variances_mm2: Vec<f64>,
    /// Weights, as many as variances.
    pub weights: Weights,
    /// Σ w of each channel.
    pub energy: Vec<f64>,
    /// Relative RMS power error of each channel; empty for a kernel that was not fitted.
    pub relative_rms_power_error: Vec<f64>,
}

/// Weights of one channel or of three.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[serde(untagged)]
pub enum Weights {
    /// One channel.
    Single(Vec<f64>),
    /// Red, green, blue.
    Rgb(Vec<[f64; 3]>),
}

impl KernelTable {
    /// A kernel of three channels.
    pub fn rgb(material: &str, source: &str, kernel: &RgbGaussianSum) -> Self {
        Self {
            material: material.to_owned(),
            source: source.to_owned(),
            variances_mm2: kernel.variances_mm2.clone(),
            weights: Weights::Rgb(kernel.weights.clone()),
            energy: kernel.totals().to_vec(),
            relative_rms_power_error: Vec::new(),
        }
    }

    /// A kernel of one channel.
    pub fn single(material: &str, source: &str, sum: &GaussianSum) -> Self {
        Self {
            material: material.to_owned(),
            source: source.to_owned(),
            variances_mm2: sum.terms.iter().map(|g| g.variance_mm2).collect(),
            weights: Weights::Single(sum.terms.iter().map(|g| g.weight).collect()),
            energy: vec![sum.energy()],
            relative_rms_power_error: Vec::new(),
        }
    }

    /// A joint fit of three channels, with its errors.
    pub fn from_rgb_fit(material: &str, source: &str, fit: &RgbFit) -> Self {
        Self {
            relative_rms_power_error: fit.relative_rms_power_error.to_vec(),
            ..Self::rgb(material, source, &fit.kernel)
        }
    }

    /// A fit of one channel, with its error.
    pub fn from_fit(material: &str, source: &str, fit: &Fit) -> Self {
        Self {
            relative_rms_power_error: vec![fit.relative_rms_power_error],
            ..Self::single(material, source, &fit.sum)
        }
    }

    /// Constants and a function in WGSL.
    pub fn to_wgsl(&self) -> String {
        wgsl::table(self)
    }

    /// Constants and a function in GLSL, for versions 300 es and 330 or newer.
    pub fn to_glsl(&self) -> String {
        glsl::table(self)
    }

    /// Constants and a function in HLSL, for shader model 4 or newer.
    pub fn to_hlsl(&self) -> String {
        hlsl::table(self)
    }

    /// A line per Gaussian, under a comment and a header that names the units.
    pub fn to_csv(&self) -> String {
        rows::csv(self)
    }

    /// One JSON object, units in the names.
    pub fn to_json(&self) -> String {
        rows::json(self)
    }

    /// What is said of the kernel, line by line.
    fn remarks(&self) -> Vec<String> {
        let list = |values: &[f64], digits: usize| {
            values.iter().map(|v| format!("{v:.digits$}")).collect::<Vec<_>>().join(" ")
        };
        let errors: Vec<f64> = self.relative_rms_power_error.iter().map(|e| 100.0 * e).collect();
        let error =
            if errors.is_empty() { "not a fit".to_owned() } else { format!("{} %", list(&errors, 4)) };
        vec![
            format!("Diffusion kernel of {}, a sum of {} Gaussians.", one_line(&self.material), self.variances_mm2.len()),
            format!("Source: {}.", one_line(&self.source)),
            "R(r) = sum of w exp(-r^2/2v)/(2 pi v), in 1/mm^2; r in mm, variances v in mm^2, weights w without unit."
                .to_owned(),
            format!("Energy (sum of weights): {}. Relative RMS power error: {error}.", list(&self.energy, 6)),
        ]
    }
}

/// A name that cannot leave the comment it stands in.
fn one_line(text: &str) -> String {
    // Some languages end a line at any separator of Unicode's, and go on with it after a backslash.
    let ends_line = |c: char| c.is_control() || c.is_whitespace() || c == '\\';
    text.chars().map(|c| if ends_line(c) { ' ' } else { c }).collect()
}

/// A number that every shading language reads as a float of single precision.
#[allow(clippy::cast_possible_truncation, reason = "shaders compute in single precision")]
fn float(value: f64) -> String {
    format!("{:?}", value as f32)
}

/// Items one per line, indented, with commas between.
fn lines(items: impl Iterator<Item = String>) -> String {
    items.map(|item| format!("    {item}")).collect::<Vec<_>>().join(",\n")
}

/// The same remarks as comments of a language.
fn comments(table: &KernelTable, mark: &str) -> String {
    table.remarks().iter().map(|line| format!("{mark} {line}\n")).collect()
}

#[cfg(test)]
mod tests;
