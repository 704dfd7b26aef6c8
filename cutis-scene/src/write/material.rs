//! `[material]`, or `[[material]]` where objects differ. Everything is said, so that nothing depends on the mesh file;
//! images that the mesh itself brings are named `mesh:` and the place they have there.

use super::files::Files;
use super::text::{double, list, number, quoted, vector};
use crate::read::MESH_PREFIX;
use crate::source::{ObjectSource, TextureSource};
use crate::{ColourMap, Material, NormalSpace, ScalarMap, Scattering, SceneError, Texture};
use cutis_optics::{Medium, TissueLayer};
use glam::Vec3;
use std::sync::Arc;

const CHANNELS: [&str; 4] = ["red", "green", "blue", "alpha"];

/// The keys of one material.
pub(super) fn keys(
    material: &Material,
    source: &ObjectSource,
    files: &mut Files,
) -> Result<String, SceneError> {
    let mut text = String::new();
    let mut put = |key: &str, value: String| text += &format!("{key} = {value}\n");
    let (key, value) = scattering(&material.scattering);
    put(key, value);
    match &material.albedo.texture {
        Some(map) => {
            put("albedo", quoted(&picture(map, source, true, files)?));
            if material.albedo.factor != Vec3::ONE {
                put("albedo_colour", vector(material.albedo.factor));
            }
        }
        None => put("albedo", vector(material.albedo.factor)),
    }
    put("albedo_mix", number(material.albedo_mix));
    match &material.normal {
        Some(map) => {
            put("normal", quoted(&picture(&map.texture, source, false, files)?));
            let space = if map.space == NormalSpace::Tangent { "tangent" } else { "object" };
            put("normal_space", quoted(space));
            put("normal_strength", number(map.strength));
        }
        None => put("normal", "false".to_owned()),
    }
    put("specular", scalar(&material.rho_s, source, files)?);
    put("roughness", scalar(&material.roughness, source, files)?);
    put("f0", number(material.f0));
    put("thickness_scale", number(material.thickness_scale));
    put("mean_free_path_scale", scalar(&material.mean_free_path_scale, source, files)?);
    if !material.under.is_empty() {
        let layers = material.under.iter().map(|layer| under(layer, source, files));
        put("under", list(layers.collect::<Result<Vec<_>, _>>()?));
    }
    if let Some(second) = &material.mixed_with {
        let (key, value) = scattering(&second.scattering);
        let share = scalar(&second.share, source, files)?;
        put("mixed_with", format!("{{ {key} = {value}, share = {share} }}"));
    }
    Ok(text)
}

/// The key that names how light spreads, and its value.
fn scattering(scattering: &Scattering) -> (&'static str, String) {
    match scattering {
        Scattering::Preset(name) => ("preset", quoted(name)),
        Scattering::Medium(media) => ("medium", format!("{{ {} }}", medium(media))),
        Scattering::Layers(channels) => ("layers", layers(channels)),
        Scattering::Kernel(kernel) => {
            let weights = list(kernel.weights.iter().map(|w| list(w.map(double))));
            let variances = list(kernel.variances_mm2.iter().copied().map(double));
            ("kernel", format!("{{ variances_mm2 = {variances}, weights = {weights} }}"))
        }
    }
}

fn under(layer: &ColourMap, source: &ObjectSource, files: &mut Files) -> Result<String, SceneError> {
    let colour = format!("colour = {}", vector(layer.factor));
    let Some(map) = &layer.texture else { return Ok(format!("{{ {colour} }}")) };
    Ok(format!("{{ path = {}, {colour} }}", quoted(&picture(map, source, true, files)?)))
}

/// One table for each layer; what is endless has no thickness.
fn layers(channels: &[Vec<TissueLayer>; 3]) -> String {
    let [red, green, blue] = channels;
    let rows = red.iter().zip(green).zip(blue).map(|((r, g), b)| [r, g, b]);
    list(rows.map(|row| {
        let coefficients = medium(&row.map(|layer| layer.medium));
        match row[0].thickness_mm {
            f64::INFINITY => format!("{{ {coefficients} }}"),
            mm => format!("{{ {coefficients}, thickness_mm = {} }}", double(mm)),
        }
    }))
}

fn medium(media: &[Medium; 3]) -> String {
    let each = |value: fn(&Medium) -> f64| list(media.iter().map(|m| double(value(m))));
    format!(
        "sigma_a_per_mm = {}, sigma_s_reduced_per_mm = {}, refractive_index = {}",
        each(|m| m.sigma_a_per_mm),
        each(|m| m.sigma_s_reduced_per_mm),
        each(|m| m.refractive_index),
    )
}

fn scalar(map: &ScalarMap, source: &ObjectSource, files: &mut Files) -> Result<String, SceneError> {
    let Some((texture, channel)) = &map.texture else { return Ok(number(map.offset)) };
    let path = quoted(&picture(texture, source, false, files)?);
    Ok(format!(
        "{{ path = {path}, channel = {}, offset = {}, gain = {} }}",
        quoted(CHANNELS[*channel]),
        number(map.offset),
        number(map.gain)
    ))
}

/// The text that names an image.
fn picture(
    texture: &Arc<Texture>,
    source: &ObjectSource,
    colour: bool,
    files: &mut Files,
) -> Result<String, SceneError> {
    let own = source.own_material.maps();
    if let Some((place, _)) =
        own.into_iter().find(|(_, map)| map.is_some_and(|map| Arc::ptr_eq(map, texture)))
    {
        return Ok(format!("{MESH_PREFIX}{place}"));
    }
    match texture.source() {
        Some(TextureSource::File(path)) => files.name(path),
        _ => files.draw(texture, colour),
    }
}
