//! Tone mappers: from light without upper limit to the 0..=1 of a screen, both linear Rec. 709.
//!
//! All of them map black to black, keep greys grey, rise with the light and end in 0..=1 for every input: no light is
//! negative (less is taken as none) and none brighter than the largest half float. What they do with colour differs.

mod aces;
mod agx;
mod neutral;
mod reinhard;

use glam::Vec3;
use std::fmt;
use std::str::FromStr;

/// Brightest light the curves are asked for: the largest half float. Squares of it are far from overflow.
const MAX_LIGHT: f32 = 65_504.0;

/// A curve from scene light to screen light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ToneMapper {
    /// Cut off at white: linear below, as measured.
    None,
    /// Extended Reinhard on luminance with white at 4 (Reinhard et al. 2002).
    Reinhard,
    /// The film look of ACES 1.0: Stephen Hill's fit of its reference rendering and sRGB output transforms.
    Aces,
    /// AgX by Troy Sobotka: soft shoulder, bright colours fade to white.
    AgX,
    /// Khronos PBR Neutral: base colours come out as they are, only highlights are compressed.
    Neutral,
}

impl ToneMapper {
    /// All of them, in the order of their names in `--help`.
    pub const ALL: [Self; 5] = [Self::None, Self::Reinhard, Self::Aces, Self::AgX, Self::Neutral];

    /// Screen light in 0..=1 of a scene light.
    pub fn map(self, colour: Vec3) -> Vec3 {
        // clamp keeps NaN, max takes its other side.
        let light = Vec3::from_array(colour.to_array().map(|c| c.clamp(0.0, MAX_LIGHT).max(0.0)));
        let shown = match self {
            Self::None => light,
            Self::Reinhard => reinhard::map(light),
            Self::Aces => aces::map(light),
            Self::AgX => agx::map(light),
            Self::Neutral => neutral::map(light),
        };
        shown.clamp(Vec3::ZERO, Vec3::ONE)
    }
}

impl fmt::Display for ToneMapper {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::None => "none",
            Self::Reinhard => "reinhard",
            Self::Aces => "aces",
            Self::AgX => "agx",
            Self::Neutral => "neutral",
        })
    }
}

impl FromStr for ToneMapper {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        Self::ALL.into_iter().find(|mapper| mapper.to_string() == name).ok_or_else(|| {
            let names = Self::ALL.map(|mapper| mapper.to_string());
            format!("there is no tone mapper '{name}'; there are {}", names.join(", "))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Greys from far below to far above anything a camera sees, on a logarithmic scale.
    fn greys() -> impl Iterator<Item = f32> {
        (-240..=160).map(|i| (i as f32 / 10.0).exp2())
    }

    #[test]
    fn names_are_read_back() {
        for mapper in ToneMapper::ALL {
            assert_eq!(mapper.to_string().parse(), Ok(mapper));
        }
        assert!(
            "filmic"
                .parse::<ToneMapper>()
                .expect_err("unknown")
                .contains("none, reinhard, aces, agx, neutral")
        );
    }

    #[test]
    fn black_stays_black() {
        for mapper in ToneMapper::ALL {
            assert_eq!(mapper.map(Vec3::ZERO), Vec3::ZERO, "{mapper}");
        }
    }

    #[test]
    fn more_light_is_never_shown_darker() {
        for mapper in ToneMapper::ALL {
            let mut last = 0.0;
            for grey in greys() {
                let shown = mapper.map(Vec3::splat(grey)).y;
                // Each curve is a handful of roundings of numbers up to 1.
                assert!(shown >= last - 4.0 * f32::EPSILON, "{mapper} at {grey}: {shown} after {last}");
                last = shown;
            }
            assert!(last > 0.97, "{mapper} ends near white, got {last}");
        }
    }

    #[test]
    fn greys_stay_grey() {
        for mapper in ToneMapper::ALL {
            for grey in greys() {
                let shown = mapper.map(Vec3::splat(grey));
                // The rows of the published matrices sum to 1 within 1.7e-4 (AgX, in and out); an exponent of 2.2
                // follows.
                assert!(
                    shown.max_element() - shown.min_element() < 2.0 * 2.2 * 1.7e-4,
                    "{mapper} at {grey}: {shown}"
                );
            }
        }
    }

    #[test]
    fn every_input_ends_in_range() {
        let worst = [0.0, -1.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN, 1e-40, 0.5];
        for mapper in ToneMapper::ALL {
            for (r, g, b) in worst.iter().flat_map(|&r| worst.iter().map(move |&g| (r, g, 1.0 - r))) {
                let shown = mapper.map(Vec3::new(r, g, b));
                let in_range = shown.cmpge(Vec3::ZERO).all() && shown.cmple(Vec3::ONE).all();
                assert!(in_range, "{mapper} of {r} {g} {b}: {shown}");
            }
        }
    }
}
