// What a surface is made of. The twin of cutis-scene's `Material`.

const NO_RELIEF: u32 = 0u;
const TANGENT_SPACE: u32 = 1u;
const OBJECT_SPACE: u32 = 2u;

struct Material {
    albedo_factor: vec3f,
    albedo_mix: f32,
    /// Offset, gain and channel of the map of rho_s.
    rho_s: vec3f,
    f0: f32,
    /// The same for the roughness.
    roughness: vec3f,
    relief_strength: f32,
    /// The same for the share of the second medium.
    share: vec3f,
    relief_space: u32,
}

/// The absorbing film, passed once with this exponent.
fn film(albedo: vec3f, exponent: f32) -> vec3f {
    if exponent == 0.0 {
        return vec3f(1.0);
    }
    // 1e-12 has a logarithm and is black.
    return pow(max(albedo, vec3f(1e-12)), vec3f(exponent));
}

fn scalar_at(map: vec3f, tap: vec4f) -> f32 {
    return map.x + map.y * tap[u32(map.z)];
}
