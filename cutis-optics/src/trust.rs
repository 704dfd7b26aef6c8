//! Which diffusion source to believe for which material.
//!
//! Source: errors against Monte Carlo over reduced albedos of 0.2 to 0.999 at the indices 1 and 1.4, `docs/validation.md` of
//! the project. An index counts as the nearer one of those two; nothing in between was measured.

use crate::dipole::ALBEDO_REDUCED_MIN;
use crate::source::half_space;
use crate::{Medium, ProfileSource, Stack, TissueLayer};

/// Above this the index is nearer to tissue's 1.4 than to 1.
const INDEX_OF_TISSUE_MIN: f64 = 1.2;
/// Reduced albedo up to which the better dipole's total and shape are right to [`BETTER_DIPOLE_PERCENT`].
const BETTER_DIPOLE_ALBEDO_MAX: f64 = 0.5;
/// Errors of totals where a source holds, rounded up, percent.
const DIPOLE_PERCENT: u32 = 4;
const BETTER_DIPOLE_PERCENT: u32 = 7;
const BEAM_PERCENT: u32 = 11;

/// What a source is worth for some layers.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Trust {
    /// The source.
    pub source: ProfileSource,
    /// Whether it may be believed.
    pub holds: bool,
    /// How far, or why not and what to take.
    pub words: String,
}

impl ProfileSource {
    /// Whether this source may be believed for `layers`, and which one if not.
    pub fn trust(self, layers: &[TissueLayer]) -> Trust {
        let judged = judged(self, layers);
        let holds = judged.is_ok();
        Trust { source: self, holds, words: judged.unwrap_or_else(|why| why) }
    }
}

fn judged(source: ProfileSource, layers: &[TissueLayer]) -> Result<String, String> {
    if source == ProfileSource::MonteCarlo {
        return Ok("within its standard errors".to_owned());
    }
    // Layers that it does not know are refused in its own words.
    source.profile(layers).map_err(|refused| refused.to_string())?;
    match (source, half_space(layers)) {
        (ProfileSource::BetterDipole, Some(medium)) => better_dipole(medium),
        (ProfileSource::Beam, Some(medium)) => beam(medium),
        (_, Some(medium)) => dipole(medium),
        (_, None) => multipole(layers),
    }
}

fn is_tissue(medium: &Medium) -> bool {
    medium.refractive_index >= INDEX_OF_TISSUE_MIN
}

/// What to take for a half-space instead: no formula is good everywhere at index 1.
fn instead(medium: &Medium) -> &'static str {
    if is_tissue(medium) {
        "beam or monte-carlo"
    } else if medium.albedo_reduced() <= BETTER_DIPOLE_ALBEDO_MAX {
        "better-dipole or monte-carlo"
    } else {
        "monte-carlo"
    }
}

fn dipole(medium: &Medium) -> Result<String, String> {
    let (albedo, l_mm) = (medium.albedo_reduced(), medium.transport_mean_free_path_mm());
    if albedo >= ALBEDO_REDUCED_MIN {
        Ok(format!("total within {DIPOLE_PERCENT} %; shape beyond {l_mm:.4} mm only"))
    } else {
        let way = if is_tissue(medium) { "high" } else { "low" };
        Err(format!(
            "reduced albedo {albedo:.4} is below {ALBEDO_REDUCED_MIN}: total too {way}; take {}",
            instead(medium)
        ))
    }
}

fn better_dipole(medium: &Medium) -> Result<String, String> {
    let albedo = medium.albedo_reduced();
    if albedo <= BETTER_DIPOLE_ALBEDO_MAX {
        Ok(format!("total and shape within {BETTER_DIPOLE_PERCENT} %"))
    } else {
        Err(format!(
            "reduced albedo {albedo:.4} is above {BETTER_DIPOLE_ALBEDO_MAX}: the peak is off; take {}",
            instead(medium)
        ))
    }
}

fn beam(medium: &Medium) -> Result<String, String> {
    if is_tissue(medium) {
        Ok(format!("shape within 3 %, total within {BEAM_PERCENT} %"))
    } else {
        let index = medium.refractive_index;
        Err(format!("index {index} is below {INDEX_OF_TISSUE_MIN}: total too high; take {}", instead(medium)))
    }
}

/// Every layer has to be diffuse and thick.
fn multipole(layers: &[TissueLayer]) -> Result<String, String> {
    if let Some((layer, thin)) = Stack::in_air(layers).ok().and_then(|s| s.too_thin().first().copied()) {
        return Err(format!("layer {layer}: {thin}"));
    }
    let absorbing = |l: &TissueLayer| l.medium.albedo_reduced() < ALBEDO_REDUCED_MIN;
    match layers.iter().position(absorbing) {
        Some(i) => Err(format!(
            "layer {}: reduced albedo {:.4} is below {ALBEDO_REDUCED_MIN}; take monte-carlo",
            i + 1,
            layers[i].medium.albedo_reduced()
        )),
        None => Ok("diffuse in every layer; shape beyond one mean free path only".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;

    fn layer(albedo: f64, index: f64, thickness_mm: f64) -> TissueLayer {
        TissueLayer { medium: Medium::new(1.0 - albedo, albedo, index).unwrap(), thickness_mm }
    }

    #[test]
    fn where_a_source_holds_its_total_is_as_good_as_said() {
        // Errors of totals against Monte Carlo in percent: index, albedo, dipole, better dipole, beam.
        for (index, albedo, dipole, better, beam) in [
            (1.0, 0.2, -32.0, 2.8, 5.5),
            (1.0, 0.5, -23.7, 6.6, 11.2),
            (1.0, 0.8, -12.2, 12.9, 14.4),
            (1.0, 0.95, -3.8, 18.1, 13.7),
            (1.0, 0.99, -0.7, 18.3, 11.8),
            (1.4, 0.2, 41.1, 3.8, 6.9),
            (1.4, 0.5, 37.5, 5.3, 10.1),
            (1.4, 0.8, 21.3, 4.2, 6.1),
            (1.4, 0.95, 3.7, 6.2, 3.5),
            (1.4, 0.99, -1.2, 7.5, 3.4),
        ] {
            let layers = [layer(albedo, index, f64::INFINITY)];
            for (source, off, percent) in [
                (ProfileSource::Dipole, dipole, DIPOLE_PERCENT),
                (ProfileSource::Multipole, dipole, DIPOLE_PERCENT),
                (ProfileSource::BetterDipole, better, BETTER_DIPOLE_PERCENT),
                (ProfileSource::Beam, beam, BEAM_PERCENT),
            ] {
                let off: f64 = off;
                let trust = source.trust(&layers);
                assert!(!trust.holds || off.abs() <= f64::from(percent), "{index} {albedo}: {trust:?}");
                // What is recommended instead holds itself.
                let other = trust.words.split("take ").nth(1).and_then(|w| w.split(' ').next());
                let other: Option<ProfileSource> = other.map(|name| name.parse().unwrap());
                assert_eq!(other.is_none(), trust.holds, "{trust:?}");
                assert!(other.is_none_or(|other| other.trust(&layers).holds), "{trust:?}");
            }
        }
    }

    #[test]
    fn layers_are_for_the_multipole() {
        let words = |source: ProfileSource, layers: &[TissueLayer]| {
            let trust = source.trust(layers);
            (trust.holds, trust.words)
        };
        let [clear, dark, thin] = [layer(0.99, 1.4, 5.0), layer(0.8, 1.4, 5.0), layer(0.99, 1.4, 0.5)];
        assert!(words(ProfileSource::Multipole, &[clear, clear]).0);
        let (holds, told) = words(ProfileSource::Multipole, &[clear, dark]);
        assert!(!holds && told.contains("layer 2: reduced albedo 0.8000"), "{told}");
        let (holds, told) = words(ProfileSource::Multipole, &[thin, clear]);
        assert!(!holds && told.contains("layer 1") && told.contains("monte-carlo"), "{told}");
        let (holds, told) = words(ProfileSource::Beam, &[clear, clear]);
        assert!(!holds && told.contains("use multipole or monte-carlo"), "{told}");
        assert!(words(ProfileSource::MonteCarlo, &[thin]).0);
    }
}
