// Bodies grown along their normals as a light sees them: distances of the light from their surfaces as they are, and what
// enters there (Green 2004, GPU Gems, listings 16-2 and 16-3 and section 16.3.1). Further layers show what lies behind the
// layer before (depth peeling).

@group(0) @binding(0) var<storage, read> vertices: array<Vertex>;
@group(0) @binding(1) var<storage, read> triangles: array<Triangle>;
@group(0) @binding(2) var<storage, read> lights: array<Light>;
@group(0) @binding(3) var<uniform> drawn: Grown;
/// Where the vertices at the place of each vertex begin in the list itself, and one end more; then the vertices.
@group(0) @binding(4) var<storage, read> alike: array<u32>;
@group(0) @binding(5) var<uniform> material: Material;
@group(0) @binding(6) var rho_dt_table: texture_2d<f32>;
@group(0) @binding(7) var albedo_map: texture_2d<f32>;
@group(0) @binding(8) var relief_map: texture_2d<f32>;
@group(0) @binding(9) var rho_s_map: texture_2d<f32>;
@group(0) @binding(10) var roughness_map: texture_2d<f32>;
@group(0) @binding(11) var linear: sampler;
@group(0) @binding(12) var repeating: sampler;
/// Depths of the layer before.
@group(0) @binding(13) var before: texture_depth_2d;

struct Grown {
    light: u32,
    growth_mm: f32,
    pad0: u32,
    pad1: u32,
}

struct Surface {
    @builtin(position) position: vec4f,
    /// As it is, not grown.
    @location(0) place_mm: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec4f,
    @location(3) map_uv: vec2f,
    /// Whether light enters the body here, or leaves it.
    @location(4) @interpolate(flat) enters: u32,
}

struct Entry {
    /// Distance of the light, negative where it leaves a body, mm.
    @location(0) distance_mm: f32,
    /// Share of the light's irradiance that enters: normal and colour of the place in one.
    @location(1) entered: vec4f,
}

@vertex
fn see_grown(@builtin(vertex_index) index: u32) -> Surface {
    let triangle = triangles[index / 3u];
    let number = triangle[index % 3u];
    let vertex = vertices[number];
    let map = map_of(drawn.light);
    let axes_mm = in_map_axes(map, vertex.position_mm + outwards(number) * drawn.growth_mm);
    return Surface(
        on_map(map, axes_mm),
        vertex.position_mm,
        vertex.normal,
        vertex.tangent,
        vec2f(vertex.map_u, vertex.map_v),
        select(0u, 1u, enters(triangle)),
    );
}

/// Vertices at one point move together, along the mean of their normals, so that no gap opens at an edge.
fn outwards(number: u32) -> vec3f {
    var sum = vec3f(0.0);
    for (var i = alike[number]; i < alike[number + 1u]; i++) {
        sum += vertices[alike[i]].normal;
    }
    return unit_or(sum, vec3f(0.0));
}

/// A mesh may be wound either way round; its normals point out of it.
fn enters(triangle: Triangle) -> bool {
    let a = vertices[triangle.x];
    let b = vertices[triangle.y];
    let c = vertices[triangle.z];
    let flat = cross(b.position_mm - a.position_mm, c.position_mm - a.position_mm);
    let facing = dot(flat, dir_to_light(drawn.light, a.position_mm));
    return (facing > 0.0) == (dot(flat, a.normal + b.normal + c.normal) >= 0.0);
}

@fragment
fn map_entry(surface: Surface) -> Entry {
    return Entry(signed_mm(surface), vec4f(entered(surface), 1.0));
}

@fragment
fn map_next(surface: Surface) -> @location(0) f32 {
    if surface.position.z <= textureLoad(before, vec2i(surface.position.xy), 0) {
        discard;
    }
    return signed_mm(surface);
}

fn signed_mm(surface: Surface) -> f32 {
    let d_mm = light_distance_mm(map_of(drawn.light), surface.place_mm);
    return select(-d_mm, d_mm, surface.enters != 0u);
}

fn entered(surface: Surface) -> vec3f {
    let map_uv = surface.map_uv;
    let smooth_normal = unit_or(surface.normal, vec3f(0.0, 1.0, 0.0));
    let stored = textureSampleLevel(relief_map, repeating, map_uv, 0.0).xyz;
    let normal = with_relief(material, stored, smooth_normal, surface.tangent);
    let rho_s = scalar_at(material.rho_s, textureSampleLevel(rho_s_map, repeating, map_uv, 0.0));
    let roughness = scalar_at(material.roughness, textureSampleLevel(roughness_map, repeating, map_uv, 0.0));
    let albedo = material.albedo_factor * textureSampleLevel(albedo_map, repeating, map_uv, 0.0).rgb;
    let cos = max(dot(normal, dir_to_light(drawn.light, surface.place_mm)), 0.0);
    return film(albedo, material.albedo_mix) * (cos * rho_dt(rho_dt_table, linear, cos, roughness, rho_s));
}
