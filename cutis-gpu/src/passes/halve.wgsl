// To half the size: the mean over the four texels of the same chart. The stretch counts for coarse texels.

@group(0) @binding(1) var<uniform> halved: Halved;
@group(0) @binding(2) var fine_charts: texture_2d<u32>;
@group(0) @binding(3) var charts: texture_2d<u32>;
@group(0) @binding(4) var light: texture_2d_array<f32>;
@group(0) @binding(5) var stretch_map: texture_2d<f32>;

struct Halved {
    layer: u32,
    pad0: u32,
    pad1: u32,
    pad2: u32,
}

struct Coarse {
    @location(0) light: vec4f,
    @location(1) stretch: vec4f,
}

fn mean_of_children(texel: vec2i) -> Coarse {
    let chart = textureLoad(charts, texel, 0).x;
    var sum = Coarse(vec4f(0.0), vec4f(0.0));
    if chart == NO_CHART {
        return sum;
    }
    var count = 0.0;
    for (var i = 0; i < 4; i++) {
        let child = 2 * texel + vec2i(i & 1, i >> 1u);
        if textureLoad(fine_charts, child, 0).x == chart {
            sum.light += textureLoad(light, child, halved.layer, 0);
            sum.stretch += textureLoad(stretch_map, child, 0);
            count += 1.0;
        }
    }
    return Coarse(sum.light / count, 2.0 * sum.stretch / count);
}

@fragment
fn halve(@builtin(position) position: vec4f) -> Coarse {
    return mean_of_children(vec2i(position.xy));
}

/// The same for a further layer, whose stretch is already halved.
@fragment
fn halve_layer(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return mean_of_children(vec2i(position.xy)).light;
}
