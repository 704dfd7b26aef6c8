// Texels at the edges of charts: what they get from any others, row by row of a sparse matrix. The twin of
// cutis-render's `heat_flow::row`, of its `coarse` and of the padding.

@group(0) @binding(1) var<uniform> stage: Stage;
/// Each row's texel, and where its links begin; the last one says where they end.
@group(0) @binding(9) var<storage, read> rows: array<vec2u>;
@group(0) @binding(10) var<storage, read> further: array<Link>;
/// Light that was read before.
@group(0) @binding(11) var<storage, read> kept: array<vec4f>;
@group(0) @binding(12) var<storage, read_write> keeping: array<vec4f>;
/// Where the next polynomial goes.
@group(0) @binding(14) var following: texture_storage_2d<rgba16float, write>;

struct Link {
    texel: u32,
    strength: f32,
}

struct Point {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) light: vec4f,
}

fn texel_of(number: u32) -> vec2i {
    return vec2i(i32(number % stage.size), i32(number / stage.size));
}

fn point(number: u32, light: vec4f) -> Point {
    let place = (vec2f(texel_of(number)) + 0.5) / f32(stage.size);
    return Point(vec4f(2.0 * place.x - 1.0, 1.0 - 2.0 * place.y, 0.0, 1.0), light);
}

/// What a texel reads of a map of so many texels.
fn reading(row: u32, size: u32) -> vec4f {
    var sum = vec4f(0.0);
    for (var n = rows[row].y; n < rows[row + 1u].y; n++) {
        let other = further[n].texel;
        sum += textureLoad(now, vec2i(i32(other % size), i32(other / size)), 0) * further[n].strength;
    }
    return rounded(sum, texel_of(rows[row].x), stage.seed);
}

/// The next polynomial of a texel that takes from further away.
@compute @workgroup_size(64)
fn edge_exchange(@builtin(global_invocation_id) id: vec3u) {
    if id.x + 1u >= arrayLength(&rows) {
        return;
    }
    let texel = texel_of(rows[id.x].x);
    let at = here(texel);
    var taken = vec4f(0.0);
    for (var n = rows[id.x].y; n < rows[id.x + 1u].y; n++) {
        taken += (textureLoad(now, texel_of(further[n].texel), 0) - at.now) * further[n].strength;
    }
    textureStore(following, texel, next(at, taken));
}

/// Light of a texel of half the size from the fine map.
@vertex
fn edge_halved(@builtin(vertex_index) row: u32) -> Point {
    return point(rows[row].x, reading(row, 2u * stage.size));
}

/// Light of the padding, as it was kept.
@vertex
fn edge_kept(@builtin(vertex_index) row: u32) -> Point {
    return point(rows[row].x, kept[row]);
}

@compute @workgroup_size(64)
fn keep_padding(@builtin(global_invocation_id) id: vec3u) {
    if id.x + 1u < arrayLength(&rows) {
        keeping[id.x] = reading(id.x, stage.size);
    }
}

@fragment
fn show_point(at: Point) -> @location(0) vec4f {
    return at.light;
}
