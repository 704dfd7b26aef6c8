// Unit vectors in 32 bits: the octahedron unfolded to a square (Cigolle et al. 2014, "A Survey of Efficient
// Representations for Independent Unit Vectors", JCGT 3(2)).

fn pack_unit(v: vec3f) -> u32 {
    let n = v / (abs(v.x) + abs(v.y) + abs(v.z));
    let folded = (1.0 - abs(n.yx)) * select(vec2f(-1.0), vec2f(1.0), n.xy >= vec2f(0.0));
    return pack2x16snorm(select(folded, n.xy, n.z >= 0.0));
}

fn unpack_unit(code: u32) -> vec3f {
    let e = unpack2x16snorm(code);
    let z = 1.0 - abs(e.x) - abs(e.y);
    let folded = (1.0 - abs(e.yx)) * select(vec2f(-1.0), vec2f(1.0), e >= vec2f(0.0));
    return normalize(vec3f(select(folded, e, z >= 0.0), z));
}

/// `v` made a unit vector, or `otherwise` where it has no direction.
fn unit_or(v: vec3f, otherwise: vec3f) -> vec3f {
    let length2 = dot(v, v);
    // Squares below this lose digits or vanish.
    if length2 < 1e-30 {
        return otherwise;
    }
    return v * inverseSqrt(length2);
}
