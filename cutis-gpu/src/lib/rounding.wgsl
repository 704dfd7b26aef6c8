// Rounding to 16 bits without a bias.

/// One of the two nearest values that 16 bits hold, at random, by how near they are. Some adapters round towards zero where they
/// store, and rounding to the nearest makes the same error in neighbours: over many passes both would grow.
fn rounded(light: vec4f, texel: vec2i, seed: u32) -> vec4f {
    return bitcast<vec4f>((bitcast<vec4u>(light) + (noise(texel, seed) & vec4u(0x1fffu))) & vec4u(0xffffe000u));
}

/// Random bits, others for every texel and seed.
fn noise(texel: vec2i, seed: u32) -> vec4u {
    var h = (u32(texel.x) * 0x9E3779B1u) ^ (u32(texel.y) * 0x85EBCA77u) ^ seed;
    h = (h ^ (h >> 15u)) * 0x2C1B3C6Du;
    h ^= h >> 13u;
    return vec4u(h, h >> 6u, h >> 12u, h >> 18u);
}
