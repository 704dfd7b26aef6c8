//! One of the things that are compared: a technique, and with it how light spreads.

use crate::cli::DIFFUSIONS;
use cutis_render::{Diffusion, Settings, TechniqueName};
use std::fmt;
use std::str::FromStr;

/// A technique with a diffusion operator, written `technique` or `technique/diffusion`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    pub technique: TechniqueName,
    pub diffusion: Diffusion,
}

impl Entry {
    /// A technique with the usual diffusion.
    pub fn usual(technique: TechniqueName) -> Self {
        Self { technique, diffusion: Settings::default().diffusion }
    }
}

impl FromStr for Entry {
    type Err = String;

    fn from_str(words: &str) -> Result<Self, Self::Err> {
        let (technique, diffusion) =
            words.trim().split_once('/').map_or((words, None), |(t, d)| (t, Some(d)));
        let usual = Self::usual(technique.trim().parse()?);
        let Some(name) = diffusion.map(str::trim) else { return Ok(usual) };
        let known = DIFFUSIONS.into_iter().find(|known| known.to_string() == name);
        known.map(|diffusion| Self { diffusion, ..usual }).ok_or_else(|| {
            let names = DIFFUSIONS.map(|known| known.to_string()).join(", ");
            format!("there is no diffusion '{name}'; there are {names}")
        })
    }
}

impl fmt::Display for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { technique, diffusion } = self;
        if *self == Self::usual(*technique) {
            write!(f, "{technique}")
        } else {
            write!(f, "{technique}/{diffusion}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_read_back() {
        for technique in TechniqueName::ALL {
            for diffusion in DIFFUSIONS {
                let entry = Entry { technique: *technique, diffusion };
                assert_eq!(entry.to_string().parse(), Ok(entry));
                assert_eq!(format!(" {technique} / {diffusion}").parse(), Ok(entry));
            }
        }
    }

    #[test]
    fn nonsense_is_refused_with_what_there_is() {
        let refused = |words: &str| words.parse::<Entry>().expect_err("nonsense");
        assert!(refused("magic").contains("there is no technique 'magic'; there are"));
        assert!(refused("texture-space/magic").contains("there is no diffusion 'magic'; there are none"));
        assert!(refused("texture-space/none/none").contains("'none/none'"));
        assert!(refused("").contains("''"));
    }
}
