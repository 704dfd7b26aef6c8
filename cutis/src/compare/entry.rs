//! One of the things that are compared: a technique, its numbers, and with it how light spreads.

use crate::cli::{DIFFUSIONS, TechniqueArgs};
use crate::techniques::{fulfilled, idle, wishes};
use clap::{Args, Command, FromArgMatches};
use cutis_render::settings::TechniqueSettings;
use cutis_render::{Diffusion, Settings, TechniqueName};
use std::fmt;
use std::str::FromStr;

/// A technique with its own numbers and a diffusion operator, written `technique`, `technique/diffusion` or
/// `technique:flag=value:flag=value/diffusion`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entry {
    pub technique: TechniqueName,
    pub diffusion: Diffusion,
    /// Flags of the technique with their values, `flag=value`, in the order in which they were given.
    pub flags: Vec<String>,
}

impl Entry {
    /// A technique with the usual diffusion.
    pub fn usual(technique: TechniqueName) -> Self {
        Self { technique, diffusion: Settings::default().diffusion, flags: Vec::new() }
    }

    /// Settings with its own numbers in them.
    ///
    /// # Errors
    /// Names a flag that is not known, belongs to another technique, or has a value out of its range.
    pub fn techniques(&self, settings: TechniqueSettings) -> Result<TechniqueSettings, String> {
        if self.flags.iter().any(String::is_empty) {
            return Err("a flag must follow each ':', such as profile-samples=64".to_owned());
        }
        let command =
            TechniqueArgs::augment_args(Command::new("entry").no_binary_name(true).disable_help_flag(true));
        let words = self.flags.iter().map(|flag| format!("--{flag}"));
        let matches = command.try_get_matches_from(words).map_err(|error| crate::cli::one_line(&error))?;
        let args = TechniqueArgs::from_arg_matches(&matches).map_err(|error| crate::cli::one_line(&error))?;
        let mut warnings = Vec::new();
        let wishes = wishes(&args, &mut warnings).map_err(|error| error.to_string())?;
        if let Some(words) = idle(&wishes, self.technique).first() {
            return Err(words.clone());
        }
        fulfilled(settings, wishes).map_err(|error| error.to_string())
    }
}

/// Entries of a list with commas; a comma before a number belongs to a value, such as a colour.
pub fn entries_of(list: &str) -> Vec<String> {
    let mut entries: Vec<String> = Vec::new();
    for piece in list.split(',') {
        let is_number = piece.trim().parse::<f32>().is_ok() || starts_with_number(piece.trim());
        match entries.last_mut().filter(|_| is_number) {
            Some(entry) => *entry = format!("{entry},{piece}"),
            None => entries.push(piece.to_owned()),
        }
    }
    entries
}

/// Whether a value goes on with other flags behind it: `0.5:wrap=0.3` or `0/none`.
fn starts_with_number(piece: &str) -> bool {
    piece.split([':', '/', ';']).next().is_some_and(|first| first.parse::<f32>().is_ok())
}

impl FromStr for Entry {
    type Err = String;

    fn from_str(words: &str) -> Result<Self, Self::Err> {
        let (head, diffusion) = words.trim().split_once('/').map_or((words, None), |(t, d)| (t, Some(d)));
        let (technique, flags) = head.split_once(':').map_or((head, None), |(t, f)| (t, Some(f)));
        let flags = flags.iter().flat_map(|flags| flags.split(':')).map(|flag| flag.trim().to_owned());
        let entry = Self { flags: flags.collect(), ..Self::usual(technique.trim().parse()?) };
        entry.techniques(TechniqueSettings::default()).map_err(|why| format!("{}: {why}", head.trim()))?;
        let Some(name) = diffusion.map(str::trim) else { return Ok(entry) };
        let known = DIFFUSIONS.into_iter().find(|known| known.to_string() == name);
        known.map(|diffusion| Self { diffusion, ..entry }).ok_or_else(|| {
            let names = DIFFUSIONS.map(|known| known.to_string()).join(", ");
            format!("there is no diffusion '{name}'; there are {names}")
        })
    }
}

impl fmt::Display for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { technique, diffusion, flags } = self;
        write!(f, "{technique}")?;
        flags.iter().try_for_each(|flag| write!(f, ":{flag}"))?;
        if *diffusion == Self::usual(*technique).diffusion { Ok(()) } else { write!(f, "/{diffusion}") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_read_back() {
        for technique in TechniqueName::ALL {
            for diffusion in DIFFUSIONS {
                let entry = Entry { diffusion, ..Entry::usual(*technique) };
                assert_eq!(entry.to_string().parse(), Ok(entry.clone()));
                assert_eq!(format!(" {technique} / {diffusion}").parse(), Ok(entry));
            }
        }
    }

    #[test]
    fn numbers_of_a_technique_are_its_own_flags() {
        let entry: Entry = "image-space:profile-samples=64: jacobian=off".parse().expect("is sound");
        assert_eq!(entry.to_string(), "image-space:profile-samples=64:jacobian=off");
        let settings = entry.techniques(TechniqueSettings::default()).expect("is sound").image_space;
        assert_eq!((settings.samples, settings.jacobian), (64, false));
        let red: Entry = "wrap:scatter-colour=0.5,0,0:wrap=0.4/none".parse().expect("is sound");
        assert_eq!(red.diffusion, Diffusion::None);
        assert_eq!(
            red.techniques(TechniqueSettings::default()).expect("is sound").wrap.scatter_colour.x,
            0.5
        );
    }

    #[test]
    fn commas_before_numbers_belong_to_values() {
        let list = "wrap:scatter-colour=0.5,0,-1e-1:wrap=0.4,image-space,depth-absorption:sigma-t=1,2,3/none";
        let entries = entries_of(list);
        assert_eq!(entries.len(), 3, "{entries:?}");
        assert_eq!(entries[0], "wrap:scatter-colour=0.5,0,-1e-1:wrap=0.4");
        assert_eq!(entries[2], "depth-absorption:sigma-t=1,2,3/none");
        assert_eq!(entries_of("texture-space,"), ["texture-space", ""]);
    }

    #[test]
    fn nonsense_is_refused_with_what_there_is() {
        let refused = |words: &str| words.parse::<Entry>().expect_err("nonsense");
        assert!(refused("magic").contains("there is no technique 'magic'; there are"));
        assert!(refused("texture-space/magic").contains("there is no diffusion 'magic'; there are none"));
        assert!(refused("texture-space/none/none").contains("'none/none'"));
        assert!(refused("").contains("''"));
        assert!(refused("wrap:wrap=2").contains("wrap:wrap=2: --wrap: wrap must be 0 to 1, got 2"));
        assert!(refused("wrap:jacobian=on").contains("--jacobian has no effect: the technique is wrap"));
        assert!(refused("wrap:magic=1").contains("--magic"));
        assert!(refused("wrap:").contains("a flag must follow"));
    }
}
