//! Unreal Engine: the settings of a subsurface profile, for its Burley technique.
//!
//! Names are those of the editor's Python class `SubsurfaceProfileStruct` (its public page for 5.0 and 5.7 was read; the
//! engine's source was not). Lengths: the page gives the distance in world units, cm, and a scale for them, default 0.1: so a
//! distance of 2.67 at scale 0.1 is 2.67 mm. With `enable_mean_free_path` off the length is a *diffuse* mean free path;
//! that the engine then uses the third scaling of Christensen & Burley is from memory.

use super::burley_fit::fitted_burley;
use super::sheet::sheet;
use super::{Field, Subject, Target, Translation, largest};
use crate::BurleyScaling;

/// cm in a unit of `mean_free_path_distance`: the engine's default, which makes the unit a millimetre.
const WORLD_UNIT_SCALE: f64 = 0.1;

/// The settings whose Burley profile is nearest to ours.
pub(super) fn translate(subject: &Subject) -> Translation {
    let drawn = fitted_burley(subject);
    let albedo = subject.albedo();
    let length_mm =
        [0, 1, 2].map(|c| drawn[c].shape_length_mm() * BurleyScaling::DiffuseMeanFreePath.factor(albedo[c]));
    let longest_mm = largest(length_mm);
    let mut translation = Translation {
        target: Target::Unreal,
        material: subject.name.to_owned(),
        place: "Subsurface Profile asset, settings (Python: SubsurfaceProfileStruct)",
        fields: vec![
            Field::flag("enable_burley", true, "normalised diffusion instead of the separable kernel"),
            Field::flag("enable_mean_free_path", false, "lengths are diffuse mean free paths"),
            Field::rgb("surface_albedo", albedo, "none", "total diffuse reflectance, linear; give the material this base colour too"),
            Field::rgb(
                "mean_free_path_color",
                length_mm.map(|l| l / longest_mm),
                "none",
                "share of mean_free_path_distance that each channel gets",
            ),
            Field::number(
                "mean_free_path_distance",
                longest_mm,
                "mm",
                "longest diffuse mean free path, in units of world_unit_scale (0.1 cm)",
            ),
            Field::number("world_unit_scale", WORLD_UNIT_SCALE, "cm", "length of one unit of the distance"),
            Field::number("ior", subject.refractive_index, "none", "refractive index"),
        ],
        notes: vec![
            "lengths are DIFFUSE mean free paths (1/sigma_tr), not mean free paths; shape length d = l / (3.5 + 100 (A - 0.33)^4)".to_owned(),
            "at world_unit_scale 1 write the distance in cm: a tenth of the number".to_owned(),
        ],
        loss: subject.loss([&drawn[0], &drawn[1], &drawn[2]]),
        text: String::new(),
    };
    translation.text = sheet(&translation);
    translation
}
