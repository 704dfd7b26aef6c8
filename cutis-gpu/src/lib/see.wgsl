// Vertices fetched by number: three for every triangle, because the chart belongs to the triangle.

@vertex
fn see(@builtin(vertex_index) index: u32) -> Seen {
    let triangle = triangles[index / 3u];
    return seen_vertex(camera, vertices[triangle[index % 3u]], triangle.w);
}
