// To half the size: the mean over the four texels of the same chart.

@group(0) @binding(1) var<uniform> halved: Halved;
@group(0) @binding(2) var fine_charts: texture_2d<u32>;
@group(0) @binding(3) var charts: texture_2d<u32>;
@group(0) @binding(4) var fine: texture_2d_array<f32>;

struct Halved {
    layer: u32,
    /// 1 for light; 2 for stretch, which counts for coarse texels.
    factor: f32,
    pad0: u32,
    pad1: u32,
}

@fragment
fn halve(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2i(position.xy);
    let chart = textureLoad(charts, texel, 0).x;
    var sum = vec4f(0.0);
    if chart == NO_CHART {
        return sum;
    }
    var count = 0.0;
    for (var i = 0; i < 4; i++) {
        let child = 2 * texel + vec2i(i & 1, i >> 1u);
        if textureLoad(fine_charts, child, 0).x == chart {
            sum += textureLoad(fine, child, halved.layer, 0);
            count += 1.0;
        }
    }
    return sum * (halved.factor / count);
}
