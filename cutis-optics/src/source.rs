//! The sources of a profile, behind one name each.
//!
//! Which to trust when: `docs/profiles.md` of the project, with errors against Monte Carlo.

use crate::powers::Powers;
use crate::{
    BetterDipole, Boundary, Dipole, Medium, MediumError, PhotonBeam, Pole, Profile, SingleScattering, Stack,
    StackError, TissueLayer,
};
use core::fmt;
use core::str::FromStr;

/// A profile that may be handed to another thread.
pub type BoxedProfile = Box<dyn Profile + Send + Sync>;

/// Where a profile comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ProfileSource {
    /// Diffusion with one source and one image (Jensen et al. 2001); half-spaces.
    Dipole,
    /// Grosjean's diffusion, and what was scattered once exactly (d'Eon 2012); half-spaces.
    BetterDipole,
    /// Slabs on slabs (Donner & Jensen 2005); any number of layers.
    Multipole,
    /// A line of sources, and what was scattered once exactly (Habel et al. 2013); half-spaces.
    Beam,
    /// No approximation but chance; any layers. It has to be simulated first ([`crate::simulate`]).
    MonteCarlo,
}

/// Why a source has no profile of some layers.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SourceError {
    /// The medium or a layer.
    #[error(transparent)]
    Medium(#[from] MediumError),
    /// The layers.
    #[error(transparent)]
    Stack(#[from] StackError),
    /// A theory of half-spaces was asked for layers.
    #[error(
        "the source {source_asked} is for one infinitely thick layer, not for {layers} or a finite one; use multipole or monte-carlo"
    )]
    HalfSpaceOnly {
        /// The source.
        source_asked: ProfileSource,
        /// Number of layers given.
        layers: usize,
    },
    /// A theory of smooth surfaces was asked for a rough one.
    #[error("the source {source_asked} knows smooth surfaces only; dipole and multipole know rough ones")]
    SmoothOnly {
        /// The source.
        source_asked: ProfileSource,
    },
    /// Nothing can be had without simulating.
    #[error("the source monte-carlo has to be simulated; it has no formula")]
    NotAnalytic,
}

impl ProfileSource {
    /// All of them.
    pub const ALL: [Self; 5] =
        [Self::Dipole, Self::BetterDipole, Self::Multipole, Self::Beam, Self::MonteCarlo];

    /// What to take for some layers unless told otherwise: the dipole for a half-space, else the multipole.
    pub fn default_for(layers: &[TissueLayer]) -> Self {
        if half_space(layers).is_some() { Self::Dipole } else { Self::Multipole }
    }

    /// Whether the profile goes as 1/r towards the point lit, because it holds what was scattered once: it can be fitted
    /// and measured only under a beam of some width ([`crate::WideBeam`]).
    pub fn has_peak(self) -> bool {
        matches!(self, Self::BetterDipole | Self::Beam | Self::MonteCarlo)
    }

    /// The reflectance of `layers` in air.
    ///
    /// # Errors
    /// If the layers cannot be, are not what the source knows, or have to be simulated.
    pub fn profile(self, layers: &[TissueLayer]) -> Result<BoxedProfile, SourceError> {
        let medium = || {
            let refuse = SourceError::HalfSpaceOnly { source_asked: self, layers: layers.len() };
            half_space(layers).ok_or(refuse)
        };
        match self {
            Self::Dipole => Ok(Box::new(Dipole::new(medium()?)?)),
            Self::Multipole => Ok(Box::new(Stack::in_air(layers)?)),
            Self::BetterDipole => {
                let medium = medium()?;
                Ok(Box::new(Together(BetterDipole::new(medium)?, SingleScattering::new(medium)?)))
            }
            Self::Beam => {
                let medium = medium()?;
                Ok(Box::new(Together(PhotonBeam::new(medium)?, SingleScattering::new(medium)?)))
            }
            Self::MonteCarlo => Err(SourceError::NotAnalytic),
        }
    }
}

impl ProfileSource {
    /// The reflectance of `layers` in air under a rough surface that lets in the share `rho_dt_mean` of isotropic light
    /// ([`Boundary::Rough`]).
    ///
    /// # Errors
    /// As [`ProfileSource::profile`]; or if the source knows smooth surfaces only, or the share is none.
    pub fn profile_under_rough_surface(
        self,
        layers: &[TissueLayer],
        rho_dt_mean: f64,
    ) -> Result<BoxedProfile, SourceError> {
        match (self, half_space(layers)) {
            (Self::Dipole, Some(medium)) => {
                let eta_inside_over_outside = medium.refractive_index;
                let boundary = Boundary::Rough { eta_inside_over_outside, rho_dt_mean };
                Ok(Box::new(Dipole::with_boundary(medium, boundary)?))
            }
            (Self::Dipole, None) => self.profile(layers),
            (Self::Multipole, _) => Ok(Box::new(Stack::under_rough_surface(layers, rho_dt_mean)?)),
            _ => Err(SourceError::SmoothOnly { source_asked: self }),
        }
    }
}

/// The medium, if the layers are one half-space.
pub(crate) fn half_space(layers: &[TissueLayer]) -> Option<&Medium> {
    match layers {
        [layer] if layer.thickness_mm == f64::INFINITY => Some(&layer.medium),
        _ => None,
    }
}

/// The sum of two profiles.
struct Together<A, B>(A, B);

impl<A: Profile, B: Profile> Profile for Together<A, B> {
    fn spectrum(&self, k_per_mm: f64) -> f64 {
        self.0.spectrum(k_per_mm) + self.1.spectrum(k_per_mm)
    }

    fn at_mm(&self, r_mm: f64) -> f64 {
        self.0.at_mm(r_mm) + self.1.at_mm(r_mm)
    }
}

impl Profile for BoxedProfile {
    fn spectrum(&self, k_per_mm: f64) -> f64 {
        (**self).spectrum(k_per_mm)
    }

    fn at_mm(&self, r_mm: f64) -> f64 {
        (**self).at_mm(r_mm)
    }

    fn poles(&self) -> Option<Vec<Pole>> {
        (**self).poles()
    }

    fn powers(&self) -> Option<Powers> {
        (**self).powers()
    }

    fn total(&self) -> f64 {
        (**self).total()
    }
}

impl fmt::Display for ProfileSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Dipole => "dipole",
            Self::BetterDipole => "better-dipole",
            Self::Multipole => "multipole",
            Self::Beam => "beam",
            Self::MonteCarlo => "monte-carlo",
        })
    }
}

impl FromStr for ProfileSource {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let known = Self::ALL.into_iter().find(|source| source.to_string() == name);
        known.ok_or_else(|| {
            let names: Vec<String> = Self::ALL.iter().map(Self::to_string).collect();
            format!("there is no source {name:?}; {} are", names.join(", "))
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;

    fn layer(index: f64, thickness_mm: f64) -> TissueLayer {
        TissueLayer { medium: Medium::new(0.1, 0.9, index).unwrap(), thickness_mm }
    }

    #[test]
    fn totals_against_monte_carlo_are_those_measured_elsewhere() {
        // Totals of MCML and how far each theory is off, in percent to one decimal (offline measurement, MCML with up to 2e7
        // packets): index, albedo, MC, dipole, better dipole, beam. Half a unit of the last digit, the truth's own noise of
        // 1e-3 and 0.2 for the boundary's polynomial.
        for (index, albedo, truth, dipole, better, beam) in [
            (1.0, 0.2, 0.03526, -32.1, 2.6, 5.3),
            (1.0, 0.9, 0.41509, -7.1, 16.1, 14.3),
            (1.0, 0.99, 0.75259, -0.8, 18.2, 11.8),
            (1.4, 0.2, 0.01509, 40.9, 3.8, 6.9),
            (1.4, 0.5, 0.05364, 37.6, 5.4, 10.3),
            (1.4, 0.9, 0.25782, 10.3, 4.9, 4.0),
            (1.4, 0.99, 0.62040, -1.2, 7.5, 3.4),
        ] {
            let medium = Medium::new(1.0 - albedo, albedo, index).unwrap();
            let layers = [TissueLayer { medium, thickness_mm: f64::INFINITY }];
            for (source, off) in [
                (ProfileSource::Dipole, dipole),
                (ProfileSource::BetterDipole, better),
                (ProfileSource::Beam, beam),
            ] {
                let total = source.profile(&layers).unwrap().total();
                let ours = 100.0 * (total / truth - 1.0);
                assert!((ours - off).abs() < 0.35, "{source} {index} {albedo}: {ours:.2} against {off}");
            }
        }
    }

    #[test]
    fn a_rough_surface_is_for_those_who_know_it() {
        let endless = [layer(1.4, f64::INFINITY)];
        let total = |source: ProfileSource, share| {
            source.profile_under_rough_surface(&endless, share).map(|profile| profile.total())
        };
        // Half-space or stack of one, the same; the more gets in, the more gets out.
        let [dipole, stack] =
            [ProfileSource::Dipole, ProfileSource::Multipole].map(|s| total(s, 0.9).unwrap());
        assert!((dipole - stack).abs() < 1e-15);
        assert!(dipole < total(ProfileSource::Dipole, 0.95).unwrap());
        assert!(total(ProfileSource::Beam, 0.9).unwrap_err().to_string().contains("beam knows smooth"));
        assert!(total(ProfileSource::Dipole, 0.0).unwrap_err().to_string().contains("0 to 1, got 0"));
    }

    #[test]
    fn names_are_read_as_they_are_written() {
        for source in ProfileSource::ALL {
            assert_eq!(source.to_string().parse(), Ok(source));
        }
        assert!("tripole".parse::<ProfileSource>().unwrap_err().contains("dipole, better-dipole"));
    }

    #[test]
    fn each_source_says_what_it_does_not_know() {
        let endless = layer(1.4, f64::INFINITY);
        assert_eq!(ProfileSource::default_for(&[endless]), ProfileSource::Dipole);
        assert_eq!(ProfileSource::default_for(&[layer(1.4, 2.0), endless]), ProfileSource::Multipole);
        let told =
            |source: ProfileSource, layers: &[TissueLayer]| source.profile(layers).err().unwrap().to_string();
        assert!(
            told(ProfileSource::Beam, &[layer(1.4, 2.0)]).contains("beam is for one infinitely thick layer")
        );
        assert!(told(ProfileSource::MonteCarlo, &[endless]).contains("has to be simulated"));
        assert!(told(ProfileSource::Beam, &[layer(0.8, f64::INFINITY)]).contains("at least 1, got 0.8"));
        assert!(told(ProfileSource::Multipole, &[]).contains("at least one layer"));
    }
}
