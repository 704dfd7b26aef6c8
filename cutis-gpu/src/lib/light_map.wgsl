// The map drawn from a light: where a point falls on it.

/// What is needed of a light to find places on its map.
struct LightMap {
    right: vec3f,
    half_width: f32,
    up: vec3f,
    near_mm: f32,
    forward: vec3f,
    far_mm: f32,
    origin_mm: vec3f,
    layer: u32,
    directional: bool,
}

/// Which light sees which object.
struct Drawn {
    light: u32,
    object: u32,
    /// For images of the irradiance: 1 if they hold normals of the smooth surface.
    smooth_plane: u32,
    pad0: u32,
}

fn map_of(l: u32) -> LightMap {
    return LightMap(
        lights[l].map_right,
        lights[l].map_half_width,
        lights[l].map_up,
        lights[l].map_near_mm,
        lights[l].map_forward,
        lights[l].map_far_mm,
        lights[l].map_origin_mm,
        lights[l].map_layer,
        lights[l].kind == DIRECTIONAL,
    );
}

/// A point in the axes of the map: to the right, up, and away from the light, mm.
fn in_map_axes(map: LightMap, point_mm: vec3f) -> vec3f {
    let p = point_mm - map.origin_mm;
    return vec3f(dot(map.right, p), dot(map.up, p), dot(map.forward, p));
}

/// Half the width of what the map shows at a depth, mm.
fn map_half_width_mm(map: LightMap, depth_mm: f32) -> f32 {
    return map.half_width * select(depth_mm, 1.0, map.directional);
}

/// Where a point falls on the map: (0, 0) is the corner of its first texel.
fn light_map_uv(map: LightMap, axes_mm: vec3f) -> vec2f {
    let place = axes_mm.xy / map_half_width_mm(map, axes_mm.z);
    return vec2f(0.5 + 0.5 * place.x, 0.5 - 0.5 * place.y);
}

/// A point in the axes of the map, as a vertex shader places it.
fn on_map(map: LightMap, axes_mm: vec3f) -> vec4f {
    let depth = (axes_mm.z - map.near_mm) / (map.far_mm - map.near_mm);
    if map.directional {
        return vec4f(axes_mm.xy / map.half_width, depth, 1.0);
    }
    return vec4f(axes_mm.xy / map.half_width, depth * map.far_mm, axes_mm.z);
}

/// Distance of the light from a place, mm; of a light that is endlessly far away, from where its map begins.
fn light_distance_mm(map: LightMap, place_mm: vec3f) -> f32 {
    if map.directional {
        return in_map_axes(map, place_mm).z - map.near_mm;
    }
    return length(place_mm - map.origin_mm);
}
