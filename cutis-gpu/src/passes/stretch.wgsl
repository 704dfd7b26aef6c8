// |dX/du|² and |dX/dv|² at every vertex, mm² per unit of the texture: the harmonic mean over the triangles around it,
// weighted by their areas on the surface and in the texture.

@group(0) @binding(0) var<storage, read> vertices: array<Vertex>;
@group(0) @binding(1) var<storage, read> triangles: array<Triangle>;
/// Where the triangles around a vertex begin, one more than there are vertices; then those triangles.
@group(0) @binding(2) var<storage, read> fans: array<u32>;
@group(0) @binding(3) var<storage, read_write> squared_stretch_mm2: array<vec2f>;

const LARGEST: f32 = 3.0e38;

fn perp_dot(a: vec2f, b: vec2f) -> f32 {
    return a.x * b.y - a.y * b.x;
}

@compute @workgroup_size(64)
fn stretch_at_vertices(@builtin(global_invocation_id) id: vec3u) {
    let vertex = id.x;
    if vertex >= arrayLength(&vertices) {
        return;
    }
    var sum = vec2f(0.0);
    var weight = 0.0;
    for (var i = fans[vertex]; i < fans[vertex + 1u]; i++) {
        let corners = triangles[fans[i]];
        let a = vertices[corners.x];
        let b = vertices[corners.y];
        let c = vertices[corners.z];
        let e1 = b.position_mm - a.position_mm;
        let e2 = c.position_mm - a.position_mm;
        let d1 = b.atlas_uv - a.atlas_uv;
        let d2 = c.atlas_uv - a.atlas_uv;
        let determinant = perp_dot(d1, d2);
        if determinant == 0.0 {
            continue;
        }
        let along_u = (e1 * d2.y - e2 * d1.y) / determinant;
        let along_v = (e2 * d1.x - e1 * d2.x) / determinant;
        let area = 0.5 * length(cross(e1, e2)) * abs(determinant);
        let share = area / vec2f(dot(along_u, along_u), dot(along_v, along_v));
        if all(share < vec2f(LARGEST)) {
            sum += share;
            weight += area;
        }
    }
    squared_stretch_mm2[vertex] = weight / max(sum, vec2f(1e-37));
}
