// The light under the surface: the kernel's sum of Gaussians, once for every texel rather than for every sample of the
// picture. Each draw adds those whose levels have one size.

@group(0) @binding(1) var<uniform> gaussians: Gaussians;
@group(0) @binding(2) var charts: texture_2d<u32>;
@group(0) @binding(3) var levels: texture_2d_array<f32>;
@group(0) @binding(4) var level_charts: texture_2d<u32>;
@group(0) @binding(5) var finer: texture_2d_array<f32>;
@group(0) @binding(6) var finer_charts: texture_2d<u32>;
@group(0) @binding(7) var finest: texture_2d_array<f32>;

struct Gaussian {
    weight: vec3f,
    /// Layer of its level.
    layer: u32,
}

struct Gaussians {
    all: array<Gaussian, MAX_GAUSSIANS>,
    count: u32,
    /// Layer of the last level one size up.
    finer_layer: u32,
    pad0: u32,
    pad1: u32,
}

/// For levels of full size, whose texels are those of the sum.
@fragment
fn gather_texel(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2i(position.xy);
    var sum = vec3f(0.0);
    var i = 0u;
    loop {
        sum += gaussians.all[i].weight * textureLoad(levels, texel, gaussians.all[i].layer, 0).rgb;
        continuing {
            i++;
            break if i >= gaussians.count;
        }
    }
    return vec4f(sum, 0.0);
}

@fragment
fn gather(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let chart = textureLoad(charts, vec2i(position.xy), 0).x;
    if chart == NO_CHART {
        return vec4f(0.0);
    }
    let uv = position.xy / vec2f(textureDimensions(charts));
    let here = on_levels(level_charts, uv, chart);
    let instead = instead_of_level(finer, finer_charts, gaussians.finer_layer, finest, uv, chart).rgb;
    var sum = vec3f(0.0);
    var i = 0u;
    loop {
        let light = blend_layer(levels, gaussians.all[i].layer, here.texels, here.weights).rgb;
        sum += gaussians.all[i].weight * select(instead, light, here.covered);
        continuing {
            i++;
            break if i >= gaussians.count;
        }
    }
    return vec4f(sum, 0.0);
}
