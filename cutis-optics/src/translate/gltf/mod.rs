//! glTF 2.0: a document with one material and nothing else.
//!
//! Ratified: `KHR_materials_volume` (lengths in metres) and `KHR_materials_diffuse_transmission` (release candidate). They let
//! light *through*, attenuated by thickness, but spread nothing sideways: the surface stays Lambertian, and the loss says so.
//! What passes is read off the kernel as a renderer of sums of Gaussians does, T(d) = Σ w e^(-d²/2v) (d'Eon et al. 2007,
//! eq. 16, corrected): exact at the thickness written and at its double, unless what passes and what comes back would exceed the
//! light; then less passes.
//!
//! Drafts, behind [`GltfDraft`]: `KHR_materials_volume_scatter` and `KHR_materials_scatter`, both open pull requests (parts
//! of their threads were read, the fields come from the project's notes): a random walk with a colour and the mean free path
//! -(attenuation distance)/ln(attenuation colour). Their field names may still change.

mod passage;

use super::random_walk::fitted_walks;
use super::{Field, Subject, Target, Translation, largest, six_digits};
use crate::Profile;
use passage::Passage;
use serde_json::{Value, json};

/// Extensions that are not ratified.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum GltfDraft {
    /// None: ratified extensions and the release candidate only.
    #[default]
    None,
    /// `KHR_materials_volume_scatter`.
    VolumeScatter,
    /// `KHR_materials_scatter`, which is meant to replace it.
    Scatter,
}

const MM_PER_M: f64 = 1e3;

/// The material.
pub(super) fn translate(subject: &Subject, draft: GltfDraft) -> Translation {
    if draft == GltfDraft::None { through(subject) } else { walking(subject, draft) }
}

/// All light at the point where it fell: what a Lambertian surface draws.
struct Point(f64);

impl Profile for Point {
    fn spectrum(&self, _: f64) -> f64 {
        self.0
    }

    fn at_mm(&self, r_mm: f64) -> f64 {
        if r_mm == 0.0 { f64::INFINITY } else { 0.0 }
    }
}

/// Only ratified words: light passes, none spreads.
fn through(subject: &Subject) -> Translation {
    let passage = Passage::of(subject.kernel, largest(subject.albedo()));
    // The passing lobe takes its share from the reflecting one: the base colour makes up for it.
    let base = subject.albedo().map(|r| (r / (1.0 - passage.factor)).min(1.0));
    let drawn = base.map(|b| Point(b * (1.0 - passage.factor)));
    let mut fields = common_fields(subject, base, &passage);
    fields.push(Field::number(
        "diffuseTransmissionFactor",
        passage.factor,
        "none",
        "share of the light that passes",
    ));
    fields.push(Field::rgb(
        "diffuseTransmissionColorFactor",
        passage.colour,
        "none",
        "colour of what passes",
    ));
    let mut extensions = common_extensions(subject, &passage);
    extensions["KHR_materials_diffuse_transmission"] = json!({
        "diffuseTransmissionFactor": six_digits(passage.factor),
        "diffuseTransmissionColorFactor": passage.colour.map(six_digits),
    });
    Translation {
        target: Target::Gltf,
        material: subject.name.to_owned(),
        place: PLACE,
        fields,
        notes: told(&[
            "no ratified extension spreads light sideways: the surface is drawn Lambertian, only transmission is carried over",
            "attenuationDistance is one of attenuation through the thickness, neither a mean free path nor a diffuse one",
            "thicknessFactor stands for a thickness texture: put the mesh's own thickness there",
        ]),
        loss: subject.loss([&drawn[0], &drawn[1], &drawn[2]]),
        text: document(subject.name, base, &extensions),
    }
}

/// With a draft: a random walk.
fn walking(subject: &Subject, draft: GltfDraft) -> Translation {
    let drawn = fitted_walks(subject, 0.0);
    let length_mm = drawn.map(|walk| walk.mean_free_path_mm());
    let longest_mm = largest(length_mm);
    let volume = Passage {
        attenuation_distance_mm: longest_mm,
        attenuation_colour: length_mm.map(|l| (-longest_mm / l).exp()),
        ..Passage::of(subject.kernel, largest(subject.albedo()))
    };
    let white = [1.0; 3];
    let mut fields = common_fields(subject, white, &volume);
    let mut extensions = common_extensions(subject, &volume);
    fields.push(Field::rgb(
        "multiscatterColorFactor",
        subject.albedo(),
        "none",
        "total diffuse reflectance, linear",
    ));
    fields.push(Field::number(
        "scatterAnisotropy",
        0.0,
        "none",
        "the mean free path is the transport one already",
    ));
    let mut scatter =
        json!({ "multiscatterColorFactor": subject.albedo().map(six_digits), "scatterAnisotropy": 0.0 });
    if draft == GltfDraft::VolumeScatter {
        fields.push(Field::number(
            "diffuseTransmissionFactor",
            1.0,
            "none",
            "all diffuse light enters the volume",
        ));
        extensions["KHR_materials_diffuse_transmission"] = json!({ "diffuseTransmissionFactor": 1.0 });
        extensions["KHR_materials_volume_scatter"] = scatter;
    } else {
        fields.push(Field::number(
            "scatterStrengthFactor",
            1.0,
            "none",
            "all light that enters is scattered",
        ));
        scatter["scatterStrengthFactor"] = json!(1.0);
        extensions["KHR_materials_scatter"] = scatter;
    }
    Translation {
        target: Target::Gltf,
        material: subject.name.to_owned(),
        place: PLACE,
        fields,
        notes: told(&[
            "a DRAFT extension: names and meaning may change, few viewers read it",
            "lengths are MEAN FREE PATHS: -attenuationDistance / ln(attenuationColor)",
            "thicknessFactor stands for a thickness texture: put the mesh's own thickness there",
        ]),
        loss: subject.loss([&drawn[0], &drawn[1], &drawn[2]]),
        text: document(subject.name, white, &extensions),
    }
}

const PLACE: &str = "materials[0] of a glTF 2.0 document";

fn told(notes: &[&str]) -> Vec<String> {
    notes.iter().map(|&note| note.to_owned()).collect()
}

fn common_fields(subject: &Subject, base: [f64; 3], volume: &Passage) -> Vec<Field> {
    vec![
        Field::rgb("baseColorFactor", base, "none", "colour of the reflecting lobe, linear"),
        Field::number("ior", subject.refractive_index, "none", "refractive index"),
        Field::number(
            "thicknessFactor",
            volume.thickness_mm / MM_PER_M,
            "m",
            "one standard deviation of the widest channel",
        ),
        Field::number(
            "attenuationDistance",
            volume.attenuation_distance_mm / MM_PER_M,
            "m",
            "distance after which the attenuation colour is left",
        ),
        Field::rgb(
            "attenuationColor",
            volume.attenuation_colour,
            "none",
            "share of the light left after that distance",
        ),
    ]
}

fn common_extensions(subject: &Subject, volume: &Passage) -> Value {
    json!({
        "KHR_materials_ior": { "ior": six_digits(subject.refractive_index) },
        "KHR_materials_volume": {
            "thicknessFactor": six_digits(volume.thickness_mm / MM_PER_M),
            "attenuationDistance": six_digits(volume.attenuation_distance_mm / MM_PER_M),
            "attenuationColor": volume.attenuation_colour.map(six_digits),
        },
    })
}

/// A whole document, so that any reader opens it; extensions are used, never required.
fn document(name: &str, base: [f64; 3], extensions: &Value) -> String {
    let used: Vec<&String> = extensions.as_object().into_iter().flat_map(|o| o.keys()).collect();
    let [r, g, b] = base.map(six_digits);
    let document = json!({
        "asset": { "version": "2.0", "generator": concat!("cutis ", env!("CARGO_PKG_VERSION")) },
        "extensionsUsed": used,
        "materials": [{
            "name": name,
            "pbrMetallicRoughness": { "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.5 },
            "extensions": extensions,
        }],
    });
    serde_json::to_string_pretty(&document).expect("plain values are JSON") + "\n"
}
