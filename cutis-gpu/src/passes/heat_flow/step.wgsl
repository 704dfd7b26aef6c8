// Heat flow from texel to texel: one polynomial of the exchange after the other, and their sums. The twin of cutis-render's
// `heat_flow::row`.

@group(0) @binding(1) var<uniform> stage: Stage;
/// The polynomials before those.
@group(0) @binding(11) var earlier: texture_2d<f32>;
@group(0) @binding(12) var earliest: texture_2d<f32>;
/// What sums hold so far.
@group(0) @binding(6) var sum_a: texture_2d<f32>;
@group(0) @binding(7) var sum_b: texture_2d<f32>;
@group(0) @binding(8) var sum_c: texture_2d<f32>;

struct Stepped {
    @location(0) next: vec4f,
    @location(1) sum_a: vec4f,
    @location(2) sum_b: vec4f,
    @location(3) sum_c: vec4f,
}

/// What sums take from: the polynomial that is known last, and those before it.
fn known_last(at: Here) -> mat4x4f {
    let all = abs(stage.parts[0]) + abs(stage.parts[1]) + abs(stage.parts[2]);
    var last = mat4x4f(at.now, at.before, vec4f(0.0), vec4f(0.0));
    if all.z > 0.0 {
        last[2] = textureSampleLevel(earlier, nearest, at.uv, 0.0);
    }
    if all.w > 0.0 {
        last[3] = textureSampleLevel(earliest, nearest, at.uv, 0.0);
    }
    return last;
}

/// A sum with what these give; those that are not drawn cost nothing.
fn added(sum: texture_2d<f32>, at: Here, last: mat4x4f, n: u32) -> vec4f {
    if all(stage.parts[n] == vec4f(0.0)) {
        return vec4f(0.0);
    }
    var so_far = vec4f(0.0);
    if stage.kept > 0.0 {
        so_far = textureSampleLevel(sum, nearest, at.uv, 0.0);
    }
    return rounded(so_far + last * stage.parts[n], at.texel, stage.seed);
}

@fragment
fn exchange(@builtin(position) position: vec4f) -> Stepped {
    let at = here(vec2i(position.xy));
    let last = known_last(at);
    return Stepped(
        next(at, vec4f(0.0)),
        added(sum_a, at, last, 0u),
        added(sum_b, at, last, 1u),
        added(sum_c, at, last, 2u),
    );
}

struct Sums {
    @location(0) a: vec4f,
    @location(1) b: vec4f,
    @location(2) c: vec4f,
}

/// Sums alone.
@fragment
fn add_up(@builtin(position) position: vec4f) -> Sums {
    let at = here(vec2i(position.xy));
    let last = known_last(at);
    return Sums(added(sum_a, at, last, 0u), added(sum_b, at, last, 1u), added(sum_c, at, last, 2u));
}

/// The next polynomial alone.
@fragment
fn exchange_alone(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return next(here(vec2i(position.xy)), vec4f(0.0));
}
