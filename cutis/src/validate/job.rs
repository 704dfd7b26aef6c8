//! The arguments of `cutis validate`, checked.

use crate::cli::ValidateArgs;
use crate::compare::entry::{Entry, entries_of};
use crate::job::refused;
use cutis_render::settings::TechniqueSettings;
use cutis_render::{Aov, Diffusion, Settings, TechniqueName};
use cutis_scene::validation::{SCENES, ValidationScene};
use miette::{Result, bail, miette};
use std::path::PathBuf;

/// Width and height of the pictures: a stored file stays below 150 kB.
pub const SIZE: u32 = 96;
/// Paths per pixel of the truth, if nothing else is asked: one to three minutes per scene on two processors.
const TRUTH_SAMPLES: u32 = 1024;
/// From so many on truth believes its own noise.
const TRUTH_SAMPLES_MIN: u32 = 16;
/// Seed of every random choice.
const SEED: u64 = 1;

/// What is to be done.
pub struct Job {
    pub scenes: Vec<ValidationScene>,
    /// What is judged.
    pub entries: Vec<Entry>,
    pub folder: PathBuf,
    /// Whether the truth is rendered anew.
    pub update: bool,
    /// Whether what is measured is taken for the bounds.
    pub accept: bool,
    pub truth_samples: u32,
    /// Where pictures to look at go.
    pub pictures: Option<PathBuf>,
}

impl Job {
    /// Checks everything that can be checked before the work.
    pub fn new(args: &ValidateArgs) -> Result<Self> {
        let job = Self {
            scenes: scenes(&args.only)?,
            entries: entries(&args.techniques)?,
            folder: args.truth.clone(),
            update: args.update,
            accept: args.update || args.accept,
            truth_samples: args.samples.unwrap_or(TRUTH_SAMPLES),
            pictures: args.pictures.clone(),
        };
        if job.truth_samples < TRUTH_SAMPLES_MIN {
            bail!("--samples must be {TRUTH_SAMPLES_MIN} to 1048576, got {}", job.truth_samples);
        }
        job.truth_settings().check().map_err(refused)?;
        if let Some(folder) = job.pictures.as_ref().filter(|folder| !folder.is_dir()) {
            bail!("{}: there is no such folder for pictures", folder.display());
        }
        if !job.folder.is_dir() {
            bail!(
                help = "it lies in the project's folder; make one elsewhere with --truth and --update",
                "{}: there is no such folder of truth",
                job.folder.display()
            );
        }
        Ok(job)
    }

    /// Settings of an entry.
    pub fn settings(&self, entry: &Entry) -> Settings {
        Settings {
            technique: entry.technique,
            diffusion: entry.diffusion,
            // Read before, when the entries were.
            techniques: entry.techniques(TechniqueSettings::default()).unwrap_or_default(),
            width: SIZE,
            height: SIZE,
            samples_per_pixel: 16,
            irradiance_size: 1024,
            shadow_samples: 16,
            seed: SEED,
            // Without the light that the surface itself reflects, what is left came from below it.
            aovs: vec![Aov::Specular],
            ..Settings::default()
        }
    }

    /// Settings of the truth.
    pub fn truth_settings(&self) -> Settings {
        Settings {
            samples_per_pixel: self.truth_samples,
            aovs: vec![Aov::Specular, Aov::StandardError],
            ..self.settings(&Entry::usual(TechniqueName::Truth))
        }
    }

    /// The command that makes the truth of a scene again, to the bit.
    pub fn command(&self, scene: &str) -> String {
        format!("cutis validate --update --samples {} --only {scene}", self.truth_samples)
    }
}

/// Every technique but the truth itself, the blur of d'Eon, Luebke & Enderton 2007, and the opaque surface; only those that
/// are named, if some are, with numbers of their own where they are given.
fn entries(only: &[String]) -> Result<Vec<Entry>> {
    let judged = TechniqueName::ALL.iter().filter(|technique| **technique != TechniqueName::Truth);
    let others = [Diffusion::Separable, Diffusion::None];
    let others = others.map(|diffusion| Entry { diffusion, ..Entry::usual(TechniqueName::TextureSpace) });
    let all: Vec<_> = judged.map(|technique| Entry::usual(*technique)).chain(others).collect();
    let only: Vec<_> = only.iter().flat_map(|list| entries_of(list)).collect();
    if only.is_empty() {
        return Ok(all);
    }
    let known = || all.iter().map(Entry::to_string).collect::<Vec<_>>().join(", ");
    let entry = |name: &String| match all.iter().find(|entry| entry.to_string() == *name) {
        Some(entry) => Ok(entry.clone()),
        None if name.contains(':') && !name.starts_with("truth") => {
            name.parse::<Entry>().map_err(|why| miette!("--techniques: {why}"))
        }
        None => Err(miette!("--techniques: there is no entry '{name}'; there are {}", known())),
    };
    only.iter().map(entry).collect()
}

/// The scenes of these names in their usual order, each once; all if none are named.
fn scenes(only: &[String]) -> Result<Vec<ValidationScene>> {
    if let Some(unknown) = only.iter().find(|name| !SCENES.iter().any(|scene| scene.name == **name)) {
        let known = SCENES.map(|scene| scene.name).join(", ");
        bail!("--only: there is no scene '{unknown}'; there are {known}");
    }
    let wanted = |scene: &ValidationScene| only.is_empty() || only.iter().any(|name| name == scene.name);
    Ok(SCENES.into_iter().filter(wanted).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_truth_is_not_judged_and_all_else_is() {
        let names: Vec<_> = entries(&[]).expect("all").iter().map(Entry::to_string).collect();
        assert_eq!(
            names.len(),
            TechniqueName::ALL.len() + 1,
            "one less, the separable blur, the opaque surface"
        );
        let is_judged = |name: &str| names.iter().any(|known| known == name);
        assert!(
            !is_judged("truth") && is_judged("texture-space/separable") && is_judged("texture-space/none")
        );
        let of = |list: &str| entries(&[list.to_owned()]);
        let own = of("image-space:jacobian=off,wrap:scatter-colour=0.1,0,0").expect("are known");
        assert_eq!(own.iter().map(|entry| entry.flags.len()).collect::<Vec<_>>(), [1, 1]);
        for bad in ["truth:samples=4", "image-space:jacobian=maybe", "none"] {
            assert!(of(bad).expect_err(bad).to_string().starts_with("--techniques: "), "{bad}");
        }
    }

    #[test]
    fn scenes_come_once_and_in_their_order() {
        let names = |only: &[&str]| {
            let only: Vec<_> = only.iter().map(|&name| name.to_owned()).collect();
            scenes(&only).map(|scenes| scenes.iter().map(|scene| scene.name).collect::<Vec<_>>())
        };
        assert_eq!(names(&["gap", "sphere", "gap"]).expect("known"), ["sphere", "gap"]);
        assert_eq!(names(&[]).expect("all").len(), SCENES.len());
        let error = names(&["cube"]).expect_err("unknown").to_string();
        assert!(
            error.starts_with("--only: there is no scene 'cube'; there are shadow-edge, sphere"),
            "{error}"
        );
    }
}
