// The mesh as vertex and fragment shaders fetch it.

struct Vertex {
    position_mm: vec3f,
    map_u: f32,
    normal: vec3f,
    map_v: f32,
    tangent: vec4f,
    atlas_uv: vec2f,
    pad0: u32,
    pad1: u32,
}

/// Three vertices, and the chart in w.
alias Triangle = vec4u;
