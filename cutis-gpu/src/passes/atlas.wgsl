// The surface unrolled: what lies under every texel. The triangle of each is known beforehand, for no deformation moves
// places of the atlas; where it lies now, which way it faces and how far it is stretched is found here.

@group(0) @binding(1) var<storage, read> vertices: array<Vertex>;
@group(0) @binding(2) var<storage, read> triangles: array<Triangle>;
@group(0) @binding(3) var<storage, read> squared_stretch_mm2: array<vec2f>;
/// Triangle in x; barycentric weights of its second and third corner in y.
@group(0) @binding(4) var surface: texture_2d<u32>;
@group(0) @binding(5) var<uniform> material: Material;
@group(0) @binding(6) var relief_map: texture_2d<f32>;
@group(0) @binding(7) var repeating: sampler;

const NO_TRIANGLE: u32 = 0xffffffffu;
/// Texels that stand still in space would have no size; nothing smaller than a micrometre is believed.
const MIN_STRETCH_MM: f32 = 1e-3;

struct Unrolled {
    /// Position in mm as bits in xyz; smooth normal in w.
    @location(0) place: vec4u,
    /// Normal with relief.
    @location(1) relief: u32,
    /// Millimetres per texel along u and v; distance to the surface that the normals describe, mm.
    @location(2) stretch: vec4f,
}

@fragment
fn unroll(@builtin(position) position: vec4f) -> Unrolled {
    let code = textureLoad(surface, vec2i(position.xy), 0);
    if code.x == NO_TRIANGLE {
        return Unrolled(vec4u(0u), 0u, vec4f(0.0));
    }
    let b = unpack2x16unorm(code.y);
    let weights = vec3f(1.0 - b.x - b.y, b.x, b.y);
    let corners = triangles[code.x];
    let v0 = vertices[corners.x];
    let v1 = vertices[corners.y];
    let v2 = vertices[corners.z];
    let place_mm = v0.position_mm * weights.x + v1.position_mm * weights.y + v2.position_mm * weights.z;
    let flat = unit_or(cross(v1.position_mm - v0.position_mm, v2.position_mm - v0.position_mm), v0.normal);
    let normal = unit_or(v0.normal * weights.x + v1.normal * weights.y + v2.normal * weights.z, flat);
    let tangent = v0.tangent * weights.x + v1.tangent * weights.y + v2.tangent * weights.z;
    let map_uv = vec2f(v0.map_u, v0.map_v) * weights.x + vec2f(v1.map_u, v1.map_v) * weights.y
        + vec2f(v2.map_u, v2.map_v) * weights.z;
    let lifted = lift(v0, place_mm) * weights.x + lift(v1, place_mm) * weights.y + lift(v2, place_mm) * weights.z;
    let stored = textureSampleLevel(relief_map, repeating, map_uv, 0.0).xyz;
    let shading = with_relief(material, stored, normal, tangent);
    let squared = squared_stretch_mm2[corners.x] * weights.x + squared_stretch_mm2[corners.y] * weights.y
        + squared_stretch_mm2[corners.z] * weights.z;
    let stretch = max(sqrt(max(squared, vec2f(0.0))) / f32(textureDimensions(surface).x), vec2f(MIN_STRETCH_MM));
    return Unrolled(
        vec4u(bitcast<vec3u>(place_mm), pack_unit(normal)),
        pack_unit(shading),
        vec4f(stretch, max(dot(lifted, normal), 0.0), 0.0),
    );
}

/// How far the tangent plane of a corner lies outside of a point of the flat triangle.
fn lift(corner: Vertex, place_mm: vec3f) -> vec3f {
    return -corner.normal * min(dot(place_mm - corner.position_mm, corner.normal), 0.0);
}
