//! The diffusion profile of every material of the scene, drawn into the page.

use crate::profile::figure_svg;
use cutis_scene::{Scattering, Scene};

/// Name of the space that SVG elements live in; within a page they need none.
const SPACE: &str = " xmlns=\"http://www.w3.org/2000/svg\"";

/// A figure with the materials it is of.
pub struct Figure {
    pub materials: String,
    pub svg: String,
}

/// A figure for each way of scattering; and why some are missing.
pub fn figures(scene: &Scene) -> (Vec<Figure>, Vec<String>) {
    let (mut figures, mut missing) = (Vec::new(), Vec::new());
    for (scattering, names) in distinct(scene) {
        match figure_svg(&names, scattering) {
            Ok(svg) => figures.push(Figure { materials: names, svg: svg.replace(SPACE, "") }),
            Err(error) => missing.push(format!("no figure of the profile of '{names}': {error}")),
        }
    }
    (figures, missing)
}

/// Every way of scattering, with the names of the materials that have it.
fn distinct(scene: &Scene) -> Vec<(&Scattering, String)> {
    let mut found: Vec<(String, &Scattering, Vec<&str>)> = Vec::new();
    for material in scene.objects.iter().map(|object| &object.material) {
        // What is written the same is the same: the types hold nothing but numbers and names.
        let key = format!("{:?}", material.scattering);
        match found.iter_mut().find(|(known, ..)| *known == key) {
            Some((.., names)) if names.contains(&material.name.as_str()) => {}
            Some((.., names)) => names.push(&material.name),
            None => found.push((key, &material.scattering, vec![&material.name])),
        }
    }
    found.into_iter().map(|(_, scattering, names)| (scattering, names.join(", "))).collect()
}
