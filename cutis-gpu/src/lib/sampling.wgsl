// Sample patterns and the random numbers they are turned by. The twin of cutis-render's `sampling`.

/// A hash of four numbers that passes for random: PCG4D (Jarzynski & Olano 2020, JCGT 9(3), section 3).
fn pcg4d(seed: vec4u) -> vec4u {
    var v = seed * 1664525u + 1013904223u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    v = v ^ (v >> vec4u(16u));
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

/// Two numbers in [0, 1) for a place and a use.
fn random2(place: vec2u, stream: u32) -> vec2f {
    let bits = pcg4d(vec4u(place, stream, 1u));
    return vec2f(bits.xy >> vec2u(8u)) / 16777216.0;
}

/// Point `index` of the R2 sequence, shifted and wrapped to the unit square.
fn r2_point(index: u32, shift: vec2f) -> vec2f {
    return fract(vec2f(0.7548776662, 0.5698402910) * f32(index) + shift);
}

/// Unit square to unit disc, keeping areas, by radius and angle.
fn disc(square: vec2f) -> vec2f {
    let angle_rad = 6.283185307 * square.y;
    return sqrt(square.x) * vec2f(cos(angle_rad), sin(angle_rad));
}
