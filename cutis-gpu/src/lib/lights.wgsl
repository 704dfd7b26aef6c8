// Lights that have a direction at every point, and the maps drawn from them. The twin of cutis-scene's `Light`.

const DIRECTIONAL: u32 = 0u;
const POINT: u32 = 1u;
const SPOT: u32 = 2u;
/// In place of a layer: the light has no shadow map.
const NO_MAP: u32 = 0xffffffffu;

struct Light {
    position_mm: vec3f,
    kind: u32,
    /// Towards the light if it is directional, along its axis if it is a spot.
    dir: vec3f,
    /// Radius in mm, or the tangent of the angular radius.
    extent: f32,
    /// W/m² if it is directional, else W/sr.
    strength: vec3f,
    cos_inner: f32,
    map_right: vec3f,
    cos_outer: f32,
    map_up: vec3f,
    /// Half the width of the map: in mm, or at distance 1.
    map_half_width: f32,
    map_forward: vec3f,
    map_near_mm: f32,
    map_origin_mm: vec3f,
    map_far_mm: f32,
    map_layer: u32,
    pad0: u32,
    pad1: u32,
    pad2: u32,
}

struct LightSample {
    dir_to_light: vec3f,
    distance_mm: f32,
    irradiance_w_per_m2: vec3f,
}

/// Light number `l` as a point sees it. Lights are told by their number: what is not asked for is not fetched.
fn sample_light(l: u32, point_mm: vec3f) -> LightSample {
    let kind = lights[l].kind;
    let strength = lights[l].strength;
    if kind == DIRECTIONAL {
        return LightSample(lights[l].dir, 3.0e38, strength);
    }
    let to_light = lights[l].position_mm - point_mm;
    // A point at the light's very centre has no direction.
    let distance_mm = max(length(to_light), 1e-30);
    let dir_to_light = to_light / distance_mm;
    // Within a millimetre the inverse square of a real lamp no longer holds.
    let distance_m = max(distance_mm, 1.0) * 1e-3;
    var irradiance = strength / (distance_m * distance_m);
    if kind == SPOT {
        irradiance *= spot_falloff(dot(lights[l].dir, -dir_to_light), lights[l].cos_inner, lights[l].cos_outer);
    }
    return LightSample(dir_to_light, distance_mm, irradiance);
}

fn spot_falloff(cos_axis: f32, cos_inner: f32, cos_outer: f32) -> f32 {
    // The specification's own floor for cones that coincide.
    let ramp = clamp((cos_axis - cos_outer) / max(cos_inner - cos_outer, 1e-3), 0.0, 1.0);
    return ramp * ramp;
}
