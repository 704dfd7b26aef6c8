// Reads of the levels of the diffusion. Levels of one size are layers of one texture: where to read is found once for all of
// them. A chart too thin for a coarse level is read from the size before it.

/// Most Gaussians of a kernel.
const MAX_GAUSSIANS: u32 = 16u;

/// A place on all levels of a size.
struct OnLevels {
    texels: Around,
    /// All 0 where no texel belongs to the chart.
    weights: vec4f,
    covered: bool,
}

fn on_levels(charts: texture_2d<u32>, uv: vec2f, chart: u32) -> OnLevels {
    let texels = around(uv, textureDimensions(charts));
    let weights = chart_weights(charts, texels, chart);
    return OnLevels(texels, weights, any(weights > vec4f(0.0)));
}

/// What is read where a chart is too thin: the nearest texel of a level one size up, else of the unblurred light.
fn instead_of_level(
    finer: texture_2d_array<f32>,
    finer_charts: texture_2d<u32>,
    finer_layer: u32,
    finest: texture_2d_array<f32>,
    uv: vec2f,
    chart: u32,
) -> vec4f {
    let finer_texel = vec2i(uv * vec2f(textureDimensions(finer)));
    let finest_texel = vec2i(uv * vec2f(textureDimensions(finest)));
    return select(
        textureLoad(finest, finest_texel, 0, 0),
        textureLoad(finer, finer_texel, finer_layer, 0),
        textureLoad(finer_charts, finer_texel, 0).x == chart,
    );
}
