//! Blender: inputs of the Principled BSDF, for Cycles' random walk.
//!
//! Cycles' walk was read (2022 state): sigma_t' = 1/radius, so the radius is a *transport* mean free path; light enters with a
//! cosine distribution and leaves without reflection; the colour is inverted to alpha, which is not taken below 0.2. The
//! inversion there was a longer fit of the same function; that newer releases use van de Hulst's is from the project's notes.
//! The method "Random Walk (Skin)" rescales the radius by the index of refraction and is not meant here. Radius times scale is
//! a length in scene units, metres unless the scene says otherwise.

use super::random_walk::fitted_walks;
use super::sheet::sheet;
use super::{Field, Subject, Target, Translation};

/// Smallest single-scattering albedo of Cycles' walk.
const ALPHA_MIN: f64 = 0.2;
/// Metres in a unit of the radius.
const SCALE_M: f64 = 1e-3;

/// The inputs whose random walk is nearest to ours.
pub(super) fn translate(subject: &Subject) -> Translation {
    let drawn = fitted_walks(subject, ALPHA_MIN);
    let mut translation = Translation {
        target: Target::Blender,
        material: subject.name.to_owned(),
        place: "Principled BSDF node (4.0 or newer)",
        fields: vec![
            Field::word("Subsurface Method", "RANDOM_WALK", "not RANDOM_WALK_SKIN, which changes the radius"),
            Field::rgb("Base Color", subject.albedo(), "none", "total diffuse reflectance, linear"),
            Field::number("Subsurface Weight", 1.0, "none", "all diffuse light goes under the surface"),
            Field::rgb(
                "Subsurface Radius",
                drawn.map(|walk| walk.mean_free_path_mm()),
                "mm",
                "transport mean free path of each channel, to be multiplied by the scale",
            ),
            Field::number("Subsurface Scale", SCALE_M, "m", "makes the unit of the radius a millimetre"),
            Field::number("Subsurface Anisotropy", 0.0, "none", "the mean free path is the transport one already"),
            Field::number("IOR", subject.refractive_index, "none", "refractive index, of the specular layer alone"),
        ],
        notes: vec![
            "lengths are TRANSPORT mean free paths (radius times scale), not diffuse ones".to_owned(),
            "a scene with another unit scale needs another Subsurface Scale; EEVEE draws Burley's profile instead".to_owned(),
        ],
        loss: subject.loss([&drawn[0], &drawn[1], &drawn[2]]),
        text: String::new(),
    };
    translation.text = sheet(&translation);
    translation
}
