// Light from all around. The twin of cutis-scene's `Environment` and of the filtered maps of cutis-render.

struct Environment {
    radiance_scale: vec3f,
    rotation_rad: f32,
    /// Roughness of each filtered reflection but the last.
    roughnesses: vec4f,
    last_roughness: f32,
    pad0: f32,
    pad1: f32,
    pad2: f32,
}

/// Where a direction falls on a latitude-longitude map.
fn latlong_uv(environment: Environment, dir: vec3f) -> vec2f {
    let azimuth = atan2(dir.x, -dir.z) + environment.rotation_rad;
    return vec2f(fract(0.5 + azimuth / 6.283185307), acos(clamp(dir.y, -1.0, 1.0)) / 3.141592654);
}
