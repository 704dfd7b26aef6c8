// Light that comes through thin parts into the light map (Green 2004, sections 16.3 and 16.4 together), at half its size. The
// twin of cutis-render's `thin_parts`; the light-facing surface comes from the translucent shadow maps instead of rays.

@group(0) @binding(1) var<uniform> body: Body;
@group(0) @binding(2) var<storage, read> lights: array<Light>;
/// Charts at the size of the light map and at smaller ones.
@group(0) @binding(3) var charts: texture_2d<u32>;
@group(0) @binding(4) var light: texture_2d<f32>;
@group(0) @binding(5) var places: texture_2d<u32>;
@group(0) @binding(6) var depths: texture_2d_array<f32>;
@group(0) @binding(7) var surfaces: texture_2d_array<u32>;
@group(0) @binding(8) var shares: texture_2d_array<f32>;

struct Body {
    /// How far the material spreads light, mm.
    deviation_mm: vec3f,
    /// Factor on distances through the body.
    thickness_scale: f32,
    object: u32,
    /// 1 if every light has a share of its own.
    many_lights: u32,
    pad0: u32,
    pad1: u32,
}

@fragment
fn come_through(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let half_texel = vec2i(position.xy);
    let chart = textureLoad(charts, half_texel, 1).x;
    if chart == NO_CHART {
        return vec4f(0.0);
    }
    let place = textureLoad(places, first_texel_under(charts, chart, 2 * half_texel), 0);
    let point_mm = bitcast<vec3f>(place.xyz);
    let normal = unpack_unit(place.w);
    var sum = vec3f(0.0);
    var l = 0u;
    loop {
        let dir_to_light = dir_to_light(l, point_mm);
        let there = light_facing_surface(map_of(l), depths, surfaces, point_mm, body.object);
        let comes_through = there.found && !there.itself && dot(normal, dir_to_light) < 0.0;
        let left = left_after(scaled_mm(there.distance_mm, body.thickness_scale));
        sum += select(vec3f(0.0), entered(l, there) * left, comes_through);
        continuing {
            l++;
            break if l >= arrayLength(&lights);
        }
    }
    return vec4f(sum, 0.0);
}

/// What of a light entered where it does, W/m².
fn entered(l: u32, there: LightFacing) -> vec3f {
    let texels = around(there.atlas_uv, textureDimensions(light));
    let weights = chart_weights(charts, texels, there.chart);
    let all = blend(light, texels, weights).rgb;
    if body.many_lights == 0u {
        return all;
    }
    return all * blend_layer(shares, l / 4u, texels, weights)[l % 4u];
}

/// e^(-s/deviation): what a distance leaves of the light of each channel. A body that spreads nothing lets nothing through.
fn left_after(s_mm: f32) -> vec3f {
    return exp(-s_mm / max(body.deviation_mm, vec3f(1e-12)));
}
