// The film's numbers, and pixels that the rest can rely on. The twin of cutis-render's `film`.

const MAX_RADIANCE: f32 = 65504.0;

struct Film {
    /// Factor on the light.
    gain: f32,
    /// Display-linear grey behind what is transparent.
    behind: f32,
    /// Share of the light that is spread.
    strength: f32,
    /// One of the numbers in `tone_mappers.wgsl`.
    tone_mapper: u32,
    /// Side of a cell of the reduced copy, pixels.
    cell: i32,
    /// Cells to either side that the blur reaches.
    reach: i32,
    pad0: u32,
    pad1: u32,
    /// Weights of one half of the blur, from the middle outwards, four by four.
    weights: array<vec4f, 17>,
}

/// A number in every channel (black where there was none), no negative light, coverage in 0 to 1.
fn exposed(pixel: vec4f, gain: f32) -> vec4f {
    // By their bits: a comparison of what is no number may be compiled away.
    let is_nan = (bitcast<vec4u>(pixel) & vec4u(0x7fffffffu)) > vec4u(0x7f800000u);
    if any(is_nan) {
        return vec4f(0.0);
    }
    return vec4f(clamp(pixel.rgb * gain, vec3f(0.0), vec3f(MAX_RADIANCE)), clamp(pixel.a, 0.0, 1.0));
}
