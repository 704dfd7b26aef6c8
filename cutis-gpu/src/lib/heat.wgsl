// A stage of heat flow: from the last two polynomials of the exchange to the next.

/// The polynomial that is known last, and the one before it.
@group(0) @binding(2) var now: texture_2d<f32>;
@group(0) @binding(3) var before: texture_2d<f32>;
/// What of each neighbour's difference a texel takes at once, counter-clockwise: from the east, and from the west on.
@group(0) @binding(4) var from_east: texture_2d<f32>;
@group(0) @binding(5) var from_west: texture_2d<f32>;
/// Sampled, a texel costs adapters without texture units half of what loading it does.
@group(0) @binding(13) var nearest: sampler;

struct Stage {
    /// What each sum takes of the polynomial that is known last, and of those before it; nothing of all, where there is no sum.
    parts: array<vec4f, 3>,
    /// The next polynomial: so many times x of this one, less one time less of the one before.
    factor: f32,
    /// What sums take of what they hold: 0 to begin with, then 1.
    kept: f32,
    /// Width and height of the map, texels.
    size: u32,
    /// Another one for every stage.
    seed: u32,
}

fn known(uv: vec2f, own: vec4f) -> vec4f {
    return textureSampleLevel(now, nearest, uv, 0.0) - own;
}

/// The last two polynomials at a texel.
struct Here {
    texel: vec2i,
    uv: vec2f,
    now: vec4f,
    before: vec4f,
}

fn here(texel: vec2i) -> Here {
    let uv = (vec2f(texel) + 0.5) / f32(stage.size);
    return Here(texel, uv, textureSampleLevel(now, nearest, uv, 0.0), textureSampleLevel(before, nearest, uv, 0.0));
}

/// The next polynomial, with what comes from further away.
fn next(at: Here, further: vec4f) -> vec4f {
    let step = 1.0 / f32(stage.size);
    let east = textureSampleLevel(from_east, nearest, at.uv, 0.0);
    let west = textureSampleLevel(from_west, nearest, at.uv, 0.0);
    var moved = at.now + further;
    moved += known(at.uv + vec2f(step, 0.0), at.now) * east.x;
    moved += known(at.uv + vec2f(step, step), at.now) * east.y;
    moved += known(at.uv + vec2f(0.0, step), at.now) * east.z;
    moved += known(at.uv + vec2f(-step, step), at.now) * east.w;
    moved += known(at.uv + vec2f(-step, 0.0), at.now) * west.x;
    moved += known(at.uv + vec2f(-step, -step), at.now) * west.y;
    moved += known(at.uv + vec2f(0.0, -step), at.now) * west.z;
    moved += known(at.uv + vec2f(step, -step), at.now) * west.w;
    return rounded(stage.factor * moved - (stage.factor - 1.0) * at.before, at.texel, stage.seed);
}
