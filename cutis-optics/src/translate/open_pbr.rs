//! OpenPBR: an `open_pbr_surface` in a MaterialX document.
//!
//! The specification (1.1, by the project's notes, not opened again) defines the radius as the mean free path of the volume
//! and leaves its unit open; an example document of the specification was read for the form. We write millimetres and say so
//! in the file. Many published presets hold *diffuse* mean free paths in this field.

use super::random_walk::fitted_walks;
use super::{Field, Subject, Target, Translation, Value, largest};
use core::fmt::Write;

/// The surface whose random walk is nearest to ours.
pub(super) fn translate(subject: &Subject) -> Translation {
    let drawn = fitted_walks(subject, 0.0);
    let length_mm = drawn.map(|walk| walk.mean_free_path_mm());
    let longest_mm = largest(length_mm);
    let fields = vec![
        Field::number("specular_ior", subject.refractive_index, "none", "refractive index"),
        Field::number("subsurface_weight", 1.0, "none", "all diffuse light goes under the surface"),
        Field::rgb(
            "subsurface_color",
            subject.albedo(),
            "none",
            "total diffuse reflectance, linear Rec. 709",
        ),
        Field::number(
            "subsurface_radius",
            longest_mm,
            "mm",
            "longest mean free path; OpenPBR names no unit, this file means mm",
        ),
        Field::rgb(
            "subsurface_radius_scale",
            length_mm.map(|l| l / longest_mm),
            "none",
            "share of the radius that each channel gets",
        ),
        Field::number(
            "subsurface_scatter_anisotropy",
            0.0,
            "none",
            "the mean free path is the transport one already",
        ),
    ];
    Translation {
        target: Target::OpenPbr,
        material: subject.name.to_owned(),
        place: "MaterialX document, open_pbr_surface",
        text: document(subject.name, &fields),
        fields,
        notes: vec![
            "lengths are MEAN FREE PATHS of an isotropic volume, in mm; OpenPBR leaves the unit open: scale the radius by the unit of your scene".to_owned(),
        ],
        loss: subject.loss([&drawn[0], &drawn[1], &drawn[2]]),
    }
}

fn document(name: &str, fields: &[Field]) -> String {
    let id = identifier(name);
    let mut text =
        String::from("<?xml version=\"1.0\"?>\n<materialx version=\"1.39\" colorspace=\"lin_rec709\">\n");
    text.push_str(
        "  <!-- subsurface_radius in millimetres: mean free path, not diffuse mean free path -->\n",
    );
    let _ = writeln!(text, "  <open_pbr_surface name=\"{id}_surface\" type=\"surfaceshader\">");
    for Field { name, value, .. } in fields {
        let (kind, value) = match value {
            Value::Rgb([r, g, b]) => ("color3", format!("{r}, {g}, {b}")),
            Value::Number(number) => ("float", number.to_string()),
            Value::Flag(flag) => ("boolean", flag.to_string()),
            Value::Word(word) => ("string", (*word).to_owned()),
        };
        let _ = writeln!(text, "    <input name=\"{name}\" type=\"{kind}\" value=\"{value}\" />");
    }
    text.push_str("  </open_pbr_surface>\n");
    let _ = writeln!(text, "  <surfacematerial name=\"{id}\" type=\"material\">");
    let _ = writeln!(
        text,
        "    <input name=\"surfaceshader\" type=\"surfaceshader\" nodename=\"{id}_surface\" />"
    );
    text + "  </surfacematerial>\n</materialx>\n"
}

/// A name that XML and MaterialX take: letters, digits and underscores, no digit in front.
fn identifier(name: &str) -> String {
    let letter = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let plain: String = name.chars().map(letter).take(64).collect();
    if plain.starts_with(|c: char| c.is_ascii_alphabetic()) { plain } else { format!("m_{plain}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hostile_names_become_identifiers() {
        for (name, id) in
            [("skin1", "skin1"), ("a\"/><b>", "a____b_"), ("3 layers", "m_3_layers"), ("", "m_")]
        {
            assert_eq!(identifier(name), id);
        }
    }
}
