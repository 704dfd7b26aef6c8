// Reads of the levels of the diffusion. All of them are layers of one texture, some of halved ones: where to read is found
// once for all levels of a size. A chart too thin for a coarse level is read from the size before it.

/// Most Gaussians of a kernel.
const MAX_GAUSSIANS: u32 = 16u;
/// Most sizes of levels.
const MAX_SIZES: u32 = 17u;

/// Gaussians whose levels have one size.
struct LevelSize {
    /// How often the first size is halved.
    halvings: u32,
    /// Number of the first of the Gaussians after these.
    end: u32,
    /// How often the size before is halved.
    finer_halvings: u32,
    /// First layer of the last level of the size before.
    finer_layer: u32,
}

/// A place on all levels of a size.
struct OnLevels {
    halvings: u32,
    texels: Around,
    /// All 0 where no texel belongs to the chart.
    weights: vec4f,
    covered: bool,
}

fn on_levels(charts: texture_2d<u32>, halvings: u32, uv: vec2f, chart: u32) -> OnLevels {
    let texels = around(uv, textureDimensions(charts, halvings));
    let weights = halved_chart_weights(charts, halvings, texels, chart);
    return OnLevels(halvings, texels, weights, any(weights > vec4f(0.0)));
}

/// What a layer holds at a place.
fn on_layer(levels: texture_2d_array<f32>, layer: u32, place: OnLevels) -> vec4f {
    return blend_halved(levels, place.halvings, layer, place.texels, place.weights);
}

/// What is read where a chart is too thin: the nearest texel of a level one size up, else of the unblurred light.
fn instead_of_level(levels: texture_2d_array<f32>, charts: texture_2d<u32>, size: LevelSize, uv: vec2f, chart: u32) -> vec4f {
    let halvings = size.finer_halvings;
    let finer_texel = vec2i(uv * vec2f(textureDimensions(charts, halvings)));
    let finest_texel = vec2i(uv * vec2f(textureDimensions(charts, 0)));
    return select(
        textureLoad(levels, finest_texel, 0, 0),
        textureLoad(levels, finer_texel, size.finer_layer, halvings),
        textureLoad(charts, finer_texel, halvings).x == chart,
    );
}
