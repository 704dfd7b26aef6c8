// One blur step along one axis of the texture (d'Eon, Luebke & Enderton 2007, sections 5.1 and 5.4). The twin of
// cutis-render's `blur`.
//
// The processor reads seven taps, interpolated cubically where they are close. A Gaussian sampled at every texel has the
// same variance and costs less here: most have a deviation of one or two texels, and no weight need be looked up.

@group(0) @binding(1) var<uniform> along: Along;
@group(0) @binding(2) var light: texture_2d<f32>;
/// Variance of the Gaussian ahead and behind, texel², at half the size: see `taps.wgsl`.
@group(0) @binding(3) var variances: texture_2d<f32>;
@group(0) @binding(4) var charts: texture_2d<u32>;
/// Sampled, a texel costs adapters without texture units half of what loading it does.
@group(0) @binding(5) var nearest: sampler;

struct Along {
    step_texels: vec2f,
    /// 0 along u, 1 along v.
    axis: u32,
    pad0: u32,
}

/// Deviations that are taken in; `taps.wgsl` makes up for what lies beyond.
const DEVIATIONS: f32 = 3.3;

/// What has been read so far. Either side has half of the light, and half of the centre is its own.
struct Sides {
    uv: vec2f,
    /// From one texel to the next.
    step_uv: vec2f,
    ahead: vec4f,
    behind: vec4f,
    whole: vec2f,
    /// Of the next distance: exp(-d²/2v) for d = 1, 2, 3 … by two products each.
    weight: vec2f,
    growth: vec2f,
    growth_of_growth: vec2f,
    /// Distance in texels beyond which weights are next to nothing.
    farthest: i32,
}

fn sides(position: vec2f) -> Sides {
    let texel = vec2i(position);
    let size = vec2f(textureDimensions(light));
    // Towards a seam taps come closer, so that none leaves the chart.
    let reach = f32((textureLoad(charts, texel, 0).y >> (8u * along.axis)) & 255u);
    let widest = max((reach - 0.5) / DEVIATIONS, 0.0);
    let half_texel = min(texel / 2, vec2i(textureDimensions(variances)) - 1);
    let variance = min(textureLoad(variances, half_texel, 0).xy, vec2f(widest * widest));
    let q = exp(-0.5 / max(variance, vec2f(0.02)));
    let centre = 0.5 * textureLoad(light, texel, 0);
    let farthest = i32(DEVIATIONS * sqrt(max(variance.x, variance.y)) + 0.5);
    return Sides(position / size, along.step_texels / size, centre, centre, vec2f(0.5), q, q * q * q, q * q, farthest);
}

fn at(uv: vec2f) -> vec4f {
    return textureSampleLevel(light, nearest, uv, 0.0);
}

/// With what lies `d` and `d + 1` texels away.
fn two_more(before: Sides, d: i32) -> Sides {
    let near = f32(d) * before.step_uv;
    let far = near + before.step_uv;
    // What lies beyond the farthest may be another chart's.
    let second = select(vec2f(0.0), before.weight * before.growth, d < before.farthest);
    let growth = before.growth * before.growth_of_growth;
    var sides = before;
    sides.ahead += at(before.uv + near) * before.weight.x + at(before.uv + far) * second.x;
    sides.behind += at(before.uv - near) * before.weight.y + at(before.uv - far) * second.y;
    sides.whole += before.weight + second;
    sides.weight = second * growth;
    sides.growth = growth * before.growth_of_growth;
    return sides;
}

fn together(sides: Sides) -> vec4f {
    return sides.ahead * (0.5 / sides.whole.x) + sides.behind * (0.5 / sides.whole.y);
}

@fragment
fn blur(@builtin(position) position: vec4f) -> @location(0) vec4f {
    var read = sides(position.xy);
    var d = 1;
    // One look whether it is enough for two distances.
    loop {
        read = two_more(read, d);
        continuing {
            d += 2;
            break if d > read.farthest;
        }
    }
    return together(read);
}
