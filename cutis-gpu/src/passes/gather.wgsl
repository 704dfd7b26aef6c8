// One Gaussian's part of the light under the surface, added to that of the others: the kernel's sum, once for every texel
// rather than for every sample of the picture.

@group(0) @binding(1) var<uniform> gaussian: Gaussian;
@group(0) @binding(2) var charts: texture_2d<u32>;
@group(0) @binding(3) var level: texture_2d_array<f32>;
@group(0) @binding(4) var level_charts: texture_2d<u32>;
@group(0) @binding(5) var finer: texture_2d_array<f32>;
@group(0) @binding(6) var finer_charts: texture_2d<u32>;
@group(0) @binding(7) var finest: texture_2d_array<f32>;

struct Gaussian {
    weight: vec3f,
    pad0: f32,
}

/// For a level of full size, whose texels are those of the sum.
@fragment
fn gather_texel(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return vec4f(gaussian.weight * textureLoad(level, vec2i(position.xy), 0, 0).rgb, 0.0);
}

@fragment
fn gather(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let chart = textureLoad(charts, vec2i(position.xy), 0).x;
    if chart == NO_CHART {
        return vec4f(0.0);
    }
    let uv = position.xy / vec2f(textureDimensions(charts));
    let light = sample_level(level, level_charts, finer, finer_charts, finest, 0u, uv, chart);
    return vec4f(gaussian.weight * light.rgb, 0.0);
}
