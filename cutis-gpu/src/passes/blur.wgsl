// One blur step along one axis of the texture (d'Eon, Luebke & Enderton 2007, sections 5.1 and 5.4). The twin of
// cutis-render's `blur`.
//
// The processor reads seven taps, interpolated cubically where they are close. A Gaussian sampled at every texel has the
// same variance and costs less here: most have a deviation of one or two texels, and no weight need be looked up.

@group(0) @binding(1) var<uniform> along: Along;
@group(0) @binding(2) var light: texture_2d<f32>;
/// Variance of the Gaussian ahead and behind, texel²: see `taps.wgsl`.
@group(0) @binding(3) var variances: texture_2d<f32>;

struct Along {
    step_texels: vec2i,
    pad0: u32,
    pad1: u32,
}

/// Deviations that are taken in; also in `taps.wgsl`.
const DEVIATIONS: f32 = 3.3;

fn load(texel: vec2i) -> vec4f {
    return textureLoad(light, texel, 0);
}

@fragment
fn blur(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2i(position.xy);
    let variance = textureLoad(variances, texel, 0).xy;
    let farthest = i32(DEVIATIONS * sqrt(max(variance.x, variance.y)) + 0.5);
    // exp(-d²/2v) for d = 1, 2, 3 … by two products each.
    let q = exp(-0.5 / max(variance, vec2f(0.02)));
    var weight = q;
    var growth = q * q * q;
    // Either side has half of the light, and half of the centre is its own.
    let centre = 0.5 * load(texel);
    var near = centre;
    var far = centre;
    var whole = vec2f(0.5);
    // Two at a time: what lies beyond the farthest weighs next to nothing.
    let along_line = along.step_texels;
    for (var d = 1; d <= farthest; d += 2) {
        let ahead = texel + d * along_line;
        let behind = texel - d * along_line;
        near += load(ahead) * weight.x;
        far += load(behind) * weight.y;
        let second = weight * growth;
        growth *= q * q;
        near += load(ahead + along_line) * second.x;
        far += load(behind - along_line) * second.y;
        whole += weight + second;
        weight = second * growth;
        growth *= q * q;
    }
    return near * (0.5 / whole.x) + far * (0.5 / whole.y);
}
