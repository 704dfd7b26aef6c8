//! Numbers of a technique as JSON; units are in the names.

use cutis_render::TechniqueName;
use cutis_render::settings::TechniqueSettings;
use cutis_render::technique::depth_absorption::{DepthAbsorptionSettings, FallOff};
use cutis_render::technique::image_space::ImageSpaceSettings;
use cutis_render::technique::texture_blur::{BlurWidth, TextureBlurSettings};
use cutis_render::technique::wrap::WrapSettings;
use serde::Serialize;

/// The numbers of one technique.
#[derive(Debug, Clone, Serialize)]
#[serde(untagged)]
pub enum TechniqueReport {
    Wrap {
        wrap: f32,
        scatter_width: f32,
        scatter_colour_rgb: [f32; 3],
        form: String,
        energy_conserving: bool,
        radius_mm: Option<f32>,
        shine: String,
        shininess: f32,
        specular_colour_rgb: [f32; 3],
        shadow_offset_mm: f32,
    },
    DepthAbsorption {
        fall_off: FallOffReport,
        growth_mm: f32,
        entry: String,
        samples: u32,
        filter_radius_mm: f32,
        layers: u32,
    },
    TextureBlur {
        weights: String,
        passes: u32,
        blend: f32,
        /// Times the listing's; null: as wide as the material asks for.
        width_factor: Option<f32>,
        depth: bool,
    },
    ImageSpace {
        samples: u32,
        uniform_samples: u32,
        /// Null: that of 95 % of the light.
        uniform_radius_mm: Option<f32>,
        jacobian: bool,
        count: String,
        light_views: bool,
        profile: String,
        round: u32,
    },
}

/// What a distance through the body leaves.
#[derive(Debug, Clone, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum FallOffReport {
    Material,
    Exponential { sigma_t_per_mm_rgb: [f32; 3] },
    Ramp { stops: Vec<StopReport> },
}

/// A stop of a ramp.
#[derive(Debug, Clone, Serialize)]
pub struct StopReport {
    distance_mm: f32,
    linear_rgb: [f32; 3],
}

impl TechniqueReport {
    /// Of a technique; none where it has no numbers of its own.
    pub fn of(technique: TechniqueName, settings: &TechniqueSettings) -> Option<Self> {
        match technique {
            TechniqueName::Wrap => Some(Self::of_wrap(&settings.wrap)),
            TechniqueName::DepthAbsorption => Some(Self::of_depth_absorption(&settings.depth_absorption)),
            TechniqueName::TextureBlur => Some(Self::of_texture_blur(&settings.texture_blur)),
            TechniqueName::ImageSpace => Some(Self::of_image_space(&settings.image_space)),
            TechniqueName::TextureSpace | TechniqueName::Truth => None,
        }
    }

    // All fields by name: one that is new in a technique cannot be forgotten here.
    fn of_wrap(settings: &WrapSettings) -> Self {
        let WrapSettings {
            wrap,
            scatter_width,
            scatter_colour,
            shininess,
            form,
            energy_conserving,
            radius_mm,
            shine,
            specular_colour,
            shadow_offset_mm,
        } = *settings;
        Self::Wrap {
            wrap,
            scatter_width,
            scatter_colour_rgb: scatter_colour.to_array(),
            form: form.to_string(),
            energy_conserving,
            radius_mm,
            shine: shine.to_string(),
            shininess,
            specular_colour_rgb: specular_colour.to_array(),
            shadow_offset_mm,
        }
    }

    fn of_depth_absorption(settings: &DepthAbsorptionSettings) -> Self {
        let DepthAbsorptionSettings { fall_off, growth_mm, entry, samples, filter_radius_mm, layers } =
            settings;
        Self::DepthAbsorption {
            fall_off: FallOffReport::new(fall_off),
            growth_mm: *growth_mm,
            entry: entry.to_string(),
            samples: *samples,
            filter_radius_mm: *filter_radius_mm,
            layers: *layers,
        }
    }

    fn of_texture_blur(settings: &TextureBlurSettings) -> Self {
        let TextureBlurSettings { weights, passes, blend, width, depth } = *settings;
        let width_factor = match width {
            BlurWidth::Listing(factor) => Some(factor),
            BlurWidth::Material => None,
        };
        Self::TextureBlur { weights: weights.to_string(), passes, blend, width_factor, depth }
    }

    fn of_image_space(settings: &ImageSpaceSettings) -> Self {
        let ImageSpaceSettings {
            samples,
            uniform_samples,
            uniform_radius_mm,
            jacobian,
            count,
            light_views,
            profile,
            round,
        } = *settings;
        Self::ImageSpace {
            samples,
            uniform_samples,
            uniform_radius_mm,
            jacobian,
            count: count.to_string(),
            light_views,
            profile: profile.to_string(),
            round,
        }
    }
}

impl FallOffReport {
    fn new(fall_off: &FallOff) -> Self {
        match fall_off {
            FallOff::Material => Self::Material,
            FallOff::Exponential(sigma_t) => Self::Exponential { sigma_t_per_mm_rgb: sigma_t.to_array() },
            FallOff::Ramp(ramp) => {
                let stop = |&(distance_mm, rgb): &(f32, glam::Vec3)| StopReport {
                    distance_mm,
                    linear_rgb: rgb.to_array(),
                };
                Self::Ramp { stops: ramp.stops().iter().map(stop).collect() }
            }
        }
    }
}
