//! `[material]`: what it says replaces what the mesh file says, key by key.

use super::Context;
use super::keys::Keys;
use crate::read::MESH_PREFIX;
use crate::read::image::ColourSpace;
use crate::{
    ColourMap, Material, NormalMap, NormalSpace, ScalarMap, Scattering, SceneError, SecondMedium, Texture,
};
use cutis_optics::{Medium, RgbGaussianSum, TissueLayer};
use glam::Vec3;
use std::sync::Arc;

const KNOWN: [&str; 17] = [
    "preset",
    "medium",
    "kernel",
    "layers",
    "albedo",
    "albedo_colour",
    "albedo_mix",
    "normal",
    "normal_space",
    "normal_strength",
    "specular",
    "roughness",
    "f0",
    "thickness_scale",
    "mean_free_path_scale",
    "under",
    "mixed_with",
];

/// The keys of a medium.
const COEFFICIENTS: [&str; 3] = ["sigma_a_per_mm", "sigma_s_reduced_per_mm", "refractive_index"];

/// The keys that say what the tissue is.
const TISSUES: [&str; 4] = ["kernel", "layers", "medium", "preset"];

/// Least reduced scattering, 1/mm: below it nothing diffuses.
const LEAST_SCATTERING: f32 = 1e-9;

/// Largest ratio of the indices of refraction of neighbouring layers.
const MAX_INDEX_RATIO: f64 = 2.0;

/// Most layers of a tissue.
const MAX_LAYERS: usize = 64;

/// Most Gaussians of a kernel.
const MAX_GAUSSIANS: usize = 64;

/// Largest factor on distances through the body: it makes a micrometre a metre.
const MAX_THICKNESS_SCALE: f32 = 1e6;

/// The parts of a material that a scene file gives.
#[derive(Debug, Clone, Default)]
pub(super) struct Change {
    scattering: Option<Scattering>,
    albedo: Option<ColourMap>,
    albedo_mix: Option<f32>,
    /// None in it: the surface has no relief.
    normal: Option<Option<NormalMap>>,
    rho_s: Option<ScalarMap>,
    roughness: Option<ScalarMap>,
    f0: Option<f32>,
    thickness_scale: Option<f32>,
    mean_free_path_scale: Option<ScalarMap>,
    under: Option<Vec<ColourMap>>,
    mixed_with: Option<SecondMedium>,
}

impl Change {
    /// Puts what is given in the place of what was.
    pub(super) fn apply(&self, material: &mut Material) {
        fn set<T: Clone>(slot: &mut T, value: &Option<T>) {
            if let Some(value) = value {
                *slot = value.clone();
            }
        }
        set(&mut material.scattering, &self.scattering);
        if self.scattering.as_ref().is_some_and(has_its_own_colour) && material.albedo.texture.is_none() {
            material.albedo.factor = Vec3::ONE;
        }
        set(&mut material.albedo, &self.albedo);
        set(&mut material.albedo_mix, &self.albedo_mix);
        set(&mut material.rho_s, &self.rho_s);
        set(&mut material.roughness, &self.roughness);
        set(&mut material.f0, &self.f0);
        set(&mut material.thickness_scale, &self.thickness_scale);
        set(&mut material.mean_free_path_scale, &self.mean_free_path_scale);
        set(&mut material.normal, &self.normal);
        set(&mut material.under, &self.under);
        if self.mixed_with.is_some() {
            material.mixed_with.clone_from(&self.mixed_with);
        }
    }
}

/// Whether a medium shows its own colour: skin kernels are normalised to white and need an albedo, measured media are
/// not.
fn has_its_own_colour(scattering: &Scattering) -> bool {
    match scattering {
        Scattering::Medium(_) | Scattering::Layers(_) => true,
        Scattering::Preset(name) => {
            cutis_optics::presets::find(name).is_ok_and(|preset| preset.media().is_some())
        }
        Scattering::Kernel(_) => false,
    }
}

/// Reads a material; `own` is what the mesh file makes of the object.
pub(super) fn read(keys: &Keys, own: &Material, context: &mut Context) -> Result<Change, SceneError> {
    keys.only(&KNOWN)?;
    let images = &mut Images { own, context };
    let scattering = scattering(keys)?;
    let mixed_with = mixed_with(keys, scattering.as_ref().unwrap_or(&own.scattering), images)?;
    Ok(Change {
        scattering,
        albedo: albedo(keys, images)?,
        albedo_mix: keys.number_in("albedo_mix", 0.0..=1.0)?,
        normal: normal(keys, images)?,
        rho_s: scalar(keys, "specular", 0.0..=10.0, ScalarMap::measured_rho_s, images)?,
        roughness: scalar(keys, "roughness", 0.0..=1.0, ScalarMap::measured_roughness, images)?,
        f0: keys.number_in("f0", 0.0..=1.0)?,
        thickness_scale: keys.number_in("thickness_scale", 0.0..=MAX_THICKNESS_SCALE)?,
        mean_free_path_scale: scalar(
            keys,
            "mean_free_path_scale",
            Material::MEAN_FREE_PATH_SCALES,
            plain,
            images,
        )?,
        under: under(keys, images)?,
        mixed_with,
    })
}

/// A list of `{ path, colour }`, the layer nearest to the surface first.
fn under(keys: &Keys, images: &mut Images) -> Result<Option<Vec<ColourMap>>, SceneError> {
    if !keys.has("under") {
        return Ok(None);
    }
    let layers = keys.tables("under")?;
    if layers.len() > Material::MAX_UNDER {
        let reason =
            format!("has {} layers under the surface; at most {}", layers.len(), Material::MAX_UNDER);
        return Err(keys.error("under", reason));
    }
    layers.iter().map(|layer| layer_under(layer, images)).collect::<Result<_, _>>().map(Some)
}

fn layer_under(keys: &Keys, images: &mut Images) -> Result<ColourMap, SceneError> {
    keys.only(&["path", "colour"])?;
    let colour = keys.vector_in("colour", 0.0..=1.0)?;
    let texture = match keys.string("path")? {
        Some(text) => Some(texture(keys, "path", text, ColourSpace::Colour, images)?),
        None if colour.is_none() => {
            return Err(keys.error("path", "is missing: a layer needs `path`, `colour` or both"));
        }
        None => None,
    };
    Ok(ColourMap { factor: colour.unwrap_or(Vec3::ONE), texture })
}

/// A medium, or a preset that is one, and the `share` that it fills: a number, a path, or `{ path, channel, offset, gain }`.
/// `first` is what it is mixed with.
fn mixed_with(
    keys: &Keys,
    first: &Scattering,
    images: &mut Images,
) -> Result<Option<SecondMedium>, SceneError> {
    let Some(second) = keys.table("mixed_with")? else { return Ok(None) };
    second.only(&["preset", "medium", "share"])?;
    if let Some(reason) = no_medium(first) {
        return Err(keys.error("mixed_with", format!("has no medium to be mixed with: {reason}")));
    }
    let scattering = second.required("medium", scattering(&second)?)?;
    if let Some(reason) = no_medium(&scattering) {
        return Err(second.error("preset", reason));
    }
    let share = second.required("share", scalar(&second, "share", 0.0..=1.0, plain, images)?)?;
    Ok(Some(SecondMedium { scattering, share }))
}

/// A map that is the number itself.
fn plain(texture: Arc<Texture>) -> ScalarMap {
    ScalarMap { offset: 0.0, gain: 1.0, texture: Some((texture, 0)) }
}

/// Why a tissue is not a single medium, if it is none.
fn no_medium(scattering: &Scattering) -> Option<String> {
    match scattering {
        Scattering::Medium(_) => None,
        Scattering::Layers(_) => Some("the tissue has layers; only media mix".to_owned()),
        Scattering::Kernel(_) => Some("the tissue is a kernel; only media mix".to_owned()),
        Scattering::Preset(name) => match cutis_optics::presets::find(name) {
            Ok(preset) => preset.media().is_none().then(|| format!("`{name}` is a kernel; only media mix")),
            Err(unknown) => Some(unknown.to_string()),
        },
    }
}

fn scattering(keys: &Keys) -> Result<Option<Scattering>, SceneError> {
    let mut there = TISSUES.into_iter().filter(|key| keys.has(key));
    let Some(key) = there.next() else { return Ok(None) };
    if let Some(other) = there.next() {
        return Err(keys.error(key, format!("stands beside `{other}`; only one can be the tissue")));
    }
    let table = || keys.required(key, keys.table(key)?);
    match key {
        "kernel" => kernel(&table()?),
        "layers" => layers(keys),
        "medium" => medium(&table()?),
        _ => match keys.required(key, keys.string(key)?)? {
            "" => Err(keys.error(key, "is empty")),
            // Names are looked up where they are known, in the renderer.
            name => Ok(Scattering::Preset(name.to_owned())),
        },
    }
    .map(Some)
}

fn medium(keys: &Keys) -> Result<Scattering, SceneError> {
    keys.only(&COEFFICIENTS)?;
    media(keys).map(Scattering::Medium)
}

/// A list of media, the top one first, each with its thickness; the last may be endless.
fn layers(keys: &Keys) -> Result<Scattering, SceneError> {
    let tables = keys.tables("layers")?;
    if tables.is_empty() || tables.len() > MAX_LAYERS {
        return Err(keys.error("layers", format!("{} of them; must be 1 to {MAX_LAYERS}", tables.len())));
    }
    let mut layers = [const { Vec::new() }; 3];
    for (i, layer) in tables.iter().enumerate() {
        layer.only(&[&COEFFICIENTS[..], &["thickness_mm"]].concat())?;
        layer.number_in("thickness_mm", f32::MIN_POSITIVE..=1e6)?;
        let thickness_mm = match layer.double("thickness_mm")? {
            None if i + 1 < tables.len() => {
                return Err(layer.error("thickness_mm", "is missing: only the last layer may be endless"));
            }
            given => given.unwrap_or(f64::INFINITY),
        };
        for (channel, medium) in layers.iter_mut().zip(media(layer)?) {
            if let Some(above) = channel.last() {
                check_indices(layer, above, &medium)?;
            }
            channel.push(TissueLayer { medium, thickness_mm });
        }
    }
    Ok(Scattering::Layers(layers))
}

fn check_indices(keys: &Keys, above: &TissueLayer, below: &Medium) -> Result<(), SceneError> {
    let (a, b) = (above.medium.refractive_index, below.refractive_index);
    if a.max(b) <= MAX_INDEX_RATIO * a.min(b) {
        return Ok(());
    }
    let reason =
        format!("is {b} under a layer of {a}; neighbours may differ by a factor of {MAX_INDEX_RATIO}");
    Err(keys.error("refractive_index", reason))
}

/// Coefficients per channel in 1/mm, from nearly clear to nearly opaque.
fn media(keys: &Keys) -> Result<[Medium; 3], SceneError> {
    let coefficients = |key, least| {
        keys.vector_in(key, least..=1e4)?;
        keys.required(key, keys.triple(key)?)
    };
    let sigma_a = coefficients("sigma_a_per_mm", 0.0)?;
    let sigma_s_reduced = coefficients("sigma_s_reduced_per_mm", LEAST_SCATTERING)?;
    let index = refractive_index(keys)?;
    Ok([0, 1, 2].map(|i| Medium {
        sigma_a_per_mm: sigma_a[i],
        sigma_s_reduced_per_mm: sigma_s_reduced[i],
        refractive_index: index[i],
    }))
}

/// One for all channels, or one for each.
fn refractive_index(keys: &Keys) -> Result<[f64; 3], SceneError> {
    if keys.kind("refractive_index") == Some("array") {
        keys.vector_in("refractive_index", 1.0..=3.0)?;
        return keys.required("refractive_index", keys.triple("refractive_index")?);
    }
    keys.number_in("refractive_index", 1.0..=3.0)?;
    Ok([keys.double("refractive_index")?.unwrap_or(1.4); 3])
}

/// A finished sum of Gaussians: variances, growing, and the weights of red, green and blue for each.
fn kernel(keys: &Keys) -> Result<Scattering, SceneError> {
    keys.only(&["variances_mm2", "weights"])?;
    let variances_mm2 = keys.required("variances_mm2", keys.doubles("variances_mm2", MAX_GAUSSIANS)?)?;
    let weights = keys.required("weights", keys.triples("weights", MAX_GAUSSIANS)?)?;
    if variances_mm2.is_empty() || weights.len() != variances_mm2.len() {
        let reason = format!("{} weights for {} variances", weights.len(), variances_mm2.len());
        return Err(keys.error("weights", reason));
    }
    // Variance 0 is light that does not spread; 1e6 mm² is a metre.
    let fit = |&v: &f64| (0.0..=1e6).contains(&v);
    if !variances_mm2.iter().all(fit) || variances_mm2.windows(2).any(|pair| pair[0] > pair[1]) {
        return Err(keys.error("variances_mm2", "must grow, from 0 to 1000000 mm²"));
    }
    Ok(Scattering::Kernel(RgbGaussianSum { variances_mm2, weights }))
}

/// `albedo` is a path or a linear colour; `albedo_colour` a factor on it.
fn albedo(keys: &Keys, images: &mut Images) -> Result<Option<ColourMap>, SceneError> {
    let factor = keys.vector_in("albedo_colour", 0.0..=1.0)?;
    match keys.kind("albedo") {
        None => Ok(factor.map(|factor| ColourMap { factor, texture: None })),
        Some("array") => {
            let colour = keys.vector_in("albedo", 0.0..=1.0)?.unwrap_or(Vec3::ONE);
            Ok(Some(ColourMap { factor: colour * factor.unwrap_or(Vec3::ONE), texture: None }))
        }
        Some("string") => {
            let text = keys.string("albedo")?.unwrap_or_default();
            let texture = texture(keys, "albedo", text, ColourSpace::Colour, images)?;
            Ok(Some(ColourMap { factor: factor.unwrap_or(Vec3::ONE), texture: Some(texture) }))
        }
        Some(kind) => {
            Err(keys.error("albedo", format!("must be a path or a list of three numbers, found {kind}")))
        }
    }
}

/// `normal` is a path, or `false` for a surface without relief.
fn normal(keys: &Keys, images: &mut Images) -> Result<Option<Option<NormalMap>>, SceneError> {
    let space = match keys.string("normal_space")? {
        None | Some("tangent") => NormalSpace::Tangent,
        Some("object") => NormalSpace::Object,
        Some(other) => {
            return Err(keys.error("normal_space", format!("`{other}` is not known; tangent and object are")));
        }
    };
    let strength = keys.number_in("normal_strength", -10.0..=10.0)?.unwrap_or(1.0);
    if keys.kind("normal") == Some("boolean") && keys.boolean("normal")? == Some(false) {
        return Ok(Some(None));
    }
    let Some(text) = keys.string("normal")? else {
        for key in ["normal_space", "normal_strength"] {
            if keys.has(key) {
                return Err(keys.error(key, "has no `normal` to apply to"));
            }
        }
        return Ok(None);
    };
    let texture = texture(keys, "normal", text, ColourSpace::Data, images)?;
    Ok(Some(Some(NormalMap { texture, space, strength })))
}

/// A number, a path (read as `by_path` says), or `{ path, channel, offset, gain }`.
fn scalar(
    keys: &Keys,
    key: &str,
    limits: std::ops::RangeInclusive<f32>,
    by_path: fn(Arc<Texture>) -> ScalarMap,
    images: &mut Images,
) -> Result<Option<ScalarMap>, SceneError> {
    match keys.kind(key) {
        None => Ok(None),
        Some("integer" | "float") => Ok(keys.number_in(key, limits)?.map(ScalarMap::constant)),
        Some("string") => {
            let text = keys.string(key)?.unwrap_or_default();
            Ok(Some(by_path(texture(keys, key, text, ColourSpace::Data, images)?)))
        }
        Some("table") => {
            let table = keys.required(key, keys.table(key)?)?;
            scalar_table(&table, images).map(Some)
        }
        Some(kind) => {
            let reason =
                format!("must be a number, a path, or {{ path, channel, offset, gain }}, found {kind}");
            Err(keys.error(key, reason))
        }
    }
}

fn scalar_table(keys: &Keys, images: &mut Images) -> Result<ScalarMap, SceneError> {
    keys.only(&["path", "channel", "offset", "gain"])?;
    let offset = keys.number_in("offset", -10.0..=10.0)?.unwrap_or(0.0);
    let gain = keys.number_in("gain", -10.0..=10.0)?.unwrap_or(1.0);
    let channel = match keys.string("channel")? {
        None | Some("red" | "r") => 0,
        Some("green" | "g") => 1,
        Some("blue" | "b") => 2,
        Some("alpha" | "a") => 3,
        Some(other) => {
            let reason = format!("`{other}` is not known; red, green, blue and alpha are");
            return Err(keys.error("channel", reason));
        }
    };
    let text = keys.required("path", keys.string("path")?)?;
    let texture = texture(keys, "path", text, ColourSpace::Data, images)?;
    Ok(ScalarMap { offset, gain, texture: Some((texture, channel)) })
}

/// Where the images of a material come from.
struct Images<'a, 'c> {
    own: &'a Material,
    context: &'a mut Context<'c>,
}

/// The image at a path, or one that the mesh itself brings.
fn texture(
    keys: &Keys,
    key: &str,
    text: &str,
    space: ColourSpace,
    images: &mut Images,
) -> Result<Arc<Texture>, SceneError> {
    let Images { own, context } = images;
    if let Some(place) = text.strip_prefix(MESH_PREFIX) {
        let found = own.maps().into_iter().find_map(|(name, map)| map.filter(|_| name == place));
        let there = own.maps().into_iter().filter(|(_, map)| map.is_some()).map(|(name, _)| name);
        let missing = || match there.collect::<Vec<_>>().join(", ") {
            none if none.is_empty() => "the mesh brings no maps".to_owned(),
            some => format!("the mesh brings no map `{place}`; it has {some}"),
        };
        return found.cloned().ok_or_else(|| keys.error(key, missing()));
    }
    let path = context.folder.resolve(text).map_err(|reason| keys.error(key, reason))?;
    context.textures.file(&path, space, &mut context.warnings)
}
