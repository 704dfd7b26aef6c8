// The light under the surface: the kernel's sum of Gaussians, once for every texel rather than for every sample of the
// picture.

@group(0) @binding(1) var<uniform> gaussians: Gaussians;
/// Charts at the size of the irradiance and at smaller ones.
@group(0) @binding(2) var charts: texture_2d<u32>;
@group(0) @binding(3) var levels: texture_2d_array<f32>;

struct Gaussian {
    weight: vec3f,
    /// Layer of its level.
    layer: u32,
}

struct Gaussians {
    all: array<Gaussian, MAX_GAUSSIANS>,
    sizes: array<LevelSize, MAX_SIZES>,
    size_count: u32,
    pad0: u32,
    pad1: u32,
    pad2: u32,
}

@fragment
fn gather(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2i(position.xy);
    let chart = textureLoad(charts, texel, 0).x;
    if chart == NO_CHART {
        return vec4f(0.0);
    }
    var sum = vec3f(0.0);
    var i = 0u;
    // Texels of levels of full size are those of the sum.
    for (; i < gaussians.sizes[0].end; i++) {
        sum += gaussians.all[i].weight * textureLoad(levels, texel, gaussians.all[i].layer, 0).rgb;
    }
    let uv = position.xy / vec2f(textureDimensions(charts, 0));
    for (var s = 1u; s < gaussians.size_count; s++) {
        let size = gaussians.sizes[s];
        let here = on_levels(charts, size.halvings, uv, chart);
        let instead = instead_of_level(levels, charts, size, uv, chart).rgb;
        for (; i < size.end; i++) {
            let light = on_layer(levels, gaussians.all[i].layer, here).rgb;
            sum += gaussians.all[i].weight * select(instead, light, here.covered);
        }
    }
    return vec4f(sum, 0.0);
}
