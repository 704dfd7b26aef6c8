//! Unity HDRP: a diffusion profile.
//!
//! The engine's settings class was read: shape S = 1/D per channel with D = multiplier · scattering colour taken as stored
//! (no conversion of colour space), R = S (e^(-r S) + e^(-r S/3))/(8 pi r), radii in mm, world scale in metres per world unit.
//! So D is the shape length of Burley's profile in mm: neither a mean free path nor a diffuse one. Manual pages of different
//! releases contradict each other on the unit of the radius; the class says mm.

use super::burley_fit::fitted_burley;
use super::sheet::sheet;
use super::{Field, Subject, Target, Translation, largest};

/// The settings whose Burley profile is nearest to ours.
pub(super) fn translate(subject: &Subject) -> Translation {
    let drawn = fitted_burley(subject);
    let length_mm = [0, 1, 2].map(|c| drawn[c].shape_length_mm());
    let longest_mm = largest(length_mm);
    let mut translation = Translation {
        target: Target::Hdrp,
        material: subject.name.to_owned(),
        place: "Diffusion Profile asset, inspector; the base colour belongs to the material",
        fields: vec![
            Field::rgb(
                "Scattering Color",
                length_mm.map(|l| l / longest_mm),
                "none",
                "share of the multiplier that each channel gets; numbers of the picker, 0 to 1, not converted",
            ),
            Field::number("Multiplier", longest_mm, "mm", "longest shape length of Burley's profile"),
            Field::number("World Scale", 1.0, "m", "length of one world unit"),
            Field::number("Index of Refraction", subject.refractive_index, "none", "refractive index"),
            Field::rgb(
                "Base Color (material, linear)",
                subject.albedo(),
                "none",
                "total diffuse reflectance; the profile itself has total 1",
            ),
        ],
        notes: vec![
            "lengths are SHAPE lengths d = l/s of Burley's profile: neither mean free path nor diffuse mean free path".to_owned(),
            "before release 14 there is one field, Scattering Distance: the colour times the multiplier".to_owned(),
        ],
        loss: subject.loss([&drawn[0], &drawn[1], &drawn[2]]),
        text: String::new(),
    };
    translation.text = sheet(&translation);
    translation
}
