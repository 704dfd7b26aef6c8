// The mesh as vertex and fragment shaders fetch it.

struct Vertex {
    position_mm: vec3f,
    u: f32,
    normal: vec3f,
    v: f32,
    tangent: vec4f,
}

/// Three vertices, and the chart in w.
alias Triangle = vec4u;
