// Tiles of a map, one by one, that lie near texels where light comes through; the others are left out.

/// 1 where light comes through some of 4 × 4 texels.
@group(0) @binding(20) var marks: texture_2d<f32>;

/// Side of a square of texels that are marked together.
const TEXELS_OF_MARK: i32 = 4;

/// The corner of a tile; all corners are one where nothing within `reach` texels of the tile is marked.
fn corner_of_thin_tile(corner: u32, number: u32, reach: i32) -> vec4f {
    let code = tiles[number + 1u];
    let first = vec2i(vec2u(code & 1023u, code >> 20u) * TILE_TEXELS);
    let last = first + i32(TILE_TEXELS) - 1;
    let lo = max(first - reach, vec2i(0)) / TEXELS_OF_MARK;
    let hi = min((last + reach) / TEXELS_OF_MARK, vec2i(textureDimensions(marks)) - 1);
    var most = 0.0;
    for (var y = lo.y; y <= hi.y; y++) {
        for (var x = lo.x; x <= hi.x; x++) {
            most = max(most, textureLoad(marks, vec2i(x, y), 0).x);
        }
    }
    return select(vec4f(0.0, 0.0, 0.0, 1.0), corner_of_run(corner, number), most > 0.0);
}
