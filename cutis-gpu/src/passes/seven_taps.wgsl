// The blur of Green 2004 (GPU Gems, listings 16-6 and 16-7). The twin of cutis-render's `seven_taps`.

@group(0) @binding(1) var<uniform> taps: SevenTaps;
@group(0) @binding(2) var light: texture_2d<f32>;
@group(0) @binding(3) var charts: texture_2d<u32>;
/// Colour of the layers under the surface that light passes after this step; one texel where there are none.
@group(0) @binding(4) var layers: texture_2d<f32>;
@group(0) @binding(5) var through: texture_2d<f32>;
@group(0) @binding(6) var half_charts: texture_2d<u32>;

struct SevenTaps {
    /// Weights of the taps for red, green and blue; their places in alpha, texels.
    all: array<vec4f, 7>,
    /// From one texel to the next.
    step_texels: vec2i,
    /// 0 along u, 1 along v.
    axis: u32,
    /// Factor on the places.
    factor: f32,
}

@fragment
fn blur_seven(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2i(position.xy);
    // Towards a seam taps come closer, so that none leaves the chart.
    let room = f32((textureLoad(charts, texel, 0).y >> (8u * taps.axis)) & 255u);
    let factor = min(taps.factor, room / taps.all[6].w);
    var sum = vec3f(0.0);
    for (var i = 0; i < 7; i++) {
        // The quotient above may be rounded upwards.
        let x = clamp(taps.all[i].w * factor, -room, room);
        let f = x - floor(x);
        let near = texel + taps.step_texels * i32(floor(x));
        let far = near + select(vec2i(0), taps.step_texels, f > 0.0);
        let first = textureLoad(light, near, 0).rgb;
        sum += (first + (textureLoad(light, far, 0).rgb - first) * f) * taps.all[i].rgb;
    }
    return vec4f(sum * colour_of_layers(texel), textureLoad(light, texel, 0).a);
}

/// The light before the first blur: what came through is added, and layers filter it that lie deeper than there are blurs.
@fragment
fn begin_blur(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2i(position.xy);
    let chart = textureLoad(charts, texel, 0).x;
    let half_texels = around(position.xy / vec2f(textureDimensions(charts)), textureDimensions(through));
    let weights = chart_weights(half_charts, half_texels, chart);
    let more = select(vec3f(0.0), blend(through, half_texels, weights).rgb, chart != NO_CHART);
    let here = textureLoad(light, texel, 0);
    return vec4f((here.rgb + more) * colour_of_layers(texel), here.a);
}

fn colour_of_layers(texel: vec2i) -> vec3f {
    return textureLoad(layers, min(texel, vec2i(textureDimensions(layers)) - 1), 0).rgb;
}
