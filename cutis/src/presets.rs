//! `cutis presets`: what ships inside.

use crate::cli::{DIFFUSIONS, PresetsArgs};
use crate::techniques::paper::Paper;
use crate::{Outcome, talk};
use cutis_optics::presets::{self, Preset};
use cutis_optics::{Medium, RgbGaussianSum};
use cutis_render::film::ToneMapper;
use cutis_render::{Aov, Settings, TechniqueName};
use miette::IntoDiagnostic;
use serde::Serialize;
use std::fmt::Write;

/// Everything there is, for `--json`.
#[derive(Debug, Serialize)]
struct Inventory {
    materials: Vec<Material>,
    heads: Vec<Named>,
    environments: Vec<Named>,
    techniques: Vec<String>,
    papers: Vec<String>,
    diffusions: Vec<String>,
    tone_mappers: Vec<String>,
    layers: Vec<String>,
}

/// A material with its numbers; those it does not have are null.
#[derive(Debug, Serialize)]
struct Material {
    name: &'static str,
    source: &'static str,
    /// Whether it is a measured medium, rather than a finished kernel.
    measured: bool,
    /// Red, green, blue.
    sigma_a_per_mm: Option<[f64; 3]>,
    sigma_s_reduced_per_mm: Option<[f64; 3]>,
    refractive_index: Option<f64>,
    /// The sum of Gaussians that renders it.
    kernel: Option<RgbGaussianSum>,
}

#[derive(Debug, Serialize)]
struct Named {
    name: &'static str,
    description: &'static str,
}

/// Prints the list.
pub fn run(args: &PresetsArgs) -> miette::Result<Outcome> {
    let inventory = Inventory::new();
    if args.json {
        talk::say(&serde_json::to_string_pretty(&inventory).into_diagnostic()?)?;
    } else {
        talk::say(inventory.table().trim_end())?;
    }
    Ok(Outcome::Done)
}

impl Inventory {
    fn new() -> Self {
        Self {
            materials: presets::all().iter().map(Material::new).collect(),
            heads: vec![Named {
                name: "built-in",
                description: "made by code; rendered when no SCENE is given",
            }],
            environments: vec![Named {
                name: "studio",
                description: "made by code, with key and rim light; around the built-in head and scenes without light",
            }],
            techniques: TechniqueName::ALL.iter().map(ToString::to_string).collect(),
            papers: Paper::ALL.map(|paper| paper.to_string()).to_vec(),
            diffusions: DIFFUSIONS.map(|d| d.to_string()).to_vec(),
            tone_mappers: ToneMapper::ALL.map(|t| t.to_string()).to_vec(),
            layers: Aov::all().iter().map(Aov::to_string).collect(),
        }
    }

    fn table(&self) -> String {
        let mut text =
            String::from("materials            sigma_a [1/mm] r g b        sigma_s' [1/mm] r g b    index\n");
        for material in &self.materials {
            text.push_str(&material.row());
        }
        for (title, list) in [("heads", &self.heads), ("environments", &self.environments)] {
            for Named { name, description } in list {
                let _ = writeln!(text, "{title:20} {name}: {description}"); // writing to a String cannot fail
            }
        }
        let lists = [
            ("techniques", &self.techniques),
            ("papers (--as-in)", &self.papers),
            ("diffusions", &self.diffusions),
            ("tone mappers", &self.tone_mappers),
            ("layers (--aov)", &self.layers),
        ];
        for (title, names) in lists {
            let _ = writeln!(text, "{title:20} {}", names.join(", "));
        }
        text
    }
}

impl Material {
    fn new(preset: &Preset) -> Self {
        let media = preset.media();
        let channels = |value: fn(&Medium) -> f64| media.map(|media| media.each_ref().map(value));
        Self {
            name: preset.name,
            source: preset.source,
            measured: media.is_some(),
            sigma_a_per_mm: channels(|medium| medium.sigma_a_per_mm),
            sigma_s_reduced_per_mm: channels(|medium| medium.sigma_s_reduced_per_mm),
            refractive_index: media.map(|media| media[0].refractive_index),
            kernel: preset.kernel(Settings::default().gaussians).ok(),
        }
    }

    fn row(&self) -> String {
        let (Some(a), Some(s), Some(n)) =
            (self.sigma_a_per_mm, self.sigma_s_reduced_per_mm, self.refractive_index)
        else {
            return format!("  {:18} {}\n", self.name, self.source);
        };
        format!(
            "  {:18} {:<8} {:<8} {:<8} {:<8} {:<8} {:<8} {n}\n",
            self.name, a[0], a[1], a[2], s[0], s[1], s[2]
        )
    }
}
