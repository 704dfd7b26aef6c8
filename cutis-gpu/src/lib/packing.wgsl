// Unit vectors in 32 bits: the octahedron unfolded to a square (Cigolle et al. 2014, "A Survey of Efficient
// Representations for Independent Unit Vectors", JCGT 3(2)).

fn pack_unit(v: vec3f) -> u32 {
    return pack2x16snorm(on_square(v));
}

fn unpack_unit(code: u32) -> vec3f {
    return on_sphere(unpack2x16snorm(code));
}

fn on_square(v: vec3f) -> vec2f {
    let n = v / (abs(v.x) + abs(v.y) + abs(v.z));
    let folded = (1.0 - abs(n.yx)) * select(vec2f(-1.0), vec2f(1.0), n.xy >= vec2f(0.0));
    return select(folded, n.xy, n.z >= 0.0);
}

fn on_sphere(e: vec2f) -> vec3f {
    let z = 1.0 - abs(e.x) - abs(e.y);
    let folded = (1.0 - abs(e.yx)) * select(vec2f(-1.0), vec2f(1.0), e >= vec2f(0.0));
    return normalize(vec3f(select(folded, e, z >= 0.0), z));
}

/// A unit vector in 24 bits and a share from 0 to 1 in 8.
fn pack_unit_and_share(v: vec3f, share: f32) -> u32 {
    let steps = vec2u(round((0.5 + 0.5 * on_square(v)) * 4095.0));
    return steps.x | (steps.y << 12u) | (u32(round(share * 255.0)) << 24u);
}

fn unpack_unit_and_share(code: u32) -> vec4f {
    let e = vec2f(vec2u(code, code >> 12u) & vec2u(4095u)) / 2047.5 - 1.0;
    return vec4f(on_sphere(e), f32(code >> 24u) / 255.0);
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

/// Two unit vectors at right angles to a unit vector and to each other (Duff et al. 2017, "Building an Orthonormal Basis,
/// Revisited", JCGT 6(1)), as the processor's vectors have them.
fn orthonormal_pair(n: vec3f) -> array<vec3f, 2> {
    let sign = select(-1.0, 1.0, n.z >= 0.0);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    return array<vec3f, 2>(
        vec3f(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
        vec3f(b, sign + n.y * n.y * a, -n.y),
    );
}
