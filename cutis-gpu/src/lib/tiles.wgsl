// Runs of tiles of a map that hold at least one texel of a chart: everything else is left out.
// The first entry is the width of the map in texels; every other one a run: first column, end column, row.

@group(0) @binding(0) var<storage, read> tiles: array<u32>;

const TILE_TEXELS: u32 = 16u;

@vertex
fn cover_run(@builtin(vertex_index) corner: u32, @builtin(instance_index) run: u32) -> @builtin(position) vec4f {
    return corner_of_run(corner, run);
}

/// A corner of the two triangles that cover a run.
fn corner_of_run(corner: u32, run: u32) -> vec4f {
    let code = tiles[run + 1u];
    let left = code & 1023u;
    let right = (code >> 10u) & 1023u;
    let top = code >> 20u;
    let column = select(left, right, corner == 1u || corner == 3u || corner == 4u);
    let row = select(top, top + 1u, corner == 2u || corner == 4u || corner == 5u);
    let place = vec2f(vec2u(column, row) * TILE_TEXELS) / f32(tiles[0]);
    return vec4f(2.0 * place.x - 1.0, 1.0 - 2.0 * place.y, 0.0, 1.0);
}
