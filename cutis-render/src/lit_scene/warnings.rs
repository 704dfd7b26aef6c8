//! What a person should know of a scene that is drawn by a technique.

use crate::prepare::kernel::stacks;
use crate::prepare::mixtures::media_of;
use crate::settings::{AovSpace, Diffusion, Settings, TechniqueName};
use cutis_optics::{Dipole, Medium, Stack};
use cutis_scene::{Mesh, Object, Scattering, Scene};
use glam::Vec2;
use std::collections::BTreeMap;

/// What texture coordinates may miss each other by, and be the same.
const ROUNDING: f32 = 1e-4;

/// All of it, in words.
pub fn warnings(scene: &Scene, settings: &Settings) -> Vec<String> {
    let open = scene.objects.iter().filter(|object| !object.closed).map(|object| {
        let name = &object.name;
        format!("'{name}' is not a closed surface: light that enters may find no way out, and thin parts stay dark")
    });
    let invalid = scene.objects.iter().flat_map(|object| {
        let second = object.material.mixed_with.as_ref().map(|second| &second.scattering);
        std::iter::once(&object.material.scattering).chain(second).flat_map(beyond_the_model)
    });
    let left_out = left_out(scene, settings.technique, settings.diffusion);
    open.chain(invalid).chain(left_out).chain(laid_out_anew(scene, settings)).collect()
}

/// What diffusion is not good for.
fn beyond_the_model(scattering: &Scattering) -> Vec<String> {
    let of_media = |medium: Medium| {
        let validity = Dipole::new(&medium).ok()?.validity();
        (!validity.is_good()).then(|| validity.to_string())
    };
    match scattering {
        Scattering::Layers(channels) => stacks(channels).map_or_else(
            |_| Vec::new(),
            |stacks| {
                // Each layer once, whichever channels it is too thin for.
                let thin: BTreeMap<_, _> = stacks.iter().flat_map(Stack::too_thin).collect();
                thin.into_iter().map(|(layer, thin)| format!("layer {layer}: {thin}")).collect()
            },
        ),
        scattering => media_of(scattering).into_iter().flatten().filter_map(of_media).collect(),
    }
}

/// Says so where a material has what a technique, or its diffusion, does not know.
pub fn left_out(
    scene: &Scene,
    technique: TechniqueName,
    diffusion: Diffusion,
) -> impl Iterator<Item = String> {
    let of = move |object: &Object| {
        [
            layers_left_out(object, technique),
            mixture_left_out(object, technique),
            paths_left_out(object, technique, diffusion),
        ]
    };
    scene.objects.iter().flat_map(of).flatten()
}

/// Says so where layers in texture space are not laid out as a mesh's file says.
pub fn laid_out_anew(scene: &Scene, settings: &Settings) -> impl Iterator<Item = String> {
    let asked = settings.aov_space == AovSpace::Texture && !settings.aovs.is_empty();
    // Layers in texture space are those of the first object.
    let anew = scene.objects.first().filter(|object| asked && is_laid_anew(&object.mesh));
    anew.into_iter().map(|object| {
        format!(
            "layers in texture space of '{}' are laid out by the atlas that was made for its light, not by the texture \
             coordinates of its file",
            object.name
        )
    })
}

/// Whether light lies elsewhere than the file says, and not only on another tile, where textures repeat.
fn is_laid_anew(mesh: &Mesh) -> bool {
    let apart = |(atlas, map): (&Vec2, &Vec2)| (*atlas - *map - (*atlas - *map).round()).abs().max_element();
    mesh.atlas_uvs.as_ref().is_some_and(|uvs| uvs.iter().zip(&mesh.uvs).any(|pair| apart(pair) > ROUNDING))
}

fn layers_left_out(object: &Object, technique: TechniqueName) -> Option<String> {
    let (name, layers) = (&object.name, object.material.under.len());
    let are = if layers == 1 { "layer lies" } else { "layers lie" };
    (layers > 0 && technique != TechniqueName::TextureBlur).then(|| {
        format!(
            "{layers} {are} under the surface of '{name}' that the technique {technique} does not know: \
             texture-blur does"
        )
    })
}

fn mixture_left_out(object: &Object, technique: TechniqueName) -> Option<String> {
    let name = &object.name;
    let is_mixed = object.material.mixed_with.is_some() && technique != TechniqueName::ImageSpace;
    is_mixed.then(|| {
        format!(
            "a second medium is mixed into '{name}' that the technique {technique} does not know: image-space does"
        )
    })
}

fn paths_left_out(object: &Object, technique: TechniqueName, diffusion: Diffusion) -> Option<String> {
    let name = &object.name;
    let is_known = technique == TechniqueName::TextureSpace && diffusion == Diffusion::HeatFlow;
    (!is_known && !object.material.has_one_mean_free_path()).then(|| {
        format!(
            "the mean free path of '{name}' is scaled, which only the diffusion heat-flow of texture-space knows: it is \
             drawn as the medium has it"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Aov;
    use cutis_scene::head::HeadDetail;
    use cutis_scene::validation::maps::repeated_and_written_out;
    use cutis_scene::{ScalarMap, studio};

    /// What only heat flow knows is told by everybody else, and by nobody where it is as it always was.
    #[test]
    fn a_scaled_mean_free_path_is_told_where_it_is_not_drawn() {
        let mut scene = studio::head_in_the_studio(HeadDetail { triangles: 1000, map_size: 0 });
        let told = |scene: &Scene, technique, diffusion| {
            warnings(scene, &Settings { technique, diffusion, ..Settings::default() })
                .iter()
                .any(|warning| warning.contains("the mean free path of"))
        };
        let flows = (TechniqueName::TextureSpace, Diffusion::HeatFlow);
        let others = [
            (TechniqueName::TextureSpace, Diffusion::Separable),
            (TechniqueName::TextureBlur, Diffusion::HeatFlow),
            (TechniqueName::Truth, Diffusion::HeatFlow),
        ];
        assert!(others.iter().all(|&(technique, diffusion)| !told(&scene, technique, diffusion)));
        scene.objects[0].material.mean_free_path_scale = ScalarMap::constant(2.0);
        assert!(others.iter().all(|&(technique, diffusion)| told(&scene, technique, diffusion)));
        assert!(!told(&scene, flows.0, flows.1));
    }

    /// Who exports maps of light learns that the file's texture coordinates do not fit them.
    #[test]
    fn maps_by_an_atlas_that_was_made_are_told() {
        let [anew, as_it_was] = repeated_and_written_out();
        let settings = Settings { aovs: vec![Aov::Irradiance], ..Settings::default() };
        let in_texture = Settings { aov_space: AovSpace::Texture, ..settings.clone() };
        let told = |scene: &Scene, settings: &Settings| {
            warnings(scene, settings).iter().any(|warning| warning.contains("laid out by the atlas"))
        };
        assert!(told(&anew, &in_texture));
        assert!(!told(&anew, &settings) && !told(&as_it_was, &in_texture));
        let mut moved_by_tiles = as_it_was.clone();
        let mesh = &mut moved_by_tiles.objects[0].mesh;
        mesh.atlas_uvs = Some(mesh.uvs.clone());
        mesh.uvs.iter_mut().for_each(|uv| *uv += Vec2::new(3.0, -2.0));
        assert!(!told(&moved_by_tiles, &in_texture));
        let second = Scene { objects: [as_it_was.objects, anew.objects].concat(), ..anew };
        assert!(!told(&second, &in_texture), "layers are those of the first object");
    }
}
