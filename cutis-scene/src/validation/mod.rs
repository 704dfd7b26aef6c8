//! Small scenes to judge techniques by, one question each. Their pictures by simulation are kept, so what is written here
//! is not changed without rendering those anew.
//!
//! All bodies are closed and rough, all lamps have an extent: a simulation needs both.

mod bodies;
mod heads;
pub mod maps;
pub mod shapes;

use crate::read::asset;
use crate::{Scene, SceneError};

/// A scene and what it asks.
#[derive(Debug, Clone, Copy)]
pub struct ValidationScene {
    /// Name of the scene and of its files.
    pub name: &'static str,
    /// What a technique is asked by it.
    pub question: &'static str,
    /// File from outside that it needs, on the shelf of assets.
    pub needs: Option<&'static str>,
    make: fn() -> Result<Scene, SceneError>,
}

/// All of them, the plain bodies first.
pub const SCENES: [ValidationScene; 7] = [
    ValidationScene {
        name: "shadow-edge",
        question: "how light spreads into a sharp shadow on flat skin",
        needs: None,
        make: || Ok(bodies::shadow_edge()),
    },
    ValidationScene {
        name: "sphere",
        question: "how light passes the terminator of a ball of 20 mm, lit from the side",
        needs: None,
        make: || Ok(bodies::sphere()),
    },
    ValidationScene {
        name: "thin-slab",
        question: "how light comes through a plate of 2 mm, lit from behind",
        needs: None,
        make: || Ok(bodies::thin_slab()),
    },
    ValidationScene {
        name: "gap",
        question: "how light goes on between two fingers 1 mm apart",
        needs: None,
        make: || Ok(bodies::gap()),
    },
    ValidationScene {
        name: "head-front",
        question: "a scanned head, lit from the front",
        needs: Some(heads::SCAN),
        make: heads::front,
    },
    ValidationScene {
        name: "ear-backlit",
        question: "an ear of the scanned head with the lamp behind it",
        needs: Some(heads::SCAN),
        make: heads::ear,
    },
    ValidationScene {
        name: "built-in-head",
        question: "layered skin with a colour of its own",
        needs: None,
        make: || Ok(heads::built_in()),
    },
];

impl ValidationScene {
    /// Makes the scene.
    ///
    /// # Errors
    /// If a file that it needs cannot be read.
    pub fn make(&self) -> Result<Scene, SceneError> {
        (self.make)()
    }

    /// Why it cannot be made here: the file that it needs is not there.
    pub fn missing(&self) -> Option<String> {
        asset(self.needs?).err()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::charts::Charts;
    use crate::closing::check_closed;

    #[test]
    fn all_bodies_are_closed_and_fill_their_texture_once() {
        for validation in SCENES {
            // What is missing here is said by the tests of the program.
            if validation.missing().is_some() {
                continue;
            }
            let name = validation.name;
            let scene = validation.make().expect("it can be made");
            assert!(!scene.objects.is_empty() && !scene.lights.is_empty(), "{name}");
            assert!(scene.lights.iter().all(crate::Light::has_extent), "{name}: sharp lights");
            for object in &scene.objects {
                let mesh = &object.mesh;
                check_closed(mesh).expect(name);
                assert!(Charts::inside_unit_square(mesh), "{name}");
                assert!(Charts::overlap_fraction(mesh, 256) < 0.01, "{name}");
                assert!(object.material.roughness.offset > 0.0, "{name}");
            }
        }
    }
}
