//! Translations of measured media, seen from the target's side.
#![allow(clippy::unwrap_used, reason = "tests")]

use super::*;
use crate::{Burley, BurleyScaling, Dipole, Medium, presets};

struct Case {
    dipoles: [Dipole; 3],
    kernel: RgbGaussianSum,
    index: f64,
    l_mm: [f64; 3],
}

fn case(name: &str) -> Case {
    let preset = presets::find(name).unwrap();
    let media: &[Medium; 3] = preset.media().unwrap();
    Case {
        dipoles: media.map(|m| Dipole::new(&m).unwrap()),
        kernel: preset.kernel(6).unwrap(),
        index: media[0].refractive_index,
        l_mm: media.map(|m| m.transport_mean_free_path_mm()),
    }
}

fn translated(case: &Case, target: Target, draft: GltfDraft) -> Translation {
    let subject = Subject {
        name: "test",
        profiles: [&case.dipoles[0], &case.dipoles[1], &case.dipoles[2]],
        kernel: &case.kernel,
        refractive_index: case.index,
        mean_free_path_mm: case.l_mm,
    };
    translate(&subject, target, draft).unwrap()
}

fn number(translation: &Translation, name: &str) -> f64 {
    match field(translation, name) {
        Value::Number(value) => *value,
        other => panic!("{name} is {other:?}"),
    }
}

fn rgb(translation: &Translation, name: &str) -> [f64; 3] {
    match field(translation, name) {
        Value::Rgb(value) => *value,
        other => panic!("{name} is {other:?}"),
    }
}

fn field<'a>(translation: &'a Translation, name: &str) -> &'a Value {
    &translation.fields.iter().find(|f| f.name == name).unwrap_or_else(|| panic!("{name} is there")).value
}

/// The error that a target's own reading of its fields leaves.
fn read_back(case: &Case, channel: usize, drawn: &dyn Profile) -> f64 {
    loss::LitSpectrum::new(&case.dipoles[channel], case.l_mm[channel]).relative_error(drawn)
}

#[test]
fn every_target_can_be_read_back_from_its_own_fields() {
    let case = case("skin1");
    let unreal = translated(&case, Target::Unreal, GltfDraft::None);
    let hdrp = translated(&case, Target::Hdrp, GltfDraft::None);
    let blender = translated(&case, Target::Blender, GltfDraft::None);
    let open_pbr = translated(&case, Target::OpenPbr, GltfDraft::None);
    let gltf = translated(&case, Target::Gltf, GltfDraft::Scatter);
    for c in 0..3 {
        // Unreal: cm per unit times units gives cm; ten of them mm.
        let dmfp_mm = 10.0
            * number(&unreal, "world_unit_scale")
            * number(&unreal, "mean_free_path_distance")
            * rgb(&unreal, "mean_free_path_color")[c];
        let albedo = rgb(&unreal, "surface_albedo")[c];
        let by_unreal =
            Burley::from_mean_free_path(albedo, dmfp_mm, BurleyScaling::DiffuseMeanFreePath).unwrap();
        let d_mm = number(&hdrp, "Multiplier") * rgb(&hdrp, "Scattering Color")[c];
        let by_hdrp = Burley::new(rgb(&hdrp, "Base Color (material, linear)")[c], d_mm).unwrap();
        let walk = |colour: f64, l_mm: f64, alpha_min| random_walk::RandomWalk::new(colour, l_mm, alpha_min);
        let l_m = number(&blender, "Subsurface Scale") * rgb(&blender, "Subsurface Radius")[c];
        let by_blender = walk(rgb(&blender, "Base Color")[c], 1e3 * l_m, 0.2);
        let l_mm = number(&open_pbr, "subsurface_radius") * rgb(&open_pbr, "subsurface_radius_scale")[c];
        let by_open_pbr = walk(rgb(&open_pbr, "subsurface_color")[c], l_mm, 0.0);
        let l_m = -number(&gltf, "attenuationDistance") / rgb(&gltf, "attenuationColor")[c].ln();
        let by_gltf = walk(rgb(&gltf, "multiscatterColorFactor")[c], 1e3 * l_m, 0.0);
        let told: [(&Translation, &dyn Profile); 5] = [
            (&unreal, &by_unreal),
            (&hdrp, &by_hdrp),
            (&blender, &by_blender),
            (&open_pbr, &by_open_pbr),
            (&gltf, &by_gltf),
        ];
        for (translation, drawn) in told {
            // Six digits were written; at its minimum the error does not even feel them.
            let (ours, theirs) =
                (translation.loss[c].wide.relative_rms_power_error, read_back(&case, c, drawn));
            assert!((ours / theirs - 1.0).abs() < 1e-4, "{:?} {c}: {ours} {theirs}", translation.target);
            assert!(translation.loss[c].relative_change_of_total.abs() < 1e-12);
        }
    }
}

#[test]
fn fitted_lengths_beat_the_formula() {
    for name in ["skin1", "marble"] {
        let case = case(name);
        let media = presets::find(name).unwrap().media().unwrap();
        let unreal = translated(&case, Target::Unreal, GltfDraft::None);
        for (c, medium) in media.iter().enumerate() {
            let by_formula = Burley::from_mean_free_path(
                case.dipoles[c].total(),
                medium.diffuse_mean_free_path_mm(),
                BurleyScaling::DiffuseMeanFreePath,
            );
            let formula = read_back(&case, c, &by_formula.unwrap());
            let fitted = unreal.loss[c].wide.relative_rms_power_error;
            assert!(fitted < formula, "{name} {c}: {fitted} against {formula}");
        }
    }
}

#[test]
fn ratified_gltf_draws_a_lambertian_surface() {
    let case = case("marble");
    let gltf = translated(&case, Target::Gltf, GltfDraft::None);
    for c in 0..3 {
        // A point has all the power that the beam lets it have: far more than a profile twenty beams wide.
        assert!(gltf.loss[c].fine.relative_rms_power_error > 1.0);
        let drawn = (1.0 - number(&gltf, "diffuseTransmissionFactor")) * rgb(&gltf, "baseColorFactor")[c];
        assert!((drawn / case.dipoles[c].total() - 1.0).abs() < 2e-5, "the total is kept: {drawn}");
        assert!(gltf.loss[c].relative_change_of_total.abs() < 1e-12);
    }
}

#[test]
fn documents_parse_and_use_what_they_hold() {
    let case = case("skin2");
    for (draft, extension) in [
        (GltfDraft::None, "KHR_materials_diffuse_transmission"),
        (GltfDraft::VolumeScatter, "KHR_materials_volume_scatter"),
        (GltfDraft::Scatter, "KHR_materials_scatter"),
    ] {
        let json: serde_json::Value =
            serde_json::from_str(&translated(&case, Target::Gltf, draft).text).unwrap();
        let used = json["extensionsUsed"].as_array().unwrap();
        assert!(used.iter().any(|name| name == extension), "{used:?}");
        let held = json["materials"][0]["extensions"].as_object().unwrap();
        assert_eq!(used.len(), held.len());
        assert!(json.get("extensionsRequired").is_none());
        let drafts = held.keys().filter(|key| key.contains("scatter")).count();
        assert_eq!(drafts, usize::from(draft != GltfDraft::None));
    }
    for target in [Target::Unreal, Target::Hdrp, Target::Blender] {
        let translation = translated(&case, target, GltfDraft::None);
        let json: serde_json::Value = serde_json::from_str(&translation.text).unwrap();
        assert_eq!(json["fields"].as_array().unwrap().len(), translation.fields.len());
        assert!(json["fields"].as_array().unwrap().iter().all(|f| !f["unit"].as_str().unwrap().is_empty()));
        assert!(json["loss"][2]["fine"]["relative_rms_power_error"].as_f64().unwrap() > 0.0);
    }
    let mtlx = translated(&case, Target::OpenPbr, GltfDraft::None).text;
    assert!(mtlx.contains("<open_pbr_surface") && mtlx.contains("millimetres"), "{mtlx}");
    assert_eq!(mtlx.matches("<input").count(), 7);
}

#[test]
fn what_is_no_share_of_the_light_is_refused() {
    let case = case("skin1");
    let bright = crate::GaussianSum::new(vec![crate::Gaussian { weight: 1.5, variance_mm2: 1.0 }]);
    let mut subject = Subject {
        name: "",
        profiles: [&case.dipoles[0], &bright, &case.dipoles[2]],
        kernel: &case.kernel,
        refractive_index: 1.4,
        mean_free_path_mm: [0.1; 3],
    };
    let refused =
        |subject: &Subject| translate(subject, Target::Hdrp, GltfDraft::None).unwrap_err().to_string();
    assert!(refused(&subject).contains("channel 1") && refused(&subject).contains("1.5"));
    subject.profiles[1] = &case.dipoles[1];
    subject.mean_free_path_mm[2] = 0.0;
    assert!(refused(&subject).contains("mean free path"));
}
