// Reads that never mix charts. A chart map holds the number of the chart in x and how many texels of it follow without a
// gap on both sides in y: along u in the low byte, along v in the high one.

const NO_CHART: u32 = 65535u;

/// Four texels around a place, and their weights in a bilinear read.
struct Around {
    first: vec2i,
    last: vec2i,
    weights: vec4f,
}

fn around(uv: vec2f, size: vec2u) -> Around {
    let place = uv * vec2f(size) - 0.5;
    let corner = floor(place);
    let f = place - corner;
    let end = vec2i(size) - 1;
    let first = clamp(vec2i(corner), vec2i(0), end);
    let last = clamp(vec2i(corner) + 1, vec2i(0), end);
    let weights = vec4f((1.0 - f.x) * (1.0 - f.y), f.x * (1.0 - f.y), (1.0 - f.x) * f.y, f.x * f.y);
    return Around(first, last, weights);
}

/// The weights of those texels that belong to `chart`, scaled to sum 1; all 0 if none does.
fn chart_weights(charts: texture_2d<u32>, texels: Around, chart: u32) -> vec4f {
    return halved_chart_weights(charts, 0u, texels, chart);
}

/// The same on charts that are halved so often.
fn halved_chart_weights(charts: texture_2d<u32>, halvings: u32, texels: Around, chart: u32) -> vec4f {
    let a = textureLoad(charts, texels.first, halvings).x;
    let b = textureLoad(charts, vec2i(texels.last.x, texels.first.y), halvings).x;
    let c = textureLoad(charts, vec2i(texels.first.x, texels.last.y), halvings).x;
    let d = textureLoad(charts, texels.last, halvings).x;
    let own = select(vec4f(0.0), texels.weights, vec4u(a, b, c, d) == vec4u(chart));
    let sum = own.x + own.y + own.z + own.w;
    // Below a thousandth the quotient would only magnify rounding.
    if sum <= 1e-3 {
        return vec4f(0.0);
    }
    return own / sum;
}

fn blend(map: texture_2d<f32>, texels: Around, weights: vec4f) -> vec4f {
    return textureLoad(map, texels.first, 0) * weights.x
        + textureLoad(map, vec2i(texels.last.x, texels.first.y), 0) * weights.y
        + textureLoad(map, vec2i(texels.first.x, texels.last.y), 0) * weights.z
        + textureLoad(map, texels.last, 0) * weights.w;
}

fn blend_layer(map: texture_2d_array<f32>, layer: u32, texels: Around, weights: vec4f) -> vec4f {
    return blend_halved(map, 0u, layer, texels, weights);
}

fn blend_halved(map: texture_2d_array<f32>, halvings: u32, layer: u32, texels: Around, weights: vec4f) -> vec4f {
    return textureLoad(map, texels.first, layer, halvings) * weights.x
        + textureLoad(map, vec2i(texels.last.x, texels.first.y), layer, halvings) * weights.y
        + textureLoad(map, vec2i(texels.first.x, texels.last.y), layer, halvings) * weights.z
        + textureLoad(map, texels.last, layer, halvings) * weights.w;
}

/// The first of the four texels from `corner` on that belongs to the chart: those under one of half the size.
fn first_texel_under(charts: texture_2d<u32>, chart: u32, corner: vec2i) -> vec2i {
    for (var i = 0; i < 4; i++) {
        let texel = corner + vec2i(i & 1, i >> 1u);
        if textureLoad(charts, texel, 0).x == chart {
            return texel;
        }
    }
    return corner;
}
