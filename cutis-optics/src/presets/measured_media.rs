//! The twelve materials measured by Jensen, Marschner, Levoy & Hanrahan 2001, doi:10.1145/383259.383319, figure 5.
//!
//! Quantity: sigma_a and reduced scattering sigma_s', both 1/mm; refractive index as used by the authors (1.3, marble 1.5).
//! The paper itself was not opened: the numbers come from a checked table of fits to these media. Copying errors known
//! elsewhere are *not* here: chicken1 and chicken2 red sigma_a ten times too small (right: 0.015 and 0.018), marble blue
//! sigma_a 0.071 (right: 0.0071).

use crate::Medium;

const fn medium(sigma_s_reduced_per_mm: f64, sigma_a_per_mm: f64, refractive_index: f64) -> Medium {
    Medium { sigma_a_per_mm, sigma_s_reduced_per_mm, refractive_index }
}

/// Name and media of red, green, blue. Columns of `medium`: sigma_s', sigma_a, index.
#[rustfmt::skip]
pub const MEASURED_MEDIA: [(&str, [Medium; 3]); 12] = [
    ("apple", [medium(2.29, 0.003, 1.3), medium(2.39, 0.0034, 1.3), medium(1.97, 0.046, 1.3)]),
    ("chicken1", [medium(0.15, 0.015, 1.3), medium(0.21, 0.077, 1.3), medium(0.38, 0.19, 1.3)]),
    ("chicken2", [medium(0.19, 0.018, 1.3), medium(0.25, 0.088, 1.3), medium(0.32, 0.2, 1.3)]),
    ("cream", [medium(7.38, 0.0002, 1.3), medium(5.47, 0.0028, 1.3), medium(3.15, 0.0163, 1.3)]),
    ("ketchup", [medium(0.18, 0.061, 1.3), medium(0.07, 0.97, 1.3), medium(0.03, 1.45, 1.3)]),
    ("marble", [medium(2.19, 0.0021, 1.5), medium(2.62, 0.0041, 1.5), medium(3.0, 0.0071, 1.5)]),
    ("potato", [medium(0.68, 0.0024, 1.3), medium(0.7, 0.009, 1.3), medium(0.55, 0.12, 1.3)]),
    ("skim-milk", [medium(0.7, 0.0014, 1.3), medium(1.22, 0.0025, 1.3), medium(1.9, 0.0142, 1.3)]),
    ("skin1", [medium(0.74, 0.032, 1.3), medium(0.88, 0.17, 1.3), medium(1.01, 0.48, 1.3)]),
    ("skin2", [medium(1.09, 0.013, 1.3), medium(1.59, 0.07, 1.3), medium(1.79, 0.145, 1.3)]),
    ("spectralon", [medium(11.6, 0.0, 1.3), medium(20.4, 0.0, 1.3), medium(14.9, 0.0, 1.3)]),
    ("whole-milk", [medium(2.55, 0.0011, 1.3), medium(3.21, 0.0024, 1.3), medium(3.77, 0.014, 1.3)]),
];

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;

    #[test]
    fn values_looked_up_by_hand() {
        let of = |name: &str| MEASURED_MEDIA.iter().find(|(n, _)| *n == name).unwrap().1;
        // The three places that other copies of the table get wrong.
        assert_eq!(of("chicken1")[0].sigma_a_per_mm, 0.015);
        assert_eq!(of("chicken2")[0].sigma_a_per_mm, 0.018);
        assert_eq!(of("marble")[2], Medium::new(0.0071, 3.0, 1.5).unwrap());
    }

    #[test]
    fn all_are_possible_media() {
        for (name, channels) in MEASURED_MEDIA {
            assert!(channels.iter().all(|m| m.validated().is_ok()), "{name}");
        }
    }
}
