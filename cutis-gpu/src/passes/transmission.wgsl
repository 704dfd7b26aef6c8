// One Gaussian's part of the light that comes through the body, added to that of the others
// (d'Eon, Luebke & Enderton 2007, sections 5.2 and 5.4; equation 16 with exp(-d²/2v)), at half the size of the irradiance.

@group(0) @binding(1) var<uniform> slab: Slab;
@group(0) @binding(2) var<storage, read> lights: array<Light>;
@group(0) @binding(3) var charts: texture_2d<u32>;
@group(0) @binding(4) var atlas_charts: texture_2d<u32>;
@group(0) @binding(5) var places: texture_2d<u32>;
@group(0) @binding(6) var stretch_map: texture_2d<f32>;
@group(0) @binding(7) var depths: texture_2d_array<f32>;
@group(0) @binding(8) var surfaces: texture_2d_array<u32>;
@group(0) @binding(9) var shares: texture_2d_array<f32>;
/// The level before the Gaussian, for the distance; the Gaussian's own, for the light.
@group(0) @binding(10) var before: texture_2d_array<f32>;
@group(0) @binding(11) var before_charts: texture_2d<u32>;
@group(0) @binding(12) var level: texture_2d_array<f32>;
@group(0) @binding(13) var level_charts: texture_2d<u32>;
@group(0) @binding(14) var finest: texture_2d_array<f32>;
/// What the light is read from in charts that are too thin for its level.
@group(0) @binding(15) var finer: texture_2d_array<f32>;
@group(0) @binding(16) var finer_charts: texture_2d<u32>;

struct Slab {
    weight: vec3f,
    variance_mm2: f32,
    object: u32,
    /// 1 if every light has a share of its own.
    many_lights: u32,
    pad0: u32,
    pad1: u32,
}

const FADE_DEVIATIONS: f32 = 6.0;
const VISIBLE: f32 = 1e-6;

@fragment
fn transmit(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let chart = textureLoad(charts, vec2i(position.xy), 0).x;
    if chart == NO_CHART || slab.variance_mm2 <= 0.0 {
        return vec4f(0.0);
    }
    let texel = point_under(chart, 2 * vec2i(position.xy));
    let place = textureLoad(places, texel, 0);
    let point_mm = bitcast<vec3f>(place.xyz);
    let normal = unpack_unit(place.w);
    let uv = (vec2f(texel) + 0.5) / vec2f(textureDimensions(places));
    var sum = vec3f(0.0);
    for (var l = 0u; l < arrayLength(&lights); l++) {
        let towards = sample_light(l, point_mm);
        let through = slab_weight(distance_before_mm(l, uv, chart));
        if through > VISIBLE && dot(normal, towards.dir_to_light) < 0.0 {
            let there = light_facing_surface(map_of(l), depths, surfaces, point_mm, slab.object);
            let apart_mm = apart_mm(uv, normal, chart, there) - uncertain_mm(there, towards.dir_to_light);
            let faded = select(0.0, through * fade_out(max(apart_mm, 0.0)), there.found && !there.itself);
            sum += light_at(there) * (faded * share(l, there));
        }
    }
    return vec4f(slab.weight * sum, 0.0);
}

/// The first texel of the chart under one of half the size.
fn point_under(chart: u32, corner: vec2i) -> vec2i {
    for (var i = 0; i < 4; i++) {
        let texel = corner + vec2i(i & 1, i >> 1u);
        if textureLoad(atlas_charts, texel, 0).x == chart {
            return texel;
        }
    }
    return corner;
}

/// The blurred distance towards a light, mm. With one light it rides in alpha, with several in further layers.
fn distance_before_mm(l: u32, uv: vec2f, chart: u32) -> f32 {
    let layer = select(0u, 1u + l / 4u, slab.many_lights == 1u);
    let component = select(3u, l % 4u, slab.many_lights == 1u);
    return sample_level(before, before_charts, finest, atlas_charts, finest, layer, uv, chart)[component];
}

fn light_at(there: LightFacing) -> vec3f {
    return sample_level(
        level, level_charts, finer, finer_charts, finest, 0u, there.uv, there.chart,
    ).rgb;
}

/// Share of a light in what falls on its light-facing side, so that light counted once is not counted again.
fn share(l: u32, there: LightFacing) -> f32 {
    if slab.many_lights == 0u {
        return 1.0;
    }
    let texels = around(there.uv, textureDimensions(shares));
    return blend_layer(shares, l / 4u, texels, chart_weights(atlas_charts, texels, there.chart))[l % 4u];
}

/// Distance along the surface to the light-facing place, mm. Within a chart the texture tells. Between charts no blur has
/// brought its light here if it lies on the other side of a thin part; around an edge it is a neighbour beyond the seam.
fn apart_mm(uv: vec2f, normal: vec3f, chart: u32, there: LightFacing) -> f32 {
    let size = vec2f(textureDimensions(places));
    let texel_there = vec2i(there.uv * size);
    if chart == there.chart {
        let stretch = textureLoad(stretch_map, vec2i(uv * size), 0).xy + textureLoad(stretch_map, texel_there, 0).xy;
        return length((uv - there.uv) * size * 0.5 * stretch);
    }
    let normal_there = unpack_unit(textureLoad(places, texel_there, 0).w);
    let opposite = clamp(-dot(normal_there, normal), 0.0, 1.0);
    // 1e-6 keeps the quotient finite; a micrometre over it is a metre.
    return there.distance_mm / max(1.0 - opposite, 1e-6);
}

/// How far along the light-facing surface the place may be off: what the map cannot tell apart is not apart, mm.
fn uncertain_mm(there: LightFacing, dir_to_light: vec3f) -> f32 {
    let texel = vec2i(there.uv * vec2f(textureDimensions(places)));
    let cos = dot(unpack_unit(textureLoad(places, texel, 0).w), dir_to_light);
    // Seen at less than 3 degrees a surface has no place on the map.
    return there.uncertain_mm / max(cos, 0.05);
}

/// exp(-d²/2v): what a slab of thickness d leaves of a Gaussian of variance v.
fn slab_weight(d_mm: f32) -> f32 {
    return exp(-d_mm * d_mm / (2.0 * slab.variance_mm2));
}

/// 0 where both places are one, 1 from six standard deviations on.
fn fade_out(apart_mm: f32) -> f32 {
    return min(apart_mm / (FADE_DEVIATIONS * sqrt(slab.variance_mm2)), 1.0);
}
