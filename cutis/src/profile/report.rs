//! The result as data, for `--json` and for the table.

use super::Profiled;
use super::channel::{Channel, method_name};
use super::explain::Explanation;
use super::radial::{RadialProfile, radii_mm};
use cutis_optics::TissueLayer;
use cutis_optics::translate::{ChannelLoss, Field, Translation};
use serde::Serialize;

/// Everything.
pub struct Report {
    pub material: String,
    pub origin: String,
    pub source: String,
    pub channels: Vec<ChannelReport>,
    pub joint_kernel: Option<JointReport>,
    pub translations: Vec<TranslationReport>,
    pub wall_seconds: f64,
}

/// A channel; on its own it is the whole object of `--json`.
#[derive(Serialize)]
pub struct ChannelReport {
    pub material: String,
    /// `r`, `g`, `b`; null where all channels are the same.
    pub channel: Option<&'static str>,
    pub source: String,
    pub layers: Vec<LayerReport>,
    pub total_diffuse_reflectance: f64,
    /// Of layers that end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub total_transmittance: Option<f64>,
    /// R(r) and T(r), of layers that end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radial_profile: Option<RadialProfile>,
    /// Of a simulated one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub total_diffuse_reflectance_standard_error: Option<f64>,
    /// Width of the beam; null for a point.
    pub beam_standard_deviation_mm: Option<f64>,
    pub fit: FitReport,
    pub warnings: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub explanation: Option<Explanation>,
    pub wall_seconds: f64,
}

/// A layer; infinite thickness is null.
#[derive(Serialize)]
pub struct LayerReport {
    pub sigma_a_per_mm: f64,
    pub sigma_s_reduced_per_mm: f64,
    pub thickness_mm: Option<f64>,
    pub refractive_index: f64,
}

/// A sum of Gaussians.
#[derive(Serialize)]
pub struct FitReport {
    pub method: &'static str,
    pub weights: Vec<f64>,
    pub variances_mm2: Vec<f64>,
    pub relative_rms_power_error: f64,
    pub energy: f64,
    pub worst_absolute_error_per_mm2: f64,
    pub worst_error_at_mm: f64,
}

/// One kernel for three channels.
#[derive(Serialize)]
pub struct JointReport {
    pub method: &'static str,
    pub variances_mm2: Vec<f64>,
    /// Red, green, blue for each variance.
    pub weights: Vec<[f64; 3]>,
    pub relative_rms_power_error: [f64; 3],
    pub energy: [f64; 3],
}

/// A material in another renderer's words.
#[derive(Serialize)]
pub struct TranslationReport {
    pub target: String,
    pub place: &'static str,
    pub fields: Vec<Field>,
    pub notes: Vec<String>,
    /// Red, green, blue.
    pub loss: [ChannelLoss; 3],
}

#[derive(Serialize)]
struct Whole<'a> {
    version: &'static str,
    origin: &'a str,
    #[serde(flatten)]
    what: What<'a>,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    translations: &'a [TranslationReport],
}

#[derive(Serialize)]
#[serde(untagged)]
enum What<'a> {
    One(&'a ChannelReport),
    Three {
        material: &'a str,
        source: &'a str,
        channels: &'a [ChannelReport],
        #[serde(skip_serializing_if = "Option::is_none")]
        joint_kernel: Option<&'a JointReport>,
        wall_seconds: f64,
    },
}

impl Report {
    pub fn new(
        profiled: &Profiled,
        explanations: Option<Vec<Explanation>>,
        translations: Vec<Translation>,
        wall_seconds: f64,
    ) -> Self {
        let mut explanations = explanations.unwrap_or_default().into_iter();
        let name = &profiled.material.name;
        let r_mm = radii_mm(&profiled.channels);
        let channel = |channel: &Channel| ChannelReport::new(name, channel, &r_mm, explanations.next());
        Self {
            material: name.clone(),
            origin: profiled.material.origin.clone(),
            source: profiled.channels[0].source_name(),
            channels: profiled.channels.iter().map(channel).collect(),
            joint_kernel: JointReport::of(profiled),
            translations: translations.into_iter().map(TranslationReport::new).collect(),
            wall_seconds,
        }
    }

    /// One object: flat for one channel, with `channels` for three.
    pub fn json(&self) -> serde_json::Result<String> {
        let what = match self.channels.as_slice() {
            [only] => What::One(only),
            channels => What::Three {
                material: &self.material,
                source: &self.source,
                channels,
                joint_kernel: self.joint_kernel.as_ref(),
                wall_seconds: self.wall_seconds,
            },
        };
        serde_json::to_string_pretty(&Whole {
            version: env!("CARGO_PKG_VERSION"),
            origin: &self.origin,
            what,
            translations: &self.translations,
        })
    }
}

impl ChannelReport {
    fn new(material: &str, channel: &Channel, r_mm: &[f64], explanation: Option<Explanation>) -> Self {
        let sum = channel.sum.sum();
        let ends = channel.transmitted.is_some();
        Self {
            material: material.to_owned(),
            channel: channel.name,
            source: channel.source_name(),
            layers: channel.layers.iter().map(LayerReport::new).collect(),
            total_diffuse_reflectance: channel.profile.total(),
            total_transmittance: channel.total_transmittance().filter(|_| ends),
            radial_profile: ends.then(|| RadialProfile::new(channel, r_mm)),
            total_diffuse_reflectance_standard_error: channel.total_standard_error,
            beam_standard_deviation_mm: channel.beam_standard_deviation_mm,
            fit: FitReport {
                method: channel.sum.method(),
                weights: sum.terms.iter().map(|g| g.weight).collect(),
                variances_mm2: sum.terms.iter().map(|g| g.variance_mm2).collect(),
                relative_rms_power_error: channel.sum.error(),
                energy: sum.energy(),
                worst_absolute_error_per_mm2: channel.worst.error_per_mm2,
                worst_error_at_mm: channel.worst.r_mm,
            },
            warnings: channel.warnings(),
            explanation,
            wall_seconds: channel.wall_seconds,
        }
    }
}

impl LayerReport {
    fn new(layer: &TissueLayer) -> Self {
        Self {
            sigma_a_per_mm: layer.medium.sigma_a_per_mm,
            sigma_s_reduced_per_mm: layer.medium.sigma_s_reduced_per_mm,
            thickness_mm: layer.thickness_mm.is_finite().then_some(layer.thickness_mm),
            refractive_index: layer.medium.refractive_index,
        }
    }
}

impl JointReport {
    /// None for a single channel.
    fn of(profiled: &Profiled) -> Option<Self> {
        let kernel = profiled.kernel();
        let errors = profiled.joint.as_ref().map_or([0.0; 3], |fit| fit.relative_rms_power_error);
        (profiled.channels.len() == 3).then(|| Self {
            method: profiled.joint.as_ref().map_or("given", |fit| method_name(fit.method)),
            energy: kernel.totals(),
            variances_mm2: kernel.variances_mm2,
            weights: kernel.weights,
            relative_rms_power_error: errors,
        })
    }
}

impl TranslationReport {
    fn new(translation: Translation) -> Self {
        Self {
            target: translation.target.to_string(),
            place: translation.place,
            fields: translation.fields,
            notes: translation.notes,
            loss: translation.loss,
        }
    }
}
