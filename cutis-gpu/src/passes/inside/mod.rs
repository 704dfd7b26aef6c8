//! What leaves a body at the place that is looked at: the part of the final pass that each technique has of its own. The twins
//! of `Inside` in cutis-render and of its techniques.

pub mod depth_absorption;
pub mod wrap;

use crate::Gpu;
use crate::map::Map;
use crate::pipeline::Bound;
use crate::scene::SceneError;
use crate::scene::object::ObjectMaps;
use crate::scene::shared::Shared;
use cutis_render::{Settings, TechniqueName};
use cutis_scene::Object;
use depth_absorption::DepthAbsorptionMaps;
use glam::Vec3;
use wrap::WrapMaps;

/// What the technique knows of one object.
#[derive(Debug)]
pub enum Inside {
    /// Light that was spread in texture space is among the object's own textures.
    Spread,
    /// `image-space`: what is gathered belongs to the picture.
    Gathered,
    /// `wrap`.
    Wrap(WrapMaps),
    /// `depth-absorption`.
    DepthAbsorption(DepthAbsorptionMaps),
}

impl Inside {
    /// Whether a technique is drawn here.
    pub fn knows(technique: TechniqueName) -> bool {
        technique != TechniqueName::Truth
    }

    /// Uploads what the technique of the settings knows of an object, whose diffuse reflectance is `colour`.
    ///
    /// # Errors
    /// If its material does not serve.
    pub fn new(gpu: &Gpu, object: &Object, colour: Vec3, settings: &Settings) -> Result<Self, SceneError> {
        Ok(match settings.light_inside() {
            TechniqueName::Wrap => Self::Wrap(WrapMaps::new(gpu, &object.material, colour, settings)?),
            TechniqueName::ImageSpace => Self::Gathered,
            TechniqueName::DepthAbsorption => {
                Self::DepthAbsorption(DepthAbsorptionMaps::new(gpu, object, colour, settings)?)
            }
            _ => Self::Spread,
        })
    }

    /// What the technique's part of the final pass reads.
    /// `gathered` is what was gathered for the picture, for techniques that do.
    pub fn bound<'a>(
        &'a self,
        maps: &'a ObjectMaps,
        shared: &'a Shared,
        gathered: Option<&'a Map>,
    ) -> Vec<(u32, Bound<'a>)> {
        match self {
            Self::Gathered => gathered.map(|map| (30, Bound::Texture(&map.array))).into_iter().collect(),
            Self::Spread => vec![
                (30, Bound::Texture(maps.local.view())),
                (31, Bound::Texture(maps.charts.sizes[1].map.view())),
                (32, Bound::Texture(maps.transmission.view())),
            ],
            Self::Wrap(wrap) => wrap.bound(shared),
            Self::DepthAbsorption(maps) => maps.bound(shared),
        }
    }
}
