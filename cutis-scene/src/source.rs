//! Where meshes and images came from, so that a scene can be saved without them.

use crate::Material;
use crate::head::HeadDetail;
use crate::read::AtlasChoice;
use std::path::PathBuf;
use std::sync::Arc;

/// What the meshes of a scene were made from.
#[derive(Debug, Clone, PartialEq)]
pub enum MeshOrigin {
    /// A file.
    File {
        /// Its place.
        path: PathBuf,
        /// Length of its unit, where somebody said so.
        millimetres_per_unit: Option<f32>,
        /// Whether v was turned around against the convention of the format.
        flip_v: bool,
        /// Where light lies.
        atlas: AtlasChoice,
    },
    /// The head made by code.
    BuiltInHead(HeadDetail),
}

/// Where one object came from.
#[derive(Debug, Clone)]
pub struct ObjectSource {
    /// What all objects of the origin share.
    pub origin: Arc<MeshOrigin>,
    /// Its number among them.
    pub number: usize,
    /// How many there are.
    pub count: usize,
    /// The material that the origin itself gives it.
    pub own_material: Material,
}

/// Where an image came from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TextureSource {
    /// A file of its own.
    File(PathBuf),
    /// The room of [`crate::studio::studio_environment`].
    Studio,
}
