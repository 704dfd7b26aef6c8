//! Files for shaders, tables and other renderers.

use super::{Profiled, radial};
use crate::cli::ProfileArgs;
use cutis_optics::translate::{GltfDraft, Subject, Target, Translation, translate};
use miette::{Result, bail, miette};
use std::path::{Path, PathBuf};

/// What a file holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Format {
    Json,
    Csv,
    /// R(r), and T(r) where there is any, by radius.
    RadialCsv,
    Wgsl,
    Glsl,
    Hlsl,
    /// A material for another renderer.
    For(Target, GltfDraft),
}

/// A file to write.
#[derive(Debug, Clone)]
pub struct Export {
    pub path: PathBuf,
    pub format: Format,
}

const TABLES: [(&str, Format); 6] = [
    ("json", Format::Json),
    ("csv", Format::Csv),
    ("radial-csv", Format::RadialCsv),
    ("wgsl", Format::Wgsl),
    ("glsl", Format::Glsl),
    ("hlsl", Format::Hlsl),
];

/// Names that `--export-as` takes.
pub fn format_names() -> Vec<String> {
    let tables = TABLES.iter().map(|(name, _)| (*name).to_owned());
    tables.chain(Target::ALL.iter().map(Target::to_string)).collect()
}

impl Export {
    /// All files asked for, each with its format.
    pub fn all(args: &ProfileArgs) -> Result<Vec<Self>> {
        let (files, names) = (args.export.len(), args.export_as.len());
        if names > 0 && names != files {
            bail!(
                "--export-as is given {names} times for {files} files: give it once for each --export, in the same order, or not at all"
            );
        }
        let draft = match args.drafts.as_deref() {
            None => GltfDraft::None,
            Some("scatter") => GltfDraft::Scatter,
            Some(_) => GltfDraft::VolumeScatter,
        };
        let export = |(i, path): (usize, &PathBuf)| {
            let format = match args.export_as.get(i) {
                Some(name) => by_name(name, draft),
                None => by_extension(path, draft),
            };
            Ok(Self { path: path.clone(), format: format? })
        };
        args.export.iter().enumerate().map(export).collect()
    }

    /// Whether it is a material for another renderer.
    pub fn is_translation(&self) -> bool {
        matches!(self.format, Format::For(..))
    }

    /// What the file is to hold. A translation is given along, because its loss belongs into the report.
    pub fn render(&self, profiled: &Profiled) -> Result<(String, Option<Translation>)> {
        let table = || profiled.table();
        Ok(match self.format {
            Format::Json => (table().to_json(), None),
            Format::Csv => (table().to_csv(), None),
            Format::RadialCsv => (radial::csv(profiled), None),
            Format::Wgsl => (table().to_wgsl(), None),
            Format::Glsl => (table().to_glsl(), None),
            Format::Hlsl => (table().to_hlsl(), None),
            Format::For(target, draft) => {
                let translation = translated(profiled, target, draft)?;
                (translation.text.clone(), Some(translation))
            }
        })
    }
}

fn by_name(name: &str, draft: GltfDraft) -> Result<Format> {
    let table = TABLES.iter().find(|(known, _)| *known == name).map(|(_, format)| *format);
    let target = || Target::ALL.into_iter().find(|target| target.to_string() == name);
    table
        .or_else(|| Some(Format::For(target()?, draft)))
        .ok_or_else(|| miette!("--export-as: there is no '{name}'"))
}

fn by_extension(path: &Path, draft: GltfDraft) -> Result<Format> {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    match extension.as_str() {
        "mtlx" => Ok(Format::For(Target::OpenPbr, draft)),
        "gltf" => Ok(Format::For(Target::Gltf, draft)),
        _ => TABLES.iter().find(|(known, _)| *known == extension).map(|(_, format)| *format).ok_or_else(|| {
            miette!(
                "{}: the extension must be .json, .csv, .wgsl, .glsl, .hlsl, .mtlx or .gltf, or --export-as must say the format",
                path.display()
            )
        }),
    }
}

/// The three channels in the words of another renderer; a grey material is the same in all of them.
fn translated(profiled: &Profiled, target: Target, draft: GltfDraft) -> Result<Translation> {
    let channels = &profiled.channels;
    let of = |c: usize| &channels[c.min(channels.len() - 1)];
    let kernel = profiled.kernel();
    let subject = Subject {
        name: &profiled.material.name,
        profiles: [&*of(0).profile, &*of(1).profile, &*of(2).profile],
        kernel: &kernel,
        refractive_index: profiled.material.refractive_index(),
        mean_free_path_mm: [0, 1, 2].map(|c| of(c).mean_free_path_mm()),
    };
    translate(&subject, target, draft).map_err(|error| miette!("{target}: {error}"))
}
