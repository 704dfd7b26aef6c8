// A layer beside the picture, seen through the camera.

@group(1) @binding(0) var<uniform> wanted: Wanted;
@group(1) @binding(1) var level: texture_2d_array<f32>;
@group(1) @binding(2) var level_charts: texture_2d<u32>;

struct Wanted {
    layer: u32,
    /// Samples of a pixel.
    samples: u32,
    pad0: u32,
    pad1: u32,
}

const LEVEL: u32 = 0u;
const DISTANCES: u32 = 1u;
const DISTANCE_OF_ONE: u32 = 2u;
const NORMAL: u32 = 3u;
const ALBEDO: u32 = 4u;
const SPECULAR: u32 = 5u;
const TRANSMISSION: u32 = 6u;
const DIFFUSE: u32 = 7u;
const EXITANCE: u32 = 8u;
const CHARTS: u32 = 9u;
const TEXEL: u32 = 10u;
const SAMPLES: u32 = 11u;
const WAYS: u32 = 12u;

@fragment
fn show(seen: Seen) -> @location(0) vec4f {
    let place = place_at(seen);
    let parts = parts_at(place);
    let texels = around(place.atlas_uv, textureDimensions(level));
    let weights = chart_weights(level_charts, texels, place.chart);
    let value = blend_layer(level, 0u, texels, weights);
    switch wanted.layer {
        case LEVEL: { return vec4f(value.rgb, 1.0); }
        case DISTANCES: { return blend_layer(level, 1u, texels, weights); }
        case DISTANCE_OF_ONE: { return vec4f(value.w, 0.0, 0.0, 0.0); }
        case WAYS: { return distances_at(place); }
        case NORMAL: { return vec4f(place.normal, 1.0); }
        case ALBEDO: { return vec4f(place.albedo, 1.0); }
        case SPECULAR: { return vec4f(parts.specular, 1.0); }
        case TRANSMISSION: { return vec4f(parts.transmission, 1.0); }
        case DIFFUSE: { return vec4f(parts.diffuse + parts.transmission, 1.0); }
        case EXITANCE: { return vec4f(parts.exitance, 1.0); }
        case CHARTS: { return vec4f(f32(place.chart)); }
        case SAMPLES: { return vec4f(vec2f(f32(wanted.samples)), 0.0, 0.0); }
        case TEXEL: { return vec4f(textureLoad(level, vec2i(place.atlas_uv * vec2f(textureDimensions(level))), 0, 0).xy, 0.0, 1.0); }
        default: { return vec4f(0.0); }
    }
}
