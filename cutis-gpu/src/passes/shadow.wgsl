// The scene as a light sees it: the shadow map's depth, and with it the translucent shadow map's place in the maps of light of
// the surface that faces the light (d'Eon, Luebke & Enderton 2007, section 5.2).

@group(0) @binding(0) var<storage, read> vertices: array<Vertex>;
@group(0) @binding(1) var<storage, read> triangles: array<Triangle>;
@group(0) @binding(2) var<storage, read> lights: array<Light>;
@group(0) @binding(3) var<uniform> drawn: Drawn;

struct Seen {
    @builtin(position) position: vec4f,
    @location(0) depth_mm: f32,
    @location(1) atlas_uv: vec2f,
    @location(2) @interpolate(flat) chart: u32,
}

struct Mapped {
    @location(0) depth_mm: f32,
    /// Place in the maps of light in x; chart and object in y.
    @location(1) surface: vec2u,
}

@vertex
fn see_from_light(@builtin(vertex_index) index: u32) -> Seen {
    let triangle = triangles[index / 3u];
    let vertex = vertices[triangle[index % 3u]];
    let map = map_of(drawn.light);
    let axes_mm = in_map_axes(map, vertex.position_mm);
    return Seen(on_map(map, axes_mm), axes_mm.z, vertex.atlas_uv, triangle.w);
}

/// For maps of nothing but depth, drawn by indices.
@vertex
fn see_depth(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4f {
    let map = map_of(drawn.light);
    return on_map(map, in_map_axes(map, vertices[vertex].position_mm));
}

@fragment
fn map_surface(seen: Seen) -> Mapped {
    return Mapped(seen.depth_mm, vec2u(pack2x16unorm(seen.atlas_uv), seen.chart | (drawn.object << 16u)));
}
