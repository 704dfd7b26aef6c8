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

fn sample_light(light: Light, point_mm: vec3f) -> LightSample {
    if light.kind == DIRECTIONAL {
        return LightSample(light.dir, 3.0e38, light.strength);
    }
    let to_light = light.position_mm - point_mm;
    // A point at the light's very centre has no direction.
    let distance_mm = max(length(to_light), 1e-30);
    let dir_to_light = to_light / distance_mm;
    // Within a millimetre the inverse square of a real lamp no longer holds.
    let distance_m = max(distance_mm, 1.0) * 1e-3;
    var irradiance = light.strength / (distance_m * distance_m);
    if light.kind == SPOT {
        irradiance *= spot_falloff(dot(light.dir, -dir_to_light), light.cos_inner, light.cos_outer);
    }
    return LightSample(dir_to_light, distance_mm, irradiance);
}

fn spot_falloff(cos_axis: f32, cos_inner: f32, cos_outer: f32) -> f32 {
    // The specification's own floor for cones that coincide.
    let ramp = clamp((cos_axis - cos_outer) / max(cos_inner - cos_outer, 1e-3), 0.0, 1.0);
    return ramp * ramp;
}

/// A point in the axes of the light's map: to the right, up, and away from the light, mm.
fn in_map_axes(light: Light, point_mm: vec3f) -> vec3f {
    let p = point_mm - light.map_origin_mm;
    return vec3f(dot(light.map_right, p), dot(light.map_up, p), dot(light.map_forward, p));
}

/// Half the width of what the map shows at a depth, mm.
fn map_half_width_mm(light: Light, depth_mm: f32) -> f32 {
    return light.map_half_width * select(depth_mm, 1.0, light.kind == DIRECTIONAL);
}

/// Where a point falls on the map: (0, 0) is the corner of its first texel.
fn map_uv(light: Light, axes_mm: vec3f) -> vec2f {
    let place = axes_mm.xy / map_half_width_mm(light, axes_mm.z);
    return vec2f(0.5 + 0.5 * place.x, 0.5 - 0.5 * place.y);
}
