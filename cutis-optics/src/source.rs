//! Which model makes a profile of layers: names, and one place where each is built.

use crate::{Dipole, MediumError, Profile, Stack, StackError, TissueLayer};

/// A model that turns layers into a profile.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProfileSource {
    /// [`Dipole`], for one half-space.
    Dipole,
    /// [`Stack`] of multipoles, for any layers thicker than their mean free paths.
    Multipole,
}

/// No source of that name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("there is no source of profiles {name:?}; there are {}", names())]
pub struct UnknownSource {
    /// The name asked for.
    pub name: String,
}

/// Why a source has no profile for some layers.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SourceError {
    /// Layers, where there may be none.
    #[error(
        "the dipole is for one infinitely thick layer, not for {layers} or a finite one; use the source multipole"
    )]
    NotHalfSpace {
        /// How many layers there are.
        layers: usize,
    },
    /// The medium cannot be.
    #[error("layer 1: {0}")]
    Medium(#[from] MediumError),
    /// The stack cannot be.
    #[error(transparent)]
    Stack(#[from] StackError),
}

impl ProfileSource {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Dipole, Self::Multipole];

    /// The dipole for one half-space, the multipole for everything else.
    pub fn default_for(layers: &[TissueLayer]) -> Self {
        if is_half_space(layers) { Self::Dipole } else { Self::Multipole }
    }

    /// The profile of the reflectance of layers under air, top first.
    pub fn profile(self, layers: &[TissueLayer]) -> Result<Box<dyn Profile + Send + Sync>, SourceError> {
        match self {
            Self::Dipole if !is_half_space(layers) => Err(SourceError::NotHalfSpace { layers: layers.len() }),
            Self::Dipole => Ok(Box::new(Dipole::new(&layers[0].medium)?)),
            Self::Multipole => Ok(Box::new(Stack::in_air(layers)?)),
        }
    }
}

impl core::fmt::Display for ProfileSource {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Dipole => "dipole",
            Self::Multipole => "multipole",
        })
    }
}

impl core::str::FromStr for ProfileSource {
    type Err = UnknownSource;

    fn from_str(name: &str) -> Result<Self, UnknownSource> {
        let known = Self::ALL.into_iter().find(|source| source.to_string() == name);
        known.ok_or_else(|| UnknownSource { name: name.to_owned() })
    }
}

fn is_half_space(layers: &[TissueLayer]) -> bool {
    layers.len() == 1 && layers[0].thickness_mm == f64::INFINITY
}

fn names() -> String {
    ProfileSource::ALL.map(|source| source.to_string()).join(", ")
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::Medium;

    fn layer(thickness_mm: f64) -> TissueLayer {
        TissueLayer { medium: Medium::new(0.1, 3.0, 1.4).unwrap(), thickness_mm }
    }

    #[test]
    fn names_lead_back_to_their_sources() {
        for source in ProfileSource::ALL {
            assert_eq!(source.to_string().parse(), Ok(source));
        }
        let told = "tripole".parse::<ProfileSource>().unwrap_err().to_string();
        assert!(told.contains("tripole") && told.contains("dipole, multipole"), "{told}");
    }

    #[test]
    fn a_half_space_is_the_same_from_both_and_layers_are_no_dipole() {
        let endless = [layer(f64::INFINITY)];
        assert_eq!(ProfileSource::default_for(&endless), ProfileSource::Dipole);
        let [dipole, stack] = ProfileSource::ALL.map(|source| source.profile(&endless).unwrap());
        assert_eq!(dipole.spectrum(0.7), stack.spectrum(0.7));
        for layers in [vec![layer(1.0)], vec![layer(1.0), layer(f64::INFINITY)], vec![]] {
            assert_eq!(ProfileSource::default_for(&layers), ProfileSource::Multipole);
            let refused = ProfileSource::Dipole.profile(&layers).err().unwrap().to_string();
            assert!(refused.contains("multipole"), "{refused}");
        }
        assert!(ProfileSource::Multipole.profile(&[]).is_err());
    }
}
