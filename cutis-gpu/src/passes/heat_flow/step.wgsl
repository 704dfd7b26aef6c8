// Heat flow from texel to texel: one polynomial of the exchange after the other, and their sums. The twin of cutis-render's
// `heat_flow::row`.

@group(0) @binding(1) var<uniform> stage: Stage;
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

/// A sum with what this stage and the one before it give; those that are not drawn cost nothing.
fn added(sum: texture_2d<f32>, at: Here, n: u32) -> vec4f {
    if n >= stage.sums {
        return vec4f(0.0);
    }
    // What is there before the first is of no concern, be it a number or not.
    let so_far = select(vec4f(0.0), textureSampleLevel(sum, nearest, at.uv, 0.0), stage.kept > 0.0);
    return rounded(so_far + stage.parts[n] * at.now + stage.parts_before[n] * at.before, at.texel, stage.seed);
}

@fragment
fn exchange(@builtin(position) position: vec4f) -> Stepped {
    let at = here(vec2i(position.xy));
    return Stepped(next(at, vec4f(0.0)), added(sum_a, at, 0u), added(sum_b, at, 1u), added(sum_c, at, 2u));
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
    return Sums(added(sum_a, at, 0u), added(sum_b, at, 1u), added(sum_c, at, 2u));
}

/// The next polynomial alone.
@fragment
fn exchange_alone(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return next(here(vec2i(position.xy)), vec4f(0.0));
}
