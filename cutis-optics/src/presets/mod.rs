//! Materials that ship inside: twelve measured media and the six-Gaussian skin kernel.
//!
//! Sources: [`measured_media`] for the media; the kernel is the three-layer skin of d'Eon & Luebke, GPU Gems 3, chapter 14
//! (2007), figure 14-13 (not opened; the numbers are the widely copied ones, each column summing to 1). It can not be
//! re-derived from the published layer coefficients, so it is a constant.

mod edit_distance;
pub mod measured_media;

use crate::{FitError, Medium, RgbGaussianSum, rgb_kernel};
use edit_distance::edit_distance;
use std::sync::LazyLock;

/// What a preset knows of its material.
#[derive(Debug, Clone, PartialEq)]
pub enum PresetMaterial {
    /// A half-space per channel (red, green, blue), to be seen through the dipole.
    Media([Medium; 3]),
    /// A finished diffusion kernel, totals 1.
    Kernel(RgbGaussianSum),
}

/// A named material.
#[derive(Debug, Clone, PartialEq)]
pub struct Preset {
    /// Name in kebab case.
    pub name: &'static str,
    /// Where its numbers come from.
    pub source: &'static str,
    /// The numbers.
    pub material: PresetMaterial,
}

/// No preset of that name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("no preset is called {name:?}; the nearest name is {nearest:?}")]
pub struct UnknownPreset {
    /// The name asked for.
    pub name: String,
    /// The existing name with the smallest edit distance.
    pub nearest: &'static str,
}

/// Longest part of a wrong name that is compared and repeated: a name may come from a hostile file.
const NAME_MAX_CHARS: usize = 64;

/// Variance mm²; weights of red, green, blue. Each column of weights sums to 1.
const THREE_LAYER_SKIN: [(f64, [f64; 3]); 6] = [
    (0.0064, [0.233, 0.455, 0.649]),
    (0.0484, [0.100, 0.336, 0.344]),
    (0.187, [0.118, 0.198, 0.0]),
    (0.567, [0.113, 0.007, 0.007]),
    (1.99, [0.358, 0.004, 0.0]),
    (7.41, [0.078, 0.0, 0.0]),
];

static PRESETS: LazyLock<Vec<Preset>> = LazyLock::new(|| {
    let skin = Preset {
        name: "three-layer-skin",
        source: "d'Eon & Luebke 2007, GPU Gems 3 ch. 14, six-Gaussian skin",
        material: PresetMaterial::Kernel(RgbGaussianSum::from_rows(THREE_LAYER_SKIN.to_vec())),
    };
    let measured = measured_media::MEASURED_MEDIA.map(|(name, media)| Preset {
        name,
        source: "Jensen et al. 2001, measured, doi:10.1145/383259.383319",
        material: PresetMaterial::Media(media),
    });
    core::iter::once(skin).chain(measured).collect()
});

/// All presets: the skin kernel first, then the measured media by name.
pub fn all() -> &'static [Preset] {
    &PRESETS
}

/// The preset of that exact name.
pub fn find(name: &str) -> Result<&'static Preset, UnknownPreset> {
    all().iter().find(|p| p.name == name).ok_or_else(|| unknown(name))
}

fn unknown(name: &str) -> UnknownPreset {
    let name: String = name.chars().take(NAME_MAX_CHARS).collect();
    let wanted = name.to_lowercase().replace([' ', '_'], "-");
    let nearest = all().iter().min_by_key(|p| edit_distance(p.name, &wanted));
    UnknownPreset { nearest: nearest.expect("there are presets").name, name }
}

impl Preset {
    /// The diffusion kernel for a renderer, with up to `gaussians` shared variances; a preset that *is* a kernel comes as
    /// it is. Totals are those of the material: see [`RgbGaussianSum::normalised_to_white`].
    pub fn kernel(&self, gaussians: usize) -> Result<RgbGaussianSum, FitError> {
        match &self.material {
            PresetMaterial::Media(media) => rgb_kernel(media, gaussians),
            PresetMaterial::Kernel(kernel) => Ok(kernel.clone()),
        }
    }

    /// The media of red, green and blue, where the preset has them.
    pub fn media(&self) -> Option<&[Medium; 3]> {
        match &self.material {
            PresetMaterial::Media(media) => Some(media),
            PresetMaterial::Kernel(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;

    #[test]
    fn thirteen_presets_by_the_promised_names() {
        let promised = [
            "marble",
            "skin1",
            "skin2",
            "whole-milk",
            "skim-milk",
            "chicken1",
            "chicken2",
            "apple",
            "cream",
            "ketchup",
            "potato",
            "spectralon",
            "three-layer-skin",
        ];
        assert_eq!(all().len(), promised.len());
        for name in promised {
            assert_eq!(find(name).unwrap().name, name);
        }
    }

    #[test]
    fn a_wrong_name_is_answered_with_the_nearest() {
        for (wrong, right) in [
            ("skin_1", "skin1"),
            ("Marbel", "marble"),
            ("wholemilk", "whole-milk"),
            ("Three Layer Skin", "three-layer-skin"),
        ] {
            assert_eq!(find(wrong).unwrap_err().nearest, right, "{wrong}");
        }
    }

    #[test]
    fn an_endless_name_is_cut() {
        let error = find(&"x".repeat(1 << 20)).unwrap_err();
        assert_eq!(error.name.len(), NAME_MAX_CHARS);
    }

    #[test]
    fn skin_kernel_is_white_and_red_reaches_farthest() {
        let kernel = find("three-layer-skin").unwrap().kernel(6).unwrap();
        // Three decimals per weight, six of them, summing to 1 in decimal: only binary rounding is left.
        assert!(
            kernel.totals().iter().all(|t| (t - 1.0).abs() < 8.0 * f64::EPSILON),
            "{:?}",
            kernel.totals()
        );
        let mean = |c: usize| kernel.rows().map(|(v, w)| v * w[c]).sum::<f64>();
        assert!(mean(0) > mean(1) && mean(1) > mean(2));
    }

    #[test]
    fn measured_kernels_carry_the_total_of_the_dipole() {
        let preset = find("skin1").unwrap();
        let kernel = preset.kernel(6).unwrap();
        // R_d of the three channels from an independent table, made with a boundary factor A that differs by 2.5e-4; R_d
        // follows with 0.37 of that at most. Half a unit of the sixth decimal is the table's rounding.
        for (total, table) in kernel.totals().iter().zip([0.435956, 0.227331, 0.130999]) {
            assert!((total - table).abs() < 0.37 * 2.5e-4 * table + 5e-7, "{total} against {table}");
        }
    }
}
