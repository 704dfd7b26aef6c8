//! The WGSL of every pass, put together from the pass's own file and the shared ones it needs.

use cutis_render::TechniqueName;

macro_rules! wgsl {
    ($($file:literal),+ $(,)?) => { concat!($(include_str!($file), "\n"),+) };
}

/// Pass `deform`.
pub const DEFORM: &str = wgsl!("lib/mesh.wgsl", "lib/packing.wgsl", "passes/deform.wgsl");
/// Pass `stretch`.
pub const STRETCH: &str = wgsl!("lib/mesh.wgsl", "passes/stretch.wgsl");
/// Pass `atlas`.
pub const ATLAS: &str = wgsl!(
    "lib/tiles.wgsl",
    "lib/mesh.wgsl",
    "lib/packing.wgsl",
    "lib/material.wgsl",
    "lib/relief.wgsl",
    "passes/atlas.wgsl"
);
/// Pass `shadow map`.
pub const SHADOW: &str =
    wgsl!("lib/mesh.wgsl", "lib/lights.wgsl", "lib/light_map.wgsl", "passes/shadow.wgsl");
/// Pass `depth map`.
pub const DEPTH_MAP: &str = wgsl!(
    "lib/mesh.wgsl",
    "lib/packing.wgsl",
    "lib/lights.wgsl",
    "lib/light_map.wgsl",
    "lib/material.wgsl",
    "lib/relief.wgsl",
    "lib/rho_dt.wgsl",
    "passes/depth_map.wgsl"
);
/// Pass `openness`.
pub const OPENNESS: &str = wgsl!(
    "lib/tiles.wgsl",
    "lib/charts.wgsl",
    "lib/packing.wgsl",
    "lib/lights.wgsl",
    "lib/light_map.wgsl",
    "passes/openness.wgsl"
);
/// Pass `shadows`.
pub const VISIBILITY: &str = wgsl!(
    "lib/tiles.wgsl",
    "lib/charts.wgsl",
    "lib/packing.wgsl",
    "lib/lights.wgsl",
    "lib/light_map.wgsl",
    "lib/sampling.wgsl",
    "lib/translucent.wgsl",
    "passes/visibility.wgsl"
);
/// Pass `irradiance`.
pub const IRRADIANCE: &str = wgsl!(
    "lib/tiles.wgsl",
    "lib/charts.wgsl",
    "lib/packing.wgsl",
    "lib/lights.wgsl",
    "lib/material.wgsl",
    "lib/rho_dt.wgsl",
    "lib/environment.wgsl",
    "lib/ambient.wgsl",
    "passes/irradiance.wgsl"
);
/// Pass `shares`.
pub const SHARES: &str = wgsl!(
    "lib/tiles.wgsl",
    "lib/packing.wgsl",
    "lib/lights.wgsl",
    "lib/material.wgsl",
    "lib/rho_dt.wgsl",
    "passes/shares.wgsl"
);
/// Pass `taps`.
pub const TAPS: &str = wgsl!("lib/tiles.wgsl", "lib/charts.wgsl", "passes/taps.wgsl");
/// Pass `blur`: one step along one axis.
pub const BLUR: &str = wgsl!("lib/tiles.wgsl", "passes/blur.wgsl");
/// Pass `blur`: to half the size.
pub const HALVE: &str = wgsl!("lib/tiles.wgsl", "lib/charts.wgsl", "passes/halve.wgsl");
/// Pass `heat flow`: from texel to texel.
pub const HEAT_FLOW: &str =
    wgsl!("lib/tiles.wgsl", "lib/rounding.wgsl", "lib/heat.wgsl", "passes/heat_flow/step.wgsl");
/// Pass `heat flow`: to half the size.
pub const HEAT_HALVE: &str = wgsl!("lib/tiles.wgsl", "lib/rounding.wgsl", "passes/heat_flow/halve.wgsl");
/// Pass `heat flow`: at the edges of charts.
pub const HEAT_ROWS: &str = wgsl!("lib/rounding.wgsl", "lib/heat.wgsl", "passes/heat_flow/rows.wgsl");
/// Pass `blur` of the technique `texture-blur`.
pub const SEVEN_TAPS: &str = wgsl!("lib/tiles.wgsl", "lib/charts.wgsl", "passes/seven_taps.wgsl");
/// Pass `transmission` of the technique `texture-blur`.
pub const THIN_PARTS: &str = wgsl!(
    "lib/tiles.wgsl",
    "lib/charts.wgsl",
    "lib/packing.wgsl",
    "lib/lights.wgsl",
    "lib/light_map.wgsl",
    "lib/translucent.wgsl",
    "passes/thin_parts.wgsl"
);
/// Pass `gather`.
pub const GATHER: &str = wgsl!("lib/tiles.wgsl", "lib/charts.wgsl", "lib/levels.wgsl", "passes/gather.wgsl");
/// Pass `transmission`.
pub const TRANSMISSION: &str = wgsl!(
    "lib/tiles.wgsl",
    "lib/thin_tiles.wgsl",
    "lib/charts.wgsl",
    "lib/packing.wgsl",
    "lib/lights.wgsl",
    "lib/light_map.wgsl",
    "lib/translucent.wgsl",
    "lib/levels.wgsl",
    "passes/transmission.wgsl"
);
/// Pass `transmission`: smoothing.
pub const SMOOTH: &str =
    wgsl!("lib/tiles.wgsl", "lib/thin_tiles.wgsl", "lib/charts.wgsl", "passes/smooth.wgsl");
/// Pass `resolve` with the part of a technique.
macro_rules! resolve {
    ($($file:literal),+ $(,)?) => {
        wgsl!(
            "lib/mesh.wgsl",
            "lib/charts.wgsl",
            "lib/packing.wgsl",
            "lib/lights.wgsl",
            "lib/material.wgsl",
            "lib/relief.wgsl",
            "lib/rho_dt.wgsl",
            "lib/specular.wgsl",
            "lib/environment.wgsl",
            "lib/camera.wgsl",
            "lib/see.wgsl",
            "passes/resolve.wgsl",
            "passes/layer.wgsl",
            $($file),+
        )
    };
}
/// Pass `resolve` of `texture-space`.
pub const RESOLVE: &str = resolve!("passes/inside/texture_space.wgsl");
/// Pass `resolve` of `wrap`.
pub const RESOLVE_WRAP: &str = resolve!("lib/ambient.wgsl", "lib/light_map.wgsl", "passes/inside/wrap.wgsl");
/// Pass `resolve` of `image-space`.
pub const RESOLVE_IMAGE_SPACE: &str = resolve!("passes/inside/image_space.wgsl");
/// Pass `irradiance image`: what the final pass knows of a place, without its technique.
pub const IRRADIANCE_IMAGE: &str = resolve!(
    "lib/ambient.wgsl",
    "lib/light_map.wgsl",
    "passes/inside/image_space.wgsl",
    "passes/irradiance_image.wgsl"
);
/// Pass `sample profile`.
pub const SAMPLE_PROFILE: &str = wgsl!(
    "lib/cover.wgsl",
    "lib/packing.wgsl",
    "lib/mesh.wgsl",
    "lib/lights.wgsl",
    "lib/light_map.wgsl",
    "lib/camera.wgsl",
    "passes/sample_profile.wgsl"
);
/// Pass `resolve` of `depth-absorption`.
pub const RESOLVE_DEPTH_ABSORPTION: &str = resolve!(
    "lib/ambient.wgsl",
    "lib/light_map.wgsl",
    "lib/sampling.wgsl",
    "lib/translucent.wgsl",
    "passes/inside/depth_absorption.wgsl"
);
/// Pass `resolve`: what lies behind everything.
pub const SKY: &str = wgsl!("lib/mesh.wgsl", "lib/camera.wgsl", "lib/environment.wgsl", "passes/sky.wgsl");
/// Pass `downsample`.
pub const DOWNSAMPLE: &str = wgsl!("lib/cover.wgsl", "passes/downsample.wgsl");
/// Pass `bloom`.
pub const BLOOM: &str = wgsl!("lib/cover.wgsl", "lib/film.wgsl", "passes/bloom.wgsl");
/// Pass `tone map`.
pub const TONE_MAP: &str = wgsl!(
    "lib/cover.wgsl",
    "lib/film.wgsl",
    "lib/dither.wgsl",
    "lib/tone_mappers.wgsl",
    "passes/tone_map.wgsl"
);

/// Pass `resolve` as a technique has it.
pub fn resolve(technique: TechniqueName) -> &'static str {
    match technique {
        TechniqueName::Wrap => RESOLVE_WRAP,
        TechniqueName::ImageSpace => RESOLVE_IMAGE_SPACE,
        TechniqueName::DepthAbsorption => RESOLVE_DEPTH_ABSORPTION,
        _ => RESOLVE,
    }
}

/// All of them by name.
pub const ALL: [(&str, &str); 30] = [
    ("deform", DEFORM),
    ("stretch", STRETCH),
    ("atlas", ATLAS),
    ("shadow", SHADOW),
    ("depth map", DEPTH_MAP),
    ("openness", OPENNESS),
    ("visibility", VISIBILITY),
    ("irradiance", IRRADIANCE),
    ("shares", SHARES),
    ("taps", TAPS),
    ("blur", BLUR),
    ("halve", HALVE),
    ("heat flow", HEAT_FLOW),
    ("heat flow, halving", HEAT_HALVE),
    ("heat flow, edges", HEAT_ROWS),
    ("seven taps", SEVEN_TAPS),
    ("thin parts", THIN_PARTS),
    ("gather", GATHER),
    ("transmission", TRANSMISSION),
    ("smooth", SMOOTH),
    ("resolve", RESOLVE),
    ("resolve of wrap", RESOLVE_WRAP),
    ("resolve of image-space", RESOLVE_IMAGE_SPACE),
    ("irradiance image", IRRADIANCE_IMAGE),
    ("sample profile", SAMPLE_PROFILE),
    ("resolve of depth-absorption", RESOLVE_DEPTH_ABSORPTION),
    ("sky", SKY),
    ("downsample", DOWNSAMPLE),
    ("bloom", BLOOM),
    ("tone map", TONE_MAP),
];
