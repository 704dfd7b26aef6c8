// Reads of a level of the diffusion. A chart too thin for a coarse level is read from a finer one that has it.

/// Layer `layer` at a place in a chart: from the level itself, else from a finer one, else from the finest.
fn sample_level(
    level: texture_2d_array<f32>,
    charts: texture_2d<u32>,
    finer: texture_2d_array<f32>,
    finer_charts: texture_2d<u32>,
    finest: texture_2d_array<f32>,
    finest_charts: texture_2d<u32>,
    layer: u32,
    uv: vec2f,
    chart: u32,
) -> vec4f {
    let texels = around(uv, textureDimensions(level));
    let weights = chart_weights(charts, texels, chart);
    if any(weights > vec4f(0.0)) {
        return blend_layer(level, layer, texels, weights);
    }
    let finer_texels = around(uv, textureDimensions(finer));
    let finer_weights = chart_weights(finer_charts, finer_texels, chart);
    if any(finer_weights > vec4f(0.0)) {
        return blend_layer(finer, layer, finer_texels, finer_weights);
    }
    let finest_texels = around(uv, textureDimensions(finest));
    return blend_layer(finest, layer, finest_texels, chart_weights(finest_charts, finest_texels, chart));
}
