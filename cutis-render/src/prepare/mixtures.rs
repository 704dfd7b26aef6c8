//! Media that differ from pixel to pixel: a few mixtures of a material's two media, each with a profile of its own
//! (Mertens et al. 2003 take the medium of every pixel from a texture).
//!
//! Not modelled: how the medium differs within one profile's reach; a place spreads light as if all around were as it is.

use crate::RenderError;
use crate::technique::image_space::ImageSpaceSettings;
use cutis_optics::{Medium, presets};
use cutis_scene::{Material, Scattering};
use std::f64::consts::FRAC_PI_2;

/// Mixtures of two media, from the first alone to the second alone. Neighbours share pixels between them.
pub const MIXTURES: u32 = 32;

/// Ranks of the pixels of an ordered dither (Bayer 1973, not opened).
pub const RANKS: [u32; 16] = [0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5];

/// How many mixtures materials have: 1 where none has a second medium.
pub fn count<'a>(mut materials: impl Iterator<Item = &'a Material>) -> u32 {
    if materials.any(|material| material.mixed_with.is_some()) { MIXTURES } else { 1 }
}

/// A material's mixtures: so many as wanted, all alike without a second medium.
///
/// # Errors
/// If one of the two is no medium.
pub fn mixtures(material: &Material, count: u32) -> Result<Vec<Material>, RenderError> {
    let Some(second) = &material.mixed_with else { return Ok(vec![material.clone(); count as usize]) };
    let (Some(own), Some(other)) = (media_of(&material.scattering), media_of(&second.scattering)) else {
        let reason = "its scattering is mixed with a second medium, and only media mix".to_owned();
        return Err(RenderError::BadMaterial { material: material.name.clone(), reason });
    };
    let mixture = |number: u32| {
        let share = share_of(f64::from(number) / f64::from(count - 1).max(1.0));
        let media = [0, 1, 2].map(|channel| own[channel].mixed(&other[channel], share));
        Material { scattering: Scattering::Medium(media), mixed_with: None, ..material.clone() }
    };
    Ok((0..count).map(mixture).collect())
}

/// Share of the second medium at a place in the row of mixtures, 0 to 1. Reflectance falls as the square root of the absorption
/// where that begins, at either end: mixtures lie closer there.
fn share_of(place: f64) -> f64 {
    (FRAC_PI_2 * place).sin().powi(2)
}

/// The place of a share.
fn place_of(share: f32) -> f32 {
    share.sqrt().asin() / std::f32::consts::FRAC_PI_2
}

/// Which of so many mixtures a pixel takes for a share of the second medium: one of the two nearest, so that sixteen pixels
/// have the share between them, and every pixel over sixteen rounds.
pub fn mixture_at(share: f32, count: u32, [x, y]: [u32; 2], settings: &ImageSpaceSettings) -> usize {
    let rank = (RANKS[(x % 4 + 4 * (y % 4)) as usize] + settings.round) % 16;
    (place_of(share) * (count - 1) as f32 + (rank as f32 + 0.5) / 16.0) as usize
}

/// The media that light is scattered by, if they are known.
pub fn media_of(scattering: &Scattering) -> Option<[Medium; 3]> {
    match scattering {
        Scattering::Medium(media) => Some(*media),
        Scattering::Preset(name) => presets::find(name).ok()?.media().copied(),
        Scattering::Kernel(_) | Scattering::Layers(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cutis_scene::{ScalarMap, SecondMedium};

    fn marble() -> Material {
        let share = ScalarMap::constant(0.5);
        let scattering = Scattering::Preset("ketchup".to_owned());
        Material {
            scattering: Scattering::Preset("marble".to_owned()),
            mixed_with: Some(SecondMedium { scattering, share }),
            ..Material::default()
        }
    }

    /// Table 2 of Mertens et al. 2003, 1/mm: marble absorbs 0.0021 in red and scatters 2.19, ketchup 0.061 and 0.18.
    #[test]
    fn mixtures_go_from_the_first_medium_to_the_second() {
        let all = mixtures(&marble(), 3).expect("media");
        let red = |material: &Material| media_of(&material.scattering).expect("media")[0];
        for (material, [a, s]) in all.iter().zip([[0.0021, 2.19], [0.031_55, 1.185], [0.061, 0.18]]) {
            let medium = red(material);
            assert!((medium.sigma_a_per_mm - a).abs() < 1e-12, "{medium:?}");
            assert!((medium.sigma_s_reduced_per_mm - s).abs() < 1e-12, "{medium:?}");
        }
        let alone = Material { mixed_with: None, ..marble() };
        assert_eq!(count([&alone, &alone].into_iter()), 1);
        assert_eq!(count([&alone, &marble()].into_iter()), MIXTURES);
        assert_eq!(mixtures(&alone, 2).expect("alike").len(), 2);
    }

    #[test]
    fn places_are_found_again() {
        for share in [0.0f32, 1e-4, 0.03, 0.5, 0.97, 1.0] {
            assert!((share_of(f64::from(place_of(share))) - f64::from(share)).abs() < 1e-6, "{share}");
        }
    }

    #[test]
    fn a_kernel_does_not_mix() {
        let skin = Material { scattering: Scattering::Preset("three-layer-skin".to_owned()), ..marble() };
        let refused = mixtures(&skin, 2).expect_err("is a kernel").to_string();
        assert!(refused.contains("only media mix"), "{refused}");
    }

    /// Sixteen pixels, and sixteen rounds of one, have any place between them to half a rank; ends are pure.
    #[test]
    fn pixels_and_rounds_have_the_share_between_them() {
        let at = |share, pixel, round| {
            mixture_at(share, MIXTURES, pixel, &ImageSpaceSettings { round, ..Default::default() }) as f32
        };
        for share in [0.0, 0.21, 0.5, 0.99, 1.0] {
            let pixels: f32 = (0..16).map(|i| at(share, [i % 4 + 8, i / 4 + 4], 3)).sum::<f32>() / 16.0;
            let rounds: f32 = (0..16).map(|round| at(share, [5, 2], round)).sum::<f32>() / 16.0;
            for mean in [pixels, rounds] {
                assert!((mean - place_of(share) * 31.0).abs() <= 0.5 / 16.0 + 1e-5, "{share}: {mean}");
            }
        }
        assert!((0..16).all(|i| at(1.0, [i % 4, i / 4], 0) == 31.0 && at(0.0, [i % 4, i / 4], 0) == 0.0));
        assert!((0..16).all(|i| mixture_at(0.7, 1, [i, 0], &ImageSpaceSettings::default()) == 0));
    }
}
