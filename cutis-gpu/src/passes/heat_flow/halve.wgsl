// Light on a map of half the size: every texel gives its energy to the four coarse ones around it. The twin of cutis-render's
// `heat_flow::coarse`, inside of charts; at their edges `rows.wgsl` does it.

@group(0) @binding(1) var fine: texture_2d<f32>;
/// How much of what flows fine texels take: the inverse of their area.
@group(0) @binding(2) var fine_paces: texture_2d<f32>;

@fragment
fn halve_heat(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let first = 2 * vec2i(position.xy) - 1;
    let end = vec2i(textureDimensions(fine)) - 1;
    var sum = vec4f(0.0);
    var whole = 0.0;
    for (var i = 0; i < 16; i++) {
        let offset = vec2i(i & 3, i >> 2u);
        let texel = clamp(first + offset, vec2i(0), end);
        let pace = textureLoad(fine_paces, texel, 0).x;
        let parts = select(vec2f(0.25), vec2f(0.75), (offset == vec2i(1)) | (offset == vec2i(2)));
        let energy = select(0.0, parts.x * parts.y / pace, pace > 0.0);
        sum += energy * textureLoad(fine, texel, 0);
        whole += energy;
    }
    return rounded(sum / max(whole, 1e-30), vec2i(position.xy), 0u);
}
