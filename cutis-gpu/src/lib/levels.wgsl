// Reads of a level of the diffusion. A chart too thin for a coarse level is read from a finer one that has it.

/// Layer `layer` at a place in a chart: from the level itself; else the nearest texel of a finer one, else of the finest.
fn sample_level(
    level: texture_2d_array<f32>,
    charts: texture_2d<u32>,
    finer: texture_2d_array<f32>,
    finer_charts: texture_2d<u32>,
    finest: texture_2d_array<f32>,
    layer: u32,
    uv: vec2f,
    chart: u32,
) -> vec4f {
    let texels = around(uv, textureDimensions(level));
    let weights = chart_weights(charts, texels, chart);
    let value = blend_layer(level, layer, texels, weights);
    let finer_texel = vec2i(uv * vec2f(textureDimensions(finer)));
    let has_finer = textureLoad(finer_charts, finer_texel, 0).x == chart;
    let finest_texel = vec2i(uv * vec2f(textureDimensions(finest)));
    let instead = select(
        textureLoad(finest, finest_texel, layer, 0), textureLoad(finer, finer_texel, layer, 0), has_finer,
    );
    return select(instead, value, any(weights > vec4f(0.0)));
}
