// Mean over 5 × 5 texels of the same chart, some texels apart, with binomial weights.

@group(0) @binding(1) var<uniform> smoothing: Smoothing;
@group(0) @binding(2) var charts: texture_2d<u32>;
@group(0) @binding(3) var map: texture_2d<f32>;

struct Smoothing {
    step: i32,
    /// How far light has got by this round and those before, texels.
    reach: i32,
    pad0: u32,
    pad1: u32,
}

@vertex
fn cover_thin_tile(@builtin(vertex_index) corner: u32, @builtin(instance_index) tile: u32) -> @builtin(position) vec4f {
    return corner_of_thin_tile(corner, tile, smoothing.reach);
}

@fragment
fn smooth_map(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2i(position.xy);
    let chart = textureLoad(charts, texel, 0).x;
    if chart == NO_CHART {
        return vec4f(0.0);
    }
    var weights = array(1.0, 4.0, 6.0, 4.0, 1.0);
    let size = vec2i(textureDimensions(charts));
    var sum = vec4f(0.0);
    var whole = 0.0;
    var i = 0;
    loop {
        let read = texel + smoothing.step * (vec2i(i % 5, i / 5) - 2);
        if all(read >= vec2i(0)) && all(read < size) && textureLoad(charts, read, 0).x == chart {
            let weight = weights[i % 5] * weights[i / 5];
            sum += textureLoad(map, read, 0) * weight;
            whole += weight;
        }
        continuing {
            i++;
            break if i >= 25;
        }
    }
    return sum / whole;
}
