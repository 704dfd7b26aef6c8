// The mesh as the camera sees it.

struct Camera {
    position_mm: vec3f,
    near_mm: f32,
    forward: vec3f,
    far_mm: f32,
    /// Half the width of the picture at distance 1, along its direction.
    right: vec3f,
    pad0: f32,
    up: vec3f,
    pad1: f32,
}

struct Seen {
    /// The same in the pass that finds what is nearest and in the one that shades it.
    @builtin(position) @invariant position: vec4f,
    @location(0) position_mm: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec4f,
    @location(3) map_uv: vec2f,
    @location(4) atlas_uv: vec2f,
    @location(5) @interpolate(flat) chart: u32,
}

fn seen_vertex(camera: Camera, vertex: Vertex, chart: u32) -> Seen {
    let p = vertex.position_mm - camera.position_mm;
    let depth_mm = dot(camera.forward, p);
    let z = (depth_mm - camera.near_mm) * camera.far_mm / (camera.far_mm - camera.near_mm);
    let x = dot(camera.right, p) / dot(camera.right, camera.right);
    let y = dot(camera.up, p) / dot(camera.up, camera.up);
    return Seen(vec4f(x, y, z, depth_mm), vertex.position_mm, vertex.normal, vertex.tangent,
        vec2f(vertex.map_u, vertex.map_v), vertex.atlas_uv, chart);
}
