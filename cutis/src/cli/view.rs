//! Arguments of `cutis view`.

use super::names;
use crate::backend::Backend;
use clap::Args;
use cutis_scene::AtlasChoice;
use std::path::PathBuf;

/// Arguments of `cutis view`.
#[derive(Debug, Args)]
pub struct ViewArgs {
    /// Scene to look at: .toml, .glb, .gltf or .obj; left out: the built-in head. Others can be dropped into the window
    pub scene: Option<PathBuf>,
    /// Where it is computed; auto: on a graphics processor if there is one, else on the processor; gpu: on any graphics
    /// adapter, also a program that stands in for one
    #[arg(long, value_name = "NAME", default_value_t = Backend::Auto.to_string(), value_parser = names(Backend::ALL))]
    pub backend: String,
    /// Length of the mesh file's unit [mm, above 0, default: what the file says; 1000 for glTF]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub millimetres_per_unit: Option<f32>,
    /// Where light lies: own: where the mesh's texture coordinates say, if they can carry it; new: in an atlas that is made, with
    /// even texels [own or new, default: what the scene file says, else own]
    #[arg(long, value_name = "NAME", value_parser = names(AtlasChoice::ALL.map(AtlasChoice::name)))]
    pub atlas: Option<String>,
    /// Latitude-longitude map that lights the scene from all around (.exr or .hdr), instead of its own
    #[arg(long, value_name = "FILE")]
    pub environment: Option<PathBuf>,
}
