// The light-facing surface behind a point, from a light's translucent shadow map.

/// Thinnest that a factor makes a body, mm: no distance at all says that a light is faced.
const THINNEST_MM: f32 = 1e-3;

struct LightFacing {
    found: bool,
    /// Whether the map shows nothing nearer to the light than the point: it lies at a silhouette, and what the texel holds is
    /// behind it.
    itself: bool,
    atlas_uv: vec2f,
    chart: u32,
    /// Distance m through the body towards the light, mm.
    distance_mm: f32,
    /// How far across the light's direction the place may be off: half the diagonal of the map's texel, mm.
    uncertain_mm: f32,
}

/// The surface nearest to a light on the way to `point_mm`, if it belongs to the object.
fn light_facing_surface(
    map: LightMap,
    depths: texture_2d_array<f32>,
    surfaces: texture_2d_array<u32>,
    point_mm: vec3f,
    object: u32,
) -> LightFacing {
    var there = LightFacing(false, false, vec2f(0.0), 0u, 0.0, 0.0);
    if map.layer == NO_MAP {
        return there;
    }
    let axes_mm = in_map_axes(map, point_mm);
    let size = vec2f(textureDimensions(depths));
    let texel = vec2i(floor(light_map_uv(map, axes_mm) * size));
    if any(texel < vec2i(0)) || any(texel >= vec2i(size)) {
        return there;
    }
    let depth_mm = textureLoad(depths, texel, map.layer, 0).x;
    let surface = textureLoad(surfaces, texel, map.layer, 0).xy;
    there.itself = depth_mm >= axes_mm.z;
    there.found = there.itself || (surface.y >> 16u) == object;
    // What is along the ray for a millimetre of the map's depth.
    let ray_mm_per_depth_mm = select(length(axes_mm) / axes_mm.z, 1.0, map.directional);
    there.uncertain_mm = 1.42 * map_half_width_mm(map, depth_mm) / size.x;
    there.atlas_uv = unpack2x16unorm(surface.x);
    there.chart = surface.y & 65535u;
    there.distance_mm = max(axes_mm.z - depth_mm, 0.0) * ray_mm_per_depth_mm;
    return there;
}

/// The paper's d: m where the normals at both ends agree, m cos theta where they are opposite, mm.
fn corrected_mm(distance_mm: f32, normal: vec3f, normal_there: vec3f, dir_to_light: vec3f) -> f32 {
    let opposite = max(-dot(normal_there, normal), 0.0);
    return distance_mm * (1.0 + (abs(dot(normal, dir_to_light)) - 1.0) * opposite);
}

/// Distance through a body that counts, mm: what was measured times the material's factor.
fn scaled_mm(distance_mm: f32, thickness_scale: f32) -> f32 {
    return max(distance_mm * thickness_scale, min(distance_mm, THINNEST_MM));
}
